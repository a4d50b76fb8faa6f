#include "firmware/config/fleet_settings.h"

#include <algorithm>
#include <cmath>

#include "firmware/fleet/header_codec.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// A member that is heard of so seldom is silent.
constexpr int periods_of_silence = 3;
constexpr port::Duration period_most = 30s;
// Two places that one node tells of itself are no farther apart, as a rule.
constexpr double place_error_m = 10;

}  // namespace

FleetSettings fleet_settings_of(const Settings& settings, std::uint64_t run,
                                std::string_view version) {
  const MqttSettings& mqtt = *settings.mqtt;
  FleetSettings member;
  member.is_alone = mqtt.is_alone;
  member.site = mqtt.site;
  member.gateway = mqtt.name;
  member.instance = run;
  member.version = version.substr(0, fleet_version_max);
  member.period = std::min(mqtt.period_max, period_most);
  member.silent_after = periods_of_silence * member.period + 10s;
  member.leave_after = settings.poll.leave_after;
  member.return_time = return_time;
  member.report_min = mqtt.period_min;
  member.report_max = mqtt.period_max;
  member.apart_min = apart_min_of(settings);
  member.apart_after = settings.poll.stale_after + member.settle;
  member.nodes_max = settings.mesh.vertices_max;
  member.members_max = fleet_members_max;
  return member;
}

std::int64_t apart_min_of(const Settings& settings) {
  const double metres = metres_per_unit(settings.site.plane());
  const double units = metres > 0 ? std::ceil(place_error_m / metres) : place_error_m;
  const double least = std::min(units, static_cast<double>(position_max));
  return std::max(static_cast<std::int64_t>(least), 2 * std::int64_t{settings.poll.dead_band});
}

std::uint32_t foreign_room(const Settings& settings) {
  const bool is_shared = settings.mqtt && settings.mqtt->share == FleetShare::site;
  return is_shared ? settings.mesh.vertices_max : 0;
}

}  // namespace etcm::firmware
