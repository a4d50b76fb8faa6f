// When an alarm of an earlier run may end: as soon as it is known here whether it still is so. One
// that is cured ends at once, and one that is not goes on without an end between.
#include <algorithm>

#include "firmware/alarms/alarm_subject.h"
#include "firmware/alarms/alarm_watch.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// Of a kind that only the broker and other gateways can tell of.
bool is_of_fleet(AlarmKind kind) {
  return kind == AlarmKind::no_broker || kind == AlarmKind::refused_by_broker ||
         kind == AlarmKind::site_of_fleet || kind == AlarmKind::name_taken ||
         kind == AlarmKind::gone_gateway || kind == AlarmKind::other_mesh ||
         kind == AlarmKind::rejected_gateway;
}

bool is_bus_judged(const Gateway& gateway, std::uint64_t subject) {
  const BusIndex bus = bus_of_subject(gateway.poller(), subject);
  return bus.is_none() || gateway.presence().clock().heard_at(bus) != port::Instant{};
}

bool is_unit_judged(const Gateway& gateway, std::uint64_t subject) {
  const Poller& poller = gateway.poller();
  const UnitIndex unit = unit_of_subject(poller, subject);
  return unit.is_none() || poller.counters(unit).has_answered() ||
         !is_named(gateway.settings(), poller, unit);
}

bool is_fault_judged(const Gateway& gateway, std::uint64_t subject) {
  const Poller& poller = gateway.poller();
  const UnitIndex unit = unit_of_subject(poller, subject);
  return unit.is_none() || poller.counters(unit).sound_at != port::Instant{};
}

// Who was missing is known from the start; one that is not any more was dismissed.
bool is_node_judged(const Gateway& gateway, AlarmKey key) {
  const NodeRecord* const node = gateway.nodes().find(node_of_subject(key));
  if (node == nullptr) return key.kind == AlarmKind::missing_node;
  // What is in the quarantine is told with the next generation.
  if (key.kind == AlarmKind::refused_node && node->is_quarantined()) return false;
  if (node->is_foreign()) return true;
  const bool has_fix = (node->status & node_status::fix_valid) != 0;
  return node->answered_at != port::Instant{} && (key.kind != AlarmKind::no_fix || has_fix);
}

bool is_waited_for(const Gateway& gateway, const FeatureEnd& end) {
  if (end.is_anchor) return false;
  const NodeRecord* const node = gateway.nodes().find(end.serial);
  if (node != nullptr) return node->is_missing;
  const NodeEnd* const unheard = gateway.unheard_ends().find(end.serial);
  return unheard != nullptr && unheard->is_told;
}

// It is in the mesh, or waits for a node as one that is not refused does.
bool is_feature_judged(const Gateway& gateway, AlarmKey key) {
  if (!is_there(gateway, key)) return true;
  return std::any_of(gateway.features().begin(), gateway.features().end(), [&](const auto& each) {
    const FeatureSettings& feature = each.settings;
    if (subject_of(feature) != key.subject || each.rejection != Status::ok) return false;
    return each.is_active() || is_waited_for(gateway, feature.from) ||
           is_waited_for(gateway, feature.to);
  });
}

// Without a reason for leave_after there is none.
bool is_identity_judged(const Gateway& gateway, std::uint64_t subject, port::Duration passed) {
  const auto number = static_cast<std::uint32_t>(subject);
  if (number == 0) {
    // Two other gateways hear it.
    const FleetReport* const fleet = gateway.fleet();
    return fleet == nullptr || fleet->is_told;
  }
  const UnitIndex unit{number - 1};
  if (unit.value >= gateway.poller().unit_count()) return true;
  return passed > gateway.settings().poll.leave_after &&
         gateway.poller().counters(unit).has_answered();
}

bool is_end_judged(const Gateway& gateway, Serial serial) {
  return gateway.unheard_ends().find(serial) == nullptr || gateway.nodes().find(serial) != nullptr;
}

// What was learned of it is known again once the gateway has read it and looked.
bool is_sensor_judged(const Gateway& gateway, std::uint64_t subject) {
  const ReadingSnapshot& readings = gateway.readings();
  return std::any_of(readings.readings.begin(), readings.readings.end(), [&](const auto& reading) {
    const Quantity& quantity = readings.quantities[reading.quantity.value];
    return reading.is_own() && !reading.is_stale && reading.expected_nano &&
           subject_of(quantity.name, reading.serial.value) == subject;
  });
}

// Each of the messages that the broker has kept says how it is with the gateway that sent it; that
// this one is there, only what it says now.
bool is_member_judged(const FleetReport& fleet, AlarmKey key) {
  const ReportedMember* const member = member_of_subject(&fleet, key.subject);
  if (member == nullptr) return true;
  const bool is_known =
      member->state != MemberState::waiting && member->state != MemberState::unknown;
  if (!is_known) return false;
  switch (key.kind) {
    case AlarmKind::gone_gateway:
      return member->state != MemberState::gone && member->is_proven;
    case AlarmKind::other_mesh:
      return member->agrees || member->state != MemberState::here;
    default:
      return true;
  }
}

bool is_fleet_judged(const FleetReport& fleet, AlarmKey key, port::Instant now) {
  switch (key.kind) {
    case AlarmKind::no_broker:
      return !fleet.apart_since;
    case AlarmKind::refused_by_broker:
      return fleet.is_told;
    case AlarmKind::site_of_fleet:
      return fleet.is_site_known;
    case AlarmKind::name_taken:
      // Its twin, which had fallen silent, comes forward within that.
      if (key.subject == subject_of(fleet.name)) {
        return fleet.is_told && now - fleet.connected_or_not_since > 2 * fleet.period;
      }
      [[fallthrough]];
    default:
      return fleet.is_settled && is_member_judged(fleet, key);
  }
}

}  // namespace

bool AlarmWatch::is_judged(AlarmKey key, port::Instant now) const {
  const FleetReport* const fleet = sources_.gateway.fleet();
  port::Instant from = sources_.started_at;
  if (is_of_fleet(key.kind) && fleet != nullptr) {
    // While it is apart it learns nothing.
    if (!fleet->is_connected) return false;
    from = std::max(from, fleet->connected_or_not_since);
  }
  // All has had the time to answer.
  if (now - from > 2 * sources_.gateway.settings().poll.leave_after + 1min) return true;
  return is_judged_by_what_came(key, now);
}

bool AlarmWatch::is_judged_by_what_came(AlarmKey key, port::Instant now) const {
  const Gateway& gateway = sources_.gateway;
  if (is_of_fleet(key.kind)) {
    return gateway.fleet() == nullptr || is_fleet_judged(*gateway.fleet(), key, now);
  }
  switch (key.kind) {
    case AlarmKind::silent_bus:
      return is_bus_judged(gateway, key.subject);
    case AlarmKind::never_answered:
      return is_unit_judged(gateway, key.subject);
    case AlarmKind::faulty_unit:
      return is_fault_judged(gateway, key.subject);
    case AlarmKind::missing_node:
    case AlarmKind::no_fix:
    case AlarmKind::low_battery:
    case AlarmKind::refused_node:
      return is_node_judged(gateway, key);
    case AlarmKind::far_node:
      // The others have come by then.
      return now - sources_.started_at > gateway.settings().poll.stale_after &&
             is_node_judged(gateway, key) &&
             gateway.far_nodes().find(node_of_subject(key)) == nullptr;
    case AlarmKind::refused_feature:
      return is_feature_judged(gateway, key);
    case AlarmKind::refused_anchor:
      return !is_there(gateway, key) || gateway.generation() > 0;
    case AlarmKind::identity_conflict:
      return is_identity_judged(gateway, key.subject, now - sources_.started_at);
    case AlarmKind::unheard_end:
      return is_end_judged(gateway, node_of_subject(key));
    case AlarmKind::disagreeing_sensor:
      return is_sensor_judged(gateway, key.subject);
    case AlarmKind::disk_of_files:
    case AlarmKind::disk_of_state:
      return is_disk_judged(key);
    default:
      // Of the program itself: not_served, no_page, late_mesh, refused_configuration.
      return true;
  }
}

bool AlarmWatch::is_disk_judged(AlarmKey key) const {
  const Gateway& gateway = sources_.gateway;
  const DiskWriter* disk = gateway.disk_of_files();
  if (key.kind == AlarmKind::disk_of_state) {
    disk = key.subject == alarms_of_state ? disk_of_alarms_ : gateway.disk_of_state();
  }
  return disk == nullptr || disk->works();
}

AlarmEnd AlarmWatch::why_ended(const Alarm& alarm) const {
  const bool is_page_removed = alarm.key.kind == AlarmKind::no_page && sources_.readers == nullptr;
  return is_page_removed || !is_there(sources_.gateway, alarm.key) ? AlarmEnd::removed
                                                                   : AlarmEnd::by_itself;
}

}  // namespace etcm::firmware
