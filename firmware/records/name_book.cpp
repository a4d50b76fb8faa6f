#include "firmware/records/name_book.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

namespace {

// The serial of what is at a unit, where the settings alone decide it.
Serial settled_serial(const Settings& settings, BusIndex bus, ModbusAddress address) {
  const DeviceSettings* const device = device_at(settings.buses[bus.value], address);
  const Profile* const profile =
      device == nullptr ? nullptr : find_profile(settings, device->profile);
  if (profile == nullptr || profile->serial) return Serial::none();
  return device_serial(settings, bus.value, address);
}

BusIndex bus_of(const NodeName& name, const Settings& settings, const Poller& poller) {
  for (BusIndex bus{0};
       bus.value < std::min<std::size_t>(settings.buses.size(), poller.bus_count()); ++bus.value) {
    if (settings.buses[bus.value].name == name.bus) return bus;
  }
  return BusIndex::none();
}

}  // namespace

NameBook::NameBook(const Settings& settings, const Poller& poller, std::vector<ToldName> told)
    : site_(settings.site.name) {
  for (const FeatureSettings& feature : settings.features) features_.push_back(feature.name);
  for (const NodeName& node : settings.node_names) {
    const NameIndex name{static_cast<std::uint32_t>(nodes_.size())};
    nodes_.push_back(node.name);
    Serial serial = node.serial;
    if (serial.is_none()) {
      const ModbusAddress address{static_cast<std::uint8_t>(node.address)};
      const BusIndex bus = bus_of(node, settings, poller);
      if (bus.is_none()) continue;
      const UnitIndex unit = poller.unit_at(bus, address);
      if (!unit.is_none()) by_unit_.push_back({.key = unit.value, .name = name});
      serial = settled_serial(settings, bus, address);
    }
    if (!serial.is_none()) by_serial_.push_back({.key = serial.value, .name = name});
  }
  const auto by_key = [](const Entry& a, const Entry& b) { return a.key < b.key; };
  std::stable_sort(by_serial_.begin(), by_serial_.end(), by_key);
  std::stable_sort(by_unit_.begin(), by_unit_.end(), by_key);
  for (ToldName& name : told) {
    told_.push_back(
        {.key = name.serial.value, .name = NameIndex{static_cast<std::uint32_t>(nodes_.size())}});
    nodes_.push_back(std::move(name.name));
  }
}

NameIndex NameBook::find(const std::vector<Entry>& entries, std::uint32_t key) {
  const auto found =
      std::lower_bound(entries.begin(), entries.end(), key,
                       [](const Entry& entry, std::uint32_t wanted) { return entry.key < wanted; });
  return found != entries.end() && found->key == key ? found->name : NameIndex::none();
}

NameIndex NameBook::find(Serial serial, UnitIndex unit) const {
  const NameIndex name = find(by_serial_, serial.value);
  if (!name.is_none()) return name;
  return find(unit.is_none() ? told_ : by_unit_, unit.is_none() ? serial.value : unit.value);
}

}  // namespace etcm::firmware
