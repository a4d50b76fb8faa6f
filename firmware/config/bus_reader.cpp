#include "firmware/config/bus_reader.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "firmware/config/key_reader.h"

namespace etcm::firmware {

namespace {

void check_rs485(TomlTable& toml_table, const BusSettings& bus, const port::Rs485& rs485) {
  if (bus.send_enable && rs485.mode == port::Rs485Mode::on) {
    toml_table.mistake(*toml_table.find("rs485_line"),
                       "both the driver and a line would switch the transceiver; take rs485 or "
                       "rs485_line out");
  }
  if (rs485.mode == port::Rs485Mode::on) return;
  for (const char* const key : {"rs485_rts", "rs485_delay_before", "rs485_delay_after"}) {
    if (const toml::node* const given = toml_table.find(key)) {
      toml_table.mistake(*given,
                         std::string("'") + key +
                             "' says how the driver switches, and rs485 does not say that it "
                             "does; add rs485 = \"on\", or take it out");
    }
  }
}

// Others come to an address.
void check_share(TomlTable& toml_table, const BusSettings& bus) {
  if (bus.share.listen) return;
  for (const char* const key :
       {"share_allow", "share_units", "share_writes", "share_time", "share_wait"}) {
    if (const toml::node* const given = toml_table.find(key)) {
      toml_table.mistake(*given, std::string("'") + key +
                                     "' says how others may use the bus, and share does not say "
                                     "where; add share = \"127.0.0.1:1510\", or take it out");
    }
  }
}

// The transceiver has one master, new nodes have a unit to themselves.
void check_bus(TomlTable& toml_table, const KeyTable& table, const BusSettings& bus) {
  const auto* const line = std::get_if<port::SerialLine>(&bus.link);
  if (line != nullptr) check_rs485(toml_table, bus, line->rs485);
  check_share(toml_table, bus);
  if (toml_table.find("assign") == nullptr && toml_table.find("scan") == nullptr &&
      toml_table.find("device") == nullptr) {
    require(toml_table, table, "units");
  }
  const bool gives_default = std::any_of(bus.assign.begin(), bus.assign.end(), [](UnitRange range) {
    return range.last == default_unit.value;
  });
  if (gives_default) {
    toml_table.mistake(*toml_table.find("assign"),
                       "247 is where new nodes answer and cannot be given to one; take it out");
  }
}

// Two buses may be behind one address, with different units; a serial port has one master.
void check_against(TomlTable& toml_table, const BusSettings& bus, const BusSettings& other) {
  const auto* const line = std::get_if<port::SerialLine>(&bus.link);
  const auto* const other_line = std::get_if<port::SerialLine>(&other.link);
  if (line != nullptr && other_line != nullptr && line->path == other_line->path) {
    toml_table.mistake(toml_table.table(), "another [[bus]] has the serial port " + line->path +
                                               "; put the units of both into one");
    return;
  }
  const auto* const end = std::get_if<port::Endpoint>(&bus.link);
  const auto* const other_end = std::get_if<port::Endpoint>(&other.link);
  if (end != nullptr && other_end != nullptr && *end == *other_end) {
    for (const ModbusAddress unit : UnitRange{.first = 1, .last = unit_max}) {
      if (!asks(bus, unit) || !asks(other, unit)) continue;
      toml_table.mistake(toml_table.table(),
                         "unit " + std::to_string(unit.value) + " at " + to_string(*end) +
                             " is asked by another [[bus]] too; take it out of one");
      return;
    }
  }
  if (bus.name == other.name) {
    toml_table.mistake(toml_table.table(),
                       "two buses are named '" + bus.name + "'; give one another 'name'");
  }
}

// A unit is one device.
void check_device(TomlTable& toml_table, const BusSettings& bus, const DeviceSettings& device) {
  for (const UnitRange range : device.units) {
    for (const ModbusAddress unit : range) {
      const DeviceSettings* const other = device_at(bus, unit);
      if (other == nullptr) continue;
      toml_table.mistake(*toml_table.find("units"), "unit " + std::to_string(unit.value) +
                                                        " is in the [[bus.device]] of " +
                                                        other->source + " too; take it out of one");
      return;
    }
  }
}

void check_speed(TomlTable& toml_table, const Profile* profile, const DeviceSettings& device) {
  if (!device.speed_max_nano) return;
  const toml::node& given = *toml_table.find("speed_max");
  if (*device.speed_max_nano <= 0) {
    toml_table.mistake(given, "'speed_max' must be above 0; write it as speed_max = \"30\"");
  }
  if (device.profile == node_profile) {
    toml_table.mistake(given,
                       "'speed_max' of nodes of our own, which tell by themselves whether they "
                       "changed while they were read; take it out");
  } else if (profile != nullptr && profile->positioning == Profile::Positioning::surveyed) {
    toml_table.mistake(given, "'speed_max' is about the position, and profile '" + profile->name +
                                  "' tells none; take it out");
  }
}

// Units of the bus that are other devices, or need a timeout of their own.
void read_device(TomlTable& toml_table, const Settings& settings, BusSettings& bus) {
  const KeyTable& table = key_table("bus.device");
  DeviceSettings device;
  device.source = toml_table.place();
  set_defaults(table, &device);
  device.timeout = bus.timeout;
  read_keys(table, toml_table, {}, &device);
  const Profile* const profile = find_profile(settings, device.profile);
  const toml::node* const name = toml_table.find("profile");
  if (profile != nullptr) {
    if (toml_table.find("pause") == nullptr) device.pause = profile->pause;
  } else if (name != nullptr && device.profile != node_profile && settings.has_all_profiles) {
    std::string known = node_profile;
    for (const Profile& other : settings.device_profiles) {
      if (!other.name.empty()) known += ", " + other.name;
    }
    toml_table.mistake(*name, "there is no profile '" + device.profile + "'; take one of " + known +
                                  ", or write a [[profile]]");
  }
  check_device(toml_table, bus, device);
  check_speed(toml_table, profile, device);
  for (const UnitRange range : device.units) {
    for (const ModbusAddress unit : range) {
      if (!asks(bus, unit)) bus.units.push_back({.first = unit.value, .last = unit.value});
    }
  }
  bus.devices.push_back(std::move(device));
}

// Modbus RTU or TCP, by the key that is there.
BusKind read_kind(TomlTable& toml_table) {
  const toml::node* const rtu = toml_table.find("rtu");
  const toml::node* const tcp = toml_table.find("tcp");
  if (rtu != nullptr && tcp != nullptr) {
    toml_table.mistake(*tcp, "a bus with both 'tcp' and 'rtu'; take one out, or make it two buses");
  }
  if (rtu == nullptr && tcp == nullptr) {
    toml_table.mistake(toml_table.table(),
                       "[[bus]] has neither 'tcp' nor 'rtu'; add one, such as tcp = "
                       "\"127.0.0.1:502\" or rtu = \"/dev/serial/by-path/...\"");
  }
  return rtu != nullptr ? BusKind::rtu : BusKind::tcp;
}

}  // namespace

void read_bus(TomlTable& toml_table, Settings& settings) {
  const KeyTable& table = key_table("bus");
  const BusKind kind = read_kind(toml_table);
  BusSettings bus;
  if (kind == BusKind::rtu) bus.link = port::SerialLine{};
  set_defaults(table, &bus, kind);
  bus.timeout = settings.poll.timeout;
  bus.outstanding_max = kind == BusKind::rtu ? 1 : settings.poll.outstanding_max;
  read_keys(table, toml_table, {}, &bus, kind);
  if (bus.name.empty()) bus.name = link_name(bus);
  if (bus.framing == Framing::rtu && bus.outstanding_max != 1) {
    if (const toml::node* const given = toml_table.find("outstanding")) {
      toml_table.mistake(*given,
                         "RTU frames have no numbers, so there is one question at a time; "
                         "take outstanding out");
    }
    bus.outstanding_max = 1;
  }
  check_bus(toml_table, table, bus);
  toml_table.each("device", [&](TomlTable& device) { read_device(device, settings, bus); });
  for (const BusSettings& other : settings.buses) check_against(toml_table, bus, other);
  settings.buses.push_back(std::move(bus));
}

}  // namespace etcm::firmware
