#include "firmware/status/alarm_about.h"

#include <algorithm>
#include <span>

#include "firmware/alarms/alarm_subject.h"
#include "firmware/status/bus_meter.h"

namespace etcm::firmware {

namespace {

void write_about_node(std::uint64_t serial, TextWriter& piece) {
  piece << ",\"about\":{\"node\":" << serial << "}";
}

void write_about_feature(const Gateway& gateway, std::uint64_t subject, TextWriter& piece) {
  const std::span<const FeatureRecord> features = gateway.features();
  const auto found = std::find_if(features.begin(), features.end(), [&](const auto& feature) {
    return subject_of(feature.settings) == subject;
  });
  if (found == features.end()) return;
  piece << ",\"about\":{\"feature\":" << found - features.begin() + 1;
  for (const FeatureEnd& end : {found->settings.from, found->settings.to}) {
    if (end.is_anchor) continue;
    piece << ",\"node\":" << end.serial.value;
    break;
  }
  piece << "}";
}

void write_about_bus(const Gateway& gateway, std::uint64_t subject, TextWriter& piece) {
  const Poller& poller = gateway.poller();
  const BusIndex bus = bus_of_subject(poller, subject);
  if (bus.is_none()) return;
  piece << ",\"about\":{\"bus\":";
  piece.json(bus_label(poller, bus)) << "}";
}

void write_about_unit(const Gateway& gateway, std::uint64_t subject, TextWriter& piece) {
  const Poller& poller = gateway.poller();
  const UnitIndex unit = unit_of_subject(poller, subject);
  if (unit.is_none()) return;
  piece << ",\"about\":{\"bus\":";
  piece.json(bus_label(poller, poller.bus_of(unit)))
      << ",\"unit\":" << poller.address_of(unit).value << "}";
}

void write_about_sensor(const Gateway& gateway, std::uint64_t subject, TextWriter& piece) {
  const ReadingSnapshot& readings = gateway.readings();
  for (const PublishedReading& reading : readings.readings) {
    const Quantity& quantity = readings.quantities[reading.quantity.value];
    if (subject_of(quantity.name, reading.serial.value) != subject) continue;
    return write_about_node(reading.serial.value, piece);
  }
}

void write_about_gateway(const Gateway& gateway, std::uint64_t subject, TextWriter& piece) {
  const ReportedMember* const member = member_of_subject(gateway.fleet(), subject);
  if (member == nullptr) return;
  piece << ",\"about\":{\"gateway\":";
  piece.json(member->name) << "}";
}

}  // namespace

void write_about(const Gateway& gateway, AlarmKey key, TextWriter& piece) {
  switch (key.kind) {
    case AlarmKind::missing_node:
    case AlarmKind::no_fix:
    case AlarmKind::low_battery:
    case AlarmKind::far_node:
    case AlarmKind::refused_node:
    case AlarmKind::unheard_end:
      return write_about_node(key.subject, piece);
    case AlarmKind::identity_conflict:
      return write_about_node(key.subject >> 32, piece);
    case AlarmKind::disagreeing_sensor:
      return write_about_sensor(gateway, key.subject, piece);
    case AlarmKind::refused_feature:
      return write_about_feature(gateway, key.subject, piece);
    case AlarmKind::silent_bus:
      return write_about_bus(gateway, key.subject, piece);
    case AlarmKind::never_answered:
    case AlarmKind::faulty_unit:
      return write_about_unit(gateway, key.subject, piece);
    case AlarmKind::gone_gateway:
    case AlarmKind::name_taken:
    case AlarmKind::other_mesh:
    case AlarmKind::rejected_gateway:
      return write_about_gateway(gateway, key.subject, piece);
    case AlarmKind::not_served:
    case AlarmKind::late_mesh:
    case AlarmKind::refused_configuration:
    case AlarmKind::refused_anchor:
    case AlarmKind::no_broker:
    case AlarmKind::refused_by_broker:
    case AlarmKind::site_of_fleet:
    case AlarmKind::disk_of_files:
    case AlarmKind::disk_of_state:
    case AlarmKind::no_page:
      return;
  }
}

}  // namespace etcm::firmware
