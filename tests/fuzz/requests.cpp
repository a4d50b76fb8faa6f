// What a browser asks for, and what a person on the gateway tells it: lines, each the path of a
// request or, behind '!', a command. Each has an answer that ends.
#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "firmware/control/control.h"
#include "firmware/fakes.h"
#include "firmware/status/recent_events.h"
#include "firmware/status/status_page.h"
#include "fuzz_target.h"

namespace etcm::fuzz {
namespace {

using namespace firmware;
using namespace std::chrono_literals;

// A gateway with four nodes, one of which has fallen silent.
struct Served {
  Served() {
    rig.start();
    rig.put_square();
    rig.run(300ms);
    rig.bus.silence(4);
    rig.run(200ms);
    alarms.begin_look(rig.clock.now());
    alarms.hold({}, {}, "it is silent", "look at it");
    alarms.end_look([](const Alarm&) { return true; });
  }

  Rig rig{{feature(1001, 1003)}};
  RecentEvents events{rig.clock, rig.log};
  AlarmBook alarms;
  FollowingWallClock wall{rig.clock};
  port::ServiceCounters masters, readers;
};

// No answer about so small a mesh is longer.
constexpr std::size_t answer_max = 4'000'000;

template <class Read>
std::size_t read_all(Read read) {
  std::array<char, 4096> out;
  std::size_t size = 0;
  while (const std::size_t piece = read(out)) {
    size += piece;
    require(size < answer_max, "an answer has no end");
  }
  return size;
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Served served;
  const StatusSources sources{.gateway = *served.rig.gateway,
                              .events = served.events,
                              .alarms = served.alarms,
                              .wall_clock = served.wall,
                              .masters = served.masters,
                              .readers = served.readers,
                              .version = "1.2.3",
                              .started_at = served.rig.clock.now()};
  StatusPage page(sources, 2);
  Control control(*served.rig.gateway, served.alarms, sources, served.rig.log);
  std::string_view text = text_of(bytes);
  for (int count = 0; count < 20 && !text.empty(); ++count) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.starts_with('!')) {
      control.begin(0, line.substr(1));
      require(read_all([&](std::span<char> out) { return control.read(0, out); }) > 0, "silence");
      control.end(0);
    } else {
      const port::WebAnswer answer = page.begin(0, line);
      require(answer.status >= 200 && answer.status < 600, "a status that is none");
      read_all([&](std::span<char> out) { return page.read(0, out); });
      page.end(0);
    }
  }
}

}  // namespace etcm::fuzz
