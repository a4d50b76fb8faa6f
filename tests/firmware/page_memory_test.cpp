// The status page takes all its memory at the start: every allocation after that is counted.
#include <gtest/gtest.h>

#include <array>

#include "fakes.h"
#include "firmware/status/status_page.h"
#include "measuring_profile.h"
#include "support/allocation_watch.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

TEST(PageMemory, ReadersOfEverythingTakeNone) {
  Rig rig{{feature(1001, 1003)}};
  rig.settings.device_profiles = {measuring_profile()};
  rig.settings.buses.front().devices = {{.units = {{.first = 5, .last = 20}},
                                         .profile = rig.settings.device_profiles.front().name,
                                         .timeout = 50ms}};
  rig.start();
  RecentEvents events(rig.clock, rig.log);
  const AlarmBook alarms;
  const FollowingWallClock wall_clock(rig.clock);
  port::ServiceCounters masters;
  port::ServiceCounters readers;
  const StatusSources sources{.gateway = *rig.gateway,
                              .events = events,
                              .alarms = alarms,
                              .wall_clock = wall_clock,
                              .masters = masters,
                              .readers = readers,
                              .version = "1.2.3",
                              .started_at = rig.clock.now()};
  StatusPage page(sources, 4);
  std::array<char, 500> out;
  for (std::uint8_t unit = 1; unit <= 20; ++unit) {
    rig.put(unit, unit * 31 % 17, unit * unit % 23);
    rig.run(500ms);
    const test::AllocationWatch watch;
    page.advance(rig.clock.now());
    // A slow reader meanwhile has a generation of its own.
    if (unit == 10) page.begin(3, "/mesh.geojson");
    for (const char* path :
         {"/", "/map.js", "/mesh.geojson", "/readings.json", "/status.json", "/ages.json",
          "/units.json", "/alarms.json", "/ended.json", "/history.json", "/alarms.csv",
          "/nodes.csv", "/units.csv", "/events.csv", "/metrics", "/healthz", "/nothing"}) {
      page.begin(0, path);
      while (page.read(0, out) > 0) continue;
      page.end(0);
    }
    if (unit == 15) page.end(3);
    EXPECT_EQ(watch.allocations(), 0u) << "with " << int{unit} << " nodes";
  }
  EXPECT_EQ(rig.gateway->readings().readings.size(), 16u * 3);
}

}  // namespace
}  // namespace etcm::firmware
