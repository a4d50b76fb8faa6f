#include "firmware/status/shown_unit.h"

#include <algorithm>

#include "etcm/port/utf8.h"
#include "firmware/alarms/alarm_subject.h"
#include "firmware/status/alarms_document.h"
#include "firmware/status/bus_meter.h"

namespace etcm::firmware {

namespace {

constexpr std::size_t profile_shown_max = 64;

UnitState state_of(const Gateway& gateway, UnitIndex unit) {
  if (is_answering(gateway, unit)) return UnitState::answering;
  const Poller& poller = gateway.poller();
  const bool is_up = poller.is_up(poller.bus_of(unit));
  return is_up && is_of_an_answer(poller.counters(unit).last_fault) ? UnitState::faulty
                                                                    : UnitState::silent;
}

// The node that answers there, or the one that did before it was missing; null: neither.
const NodeRecord* node_of(const Gateway& gateway, UnitIndex unit) {
  const NodeTable& nodes = gateway.nodes();
  if (const NodeRecord* const node = nodes.at(unit)) return node;
  const auto all = nodes.records();
  const auto missing = std::find_if(all.begin(), all.end(), [&](const NodeRecord& node) {
    return node.is_known() && node.is_missing && node.last_unit == unit;
  });
  return missing == all.end() ? nullptr : &*missing;
}

// The settings may name a unit where nobody is known.
std::string_view name_of(const Gateway& gateway, const NodeRecord* node, UnitIndex unit) {
  const NodeTable& nodes = gateway.nodes();
  if (node != nullptr) return nodes.called(*node).name;
  return nodes.names()->text(nodes.names()->find(Serial::none(), unit));
}

std::optional<port::Duration> time_of_alarm(const StatusSources& sources, AlarmKey key,
                                            port::Instant asked_at) {
  const Alarm* const alarm = sources.alarms.find_on(key);
  if (alarm == nullptr || (!alarm->since.is_of_this_run() && alarm->since.unix_ms <= 0)) {
    return std::nullopt;
  }
  return age_of(alarm->since, asked_at, sources.wall_clock.milliseconds());
}

AlarmKey key_of_missing(const NodeRecord& node) {
  return {AlarmKind::missing_node, node.serial.value};
}

std::optional<port::Duration> time_of_silence(const StatusSources& sources, BusIndex bus,
                                              port::Instant asked_at) {
  const std::string_view name = sources.gateway.poller().bus(bus).name;
  return time_of_alarm(sources, {AlarmKind::silent_bus, subject_of(name)}, asked_at);
}

// From before a restart: since when the node of a unit has been silent that has not answered since.
// Of one that is not missing its bus may tell, on which nobody has answered for longer.
void show_earlier_run(ShownUnit& shown, const StatusSources& sources, UnitIndex unit,
                      port::Instant asked_at) {
  const Poller& poller = sources.gateway.poller();
  if (shown.node == nullptr || poller.counters(unit).has_answered()) return;
  shown.has_answered_before = true;
  const NodeRecord& node = *shown.node;
  shown.since = time_of_alarm(sources, key_of_missing(node), asked_at);
  if (!shown.since && node.heard_at < node.known_since) {
    shown.since = age_of(node.heard_at, asked_at);
  }
  if (!shown.since) shown.since = time_of_silence(sources, poller.bus_of(unit), asked_at);
  // Since the start is what is said of it without.
  if (shown.since <= age_of(sources.started_at, asked_at)) shown.since.reset();
}

}  // namespace

// A unit that was not asked since its bus fell silent would answer no more than the others.
bool is_answering(const Gateway& gateway, UnitIndex unit) {
  const Poller& poller = gateway.poller();
  return poller.is_answering(unit) && !gateway.presence().is_silent(poller.bus_of(unit));
}

bool is_shown(const Poller& poller, UnitIndex unit) {
  return poller.is_listed(unit) || poller.counters(unit).has_answered();
}

ShownUnit shown_unit(const StatusSources& sources, UnitIndex unit, port::Instant asked_at) {
  const Gateway& gateway = sources.gateway;
  const Poller& poller = gateway.poller();
  const UnitCounters& counters = poller.counters(unit);
  ShownUnit shown{.bus = bus_label(poller, poller.bus_of(unit)),
                  .address = poller.address_of(unit).value,
                  .state = state_of(gateway, unit),
                  .since = std::nullopt,
                  .profile = port::cut_utf8(poller.profile_name(unit), profile_shown_max),
                  .node = node_of(gateway, unit),
                  .name = {}};
  shown.name = name_of(gateway, shown.node, unit);
  if (shown.state == UnitState::answering) {
    shown.since = age_of(counters.sound_since, asked_at);
  } else if (counters.sound_at != port::Instant{}) {
    shown.since = age_of(counters.sound_at, asked_at);
  }
  show_earlier_run(shown, sources, unit, asked_at);
  if (shown.node == nullptr || shown.node->answered_at == port::Instant{}) return shown;
  const std::uint16_t status = shown.node->status;
  shown.is_moving = (status & node_status::moving) != 0;
  shown.has_left = shown.node->has_asked_to_leave();
  shown.has_low_battery = (status & node_status::low_battery) != 0;
  shown.lacks_fix = (status & node_status::fix_valid) == 0;
  return shown;
}

port::Duration missing_for(const StatusSources& sources, const NodeRecord& node,
                           port::Instant asked_at) {
  return time_of_alarm(sources, key_of_missing(node), asked_at)
      .value_or(age_of(node.heard_at, asked_at));
}

port::Duration silent_for(const StatusSources& sources, BusIndex bus, port::Instant asked_at) {
  const SilenceClock& clock = sources.gateway.presence().clock();
  return time_of_silence(sources, bus, asked_at)
      .value_or(age_of(std::max(clock.heard_at(bus), sources.started_at), asked_at));
}

const char* to_string(UnitState state) {
  switch (state) {
    case UnitState::answering:
      return "answering";
    case UnitState::faulty:
      return "faulty";
    case UnitState::silent:
      break;
  }
  return "silent";
}

const char* to_string(UnitFault fault) {
  switch (fault) {
    case UnitFault::none:
      break;
    case UnitFault::timeout:
      return "timeout";
    case UnitFault::exception:
      return "exception";
    case UnitFault::bad_answer:
      return "bad answer";
    case UnitFault::link_lost:
      return "link lost";
    case UnitFault::torn:
      return "torn";
    case UnitFault::unbelieved:
      return "unbelieved";
    case UnitFault::jumped:
      return "jumped";
  }
  return "";
}

}  // namespace etcm::firmware
