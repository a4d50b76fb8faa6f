#include "firmware/alarms/alarm_subject.h"

#include <algorithm>
#include <array>

#include "firmware/fleet/fleet_hash.h"

namespace etcm::firmware {

std::uint64_t subject_of(std::string_view name, std::uint32_t number) {
  std::array<char, sizeof number> bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<char>(number >> (8 * i) & 0xff);
  }
  return fnv_hash({bytes.data(), bytes.size()}, fnv_hash(name));
}

std::string_view gateway_of(const Gateway& gateway, const NodeRecord& node) {
  const std::string_view name = gateway_name(gateway.snapshot(), node.owner);
  return name.empty() ? std::string_view("of the fleet") : name;
}

bool is_with_its_gateway(const Gateway& gateway, const NodeRecord& node) {
  const FleetReport* const fleet = gateway.fleet();
  if (!node.is_foreign() || fleet == nullptr) return false;
  return std::any_of(fleet->members.begin(), fleet->members.end(), [&](const auto& member) {
    return member.has_left && member.name == gateway_of(gateway, node);
  });
}

BusIndex bus_of_subject(const Poller& poller, std::uint64_t subject) {
  for (BusIndex bus{0}; bus.value < poller.bus_count(); ++bus.value) {
    if (subject_of(poller.bus(bus).name) == subject) return bus;
  }
  return BusIndex::none();
}

UnitIndex unit_of_subject(const Poller& poller, std::uint64_t subject) {
  for (UnitIndex unit{0}; unit.value < poller.unit_count(); ++unit.value) {
    const std::string_view bus = poller.bus(poller.bus_of(unit)).name;
    if (subject_of(bus, poller.address_of(unit).value) == subject) return unit;
  }
  return UnitIndex::none();
}

const ReportedMember* member_of_subject(const FleetReport* fleet, std::uint64_t subject) {
  if (fleet == nullptr) return nullptr;
  const auto found =
      std::find_if(fleet->members.begin(), fleet->members.end(),
                   [&](const auto& member) { return subject_of(member.name) == subject; });
  return found == fleet->members.end() ? nullptr : &*found;
}

Serial node_of_subject(AlarmKey key) {
  switch (key.kind) {
    case AlarmKind::missing_node:
    case AlarmKind::no_fix:
    case AlarmKind::low_battery:
    case AlarmKind::far_node:
    case AlarmKind::refused_node:
    case AlarmKind::unheard_end:
      return Serial{static_cast<std::uint32_t>(key.subject)};
    case AlarmKind::identity_conflict:
      return Serial{static_cast<std::uint32_t>(key.subject >> 32)};
    default:
      return Serial::none();
  }
}

bool is_about_here(const Gateway& gateway, AlarmKey key) {
  switch (key.kind) {
    case AlarmKind::gone_gateway:
    case AlarmKind::other_mesh:
    case AlarmKind::rejected_gateway:
      return false;
    case AlarmKind::name_taken:
      return gateway.fleet() != nullptr && key.subject == subject_of(gateway.fleet()->name);
    case AlarmKind::missing_node:
    case AlarmKind::refused_node: {
      const NodeRecord* const node = gateway.nodes().find(node_of_subject(key));
      return node != nullptr && !node->is_foreign();
    }
    case AlarmKind::identity_conflict:
      // It answers at a unit here (look_at_refused()).
      return static_cast<std::uint32_t>(key.subject) != 0;
    default:
      return true;
  }
}

bool is_there(const Gateway& gateway, AlarmKey key) {
  const std::uint64_t subject = key.subject;
  const auto is_it = [subject](const auto& each) { return subject_of(each) == subject; };
  switch (key.kind) {
    case AlarmKind::silent_bus:
      return !bus_of_subject(gateway.poller(), subject).is_none();
    case AlarmKind::never_answered:
    case AlarmKind::faulty_unit:
      return !unit_of_subject(gateway.poller(), subject).is_none();
    case AlarmKind::missing_node:
    case AlarmKind::no_fix:
    case AlarmKind::low_battery:
    case AlarmKind::far_node:
    case AlarmKind::refused_node:
    case AlarmKind::unheard_end:  // that is known by now, or no feature ends there
      return gateway.nodes().find(Serial{static_cast<std::uint32_t>(subject)}) != nullptr;
    case AlarmKind::refused_feature: {
      const auto& features = gateway.settings().features;
      return std::any_of(features.begin(), features.end(), is_it);
    }
    case AlarmKind::refused_anchor: {
      const auto& anchors = gateway.settings().anchors;
      return std::any_of(anchors.begin(), anchors.end(),
                         [&](const AnchorSettings& anchor) { return is_it(anchor.position); });
    }
    case AlarmKind::no_broker:
    case AlarmKind::refused_by_broker:
    case AlarmKind::site_of_fleet:
      return gateway.fleet() != nullptr;
    case AlarmKind::name_taken:
    case AlarmKind::gone_gateway:
    case AlarmKind::other_mesh:
    case AlarmKind::rejected_gateway:
      return member_of_subject(gateway.fleet(), subject) != nullptr;
    case AlarmKind::disk_of_files:
      return gateway.disk_of_files() != nullptr;
    case AlarmKind::disk_of_state:
      return gateway.disk_of_state() != nullptr;
    default:
      return true;
  }
}

void write_node(TextLine& text, const Gateway& gateway, const NodeRecord& node) {
  text << gateway.nodes().called(node);
  if (node.is_foreign()) {
    text << " of gateway " << gateway_of(gateway, node);
  } else if (!node.last_unit.is_none()) {
    text << ", " << gateway.poller().name(node.last_unit).view() << ",";
  }
}

std::uint64_t subject_of(const FeatureSettings& feature) {
  std::uint64_t subject = 0;
  for (const FeatureEnd& end : {feature.from, feature.to}) {
    subject = (subject ^ end.key()) * 0x9e3779b97f4a7c15u + 1;
  }
  return subject;
}

namespace {

// The settings name a node by its serial.
bool is_written(const Settings& settings, Serial serial) {
  const auto is_its = [serial](const auto& each) { return each.serial == serial; };
  return std::any_of(
             settings.features.begin(), settings.features.end(),
             [serial](const FeatureSettings& feature) { return ends_at(feature, serial); }) ||
         std::any_of(settings.nodes.begin(), settings.nodes.end(),
                     [serial](const NodeSettings& node) { return node.serial == serial.value; }) ||
         std::any_of(settings.node_names.begin(), settings.node_names.end(), is_its);
}

}  // namespace

void write_missing_cure(TextLine& cure, const Gateway& gateway, const NodeRecord& node) {
  const Poller& poller = gateway.poller();
  const NodeRecord* const other =
      node.last_unit.is_none() ? nullptr : gateway.nodes().at(node.last_unit);
  if (other != nullptr && other->serial != node.serial) {
    cure << "node " << other->serial.value << " answers there now; if it is in its place: ";
    if (is_written(gateway.settings(), node.serial)) {
      cure << "write " << other->serial.value << " where the settings have " << node.serial.value
           << ", reload, and ";
    }
    cure << "sudo etcm-gateway ctl dismiss " << node.serial.value
         << "; how: /guide/#replace-a-node";
    return;
  }
  const bool is_heard = !node.last_unit.is_none() && poller.is_up(poller.bus_of(node.last_unit)) &&
                        !poller.is_sound(node.last_unit) &&
                        is_of_an_answer(poller.counters(node.last_unit).last_fault);
  cure << (is_heard ? "its unit answers, and nothing of that is of use (see its own alarm)"
                    : "look at its supply, its cable and its address")
       << "; if it is gone for good: sudo "
          "etcm-gateway ctl "
          "dismiss "
       << node.serial.value;
}

}  // namespace etcm::firmware
