// What the settings say of a bus, and of the units that it asks.
#include <algorithm>
#include <utility>

#include "firmware/config/settings.h"

namespace etcm::firmware {

namespace {

const BusSettings* bus_named(const Settings& settings, const std::string& name) {
  const auto found = std::find_if(settings.buses.begin(), settings.buses.end(),
                                  [&](const BusSettings& bus) { return bus.name == name; });
  return found == settings.buses.end() ? nullptr : &*found;
}

}  // namespace

bool contain(const std::vector<UnitRange>& ranges, ModbusAddress unit) {
  return std::any_of(ranges.begin(), ranges.end(),
                     [unit](UnitRange range) { return range.contains(unit); });
}

Asked asked(const BusSettings& bus, ModbusAddress unit) {
  if (contain(bus.units, unit) || contain(bus.assign, unit) ||
      (unit == default_unit && !bus.assign.empty())) {
    return Asked::always;
  }
  return contain(bus.scan, unit) ? Asked::looked_for : Asked::never;
}

std::string link_name(const BusSettings& bus) {
  const auto* const line = std::get_if<port::SerialLine>(&bus.link);
  return line != nullptr ? line->path : to_string(std::get<port::Endpoint>(bus.link));
}

port::Duration exchange_floor(const port::SerialLine& line) {
  constexpr std::int64_t question_characters = 8;
  constexpr std::int64_t answer_characters = 5 + 2 * node_register_count;
  return (question_characters + answer_characters) * character_time(line) + 2 * frame_silence(line);
}

const DeviceSettings* device_at(const BusSettings& bus, ModbusAddress address) {
  for (const DeviceSettings& device : bus.devices) {
    for (const UnitRange range : device.units) {
      if (range.contains(address)) return &device;
    }
  }
  return nullptr;
}

port::Duration timeout_of(const BusSettings& bus, ModbusAddress address) {
  const DeviceSettings* const device = device_at(bus, address);
  return device != nullptr ? device->timeout : bus.timeout;
}

const NodeSettings* node_at(const Settings& settings, const BusSettings& bus,
                            ModbusAddress address) {
  for (const NodeSettings& node : settings.nodes) {
    if (node.bus == bus.name && node.address == address.value) return &node;
  }
  return nullptr;
}

NodeMistake find_bus(const Settings& settings, std::uint32_t address, std::string& name) {
  const bool is_named = !name.empty();
  if (!is_named && settings.buses.size() == 1) name = settings.buses.front().name;
  const BusSettings* const bus = bus_named(settings, name);
  if (bus == nullptr) {
    return {"bus", is_named ? "no [[bus]] is named '" + name + "'; correct one of the names"
                            : "there are several buses; add 'bus' with the name of one"};
  }
  if (!asks(*bus, ModbusAddress{static_cast<std::uint8_t>(address)})) {
    return {"unit", "unit " + std::to_string(address) + " of " + name +
                        " is not asked; add it to the units of its bus or of a [[bus.device]]"};
  }
  return {};
}

NodeMistake add_node(Settings& settings, NodeSettings node) {
  NodeMistake wrong = find_bus(settings, node.address, node.bus);
  if (!wrong.what.empty()) return wrong;
  const ModbusAddress unit{static_cast<std::uint8_t>(node.address)};
  const DeviceSettings* const device = device_at(*bus_named(settings, node.bus), unit);
  const std::string who = "unit " + std::to_string(node.address) + " of " + node.bus;
  if (device == nullptr || device->profile == node_profile) {
    return {"unit", who +
                        " tells its serial and where it stands itself; give it another profile in "
                        "a [[bus.device]], or take out what is said of it here"};
  }
  for (const NodeSettings& other : settings.nodes) {
    if (other.bus == node.bus && other.address == node.address) {
      return {"unit",
              "the device of " + other.source + " once more; put what is known into one place"};
    }
    if (node.serial && other.serial == node.serial) {
      return {"serial", "serial " + std::to_string(*node.serial) + " is that of " + other.source +
                            " too; give one another"};
    }
  }
  settings.nodes.push_back(std::move(node));
  return {};
}

Serial device_serial(const Settings& settings, std::size_t bus, ModbusAddress address) {
  constexpr std::uint32_t per_bus = 1000;
  const NodeSettings* const node = node_at(settings, settings.buses[bus], address);
  if (node != nullptr && node->serial) return Serial{*node->serial};
  return Serial{per_bus * (static_cast<std::uint32_t>(bus) + 1) + address.value};
}

const Profile* find_profile(const Settings& settings, const std::string& name) {
  const auto found = std::find_if(settings.device_profiles.begin(), settings.device_profiles.end(),
                                  [&](const Profile& profile) { return profile.name == name; });
  return found != settings.device_profiles.end() ? &*found : nullptr;
}

}  // namespace etcm::firmware
