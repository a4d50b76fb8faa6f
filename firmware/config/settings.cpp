#include "firmware/config/settings.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "etcm/files/error.h"
#include "etcm/files/record_reader.h"
#include "firmware/config/settings_keys.h"
#include "firmware/config/settings_types.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

namespace {

// ---- Reading by the table of keys.

// As the person would write it.
std::string example_of(const Key& key) { return std::string(key.name) + " = " + key.standard.toml; }

void require(TomlTable& toml_table, const KeyTable& table, const char* name) {
  toml_table.require(name, example_of(key_of(table, name)));
}

// `bus` is the kind of a target that is a bus.
void read_values(const KeyTable& table, TomlTable& toml_table, const std::filesystem::path& folder,
                 Target target, BusKind bus) {
  for (const Key& key : table.keys) {
    if (!is_key_of(key, bus)) continue;
    read_value(key.type,
               {.toml_table = toml_table,
                .name = key.name,
                .example = key.standard.toml,
                .folder = folder},
               target);
  }
}

void read_keys(const KeyTable& table, TomlTable& toml_table, const std::filesystem::path& folder,
               Target target, BusKind bus = BusKind::any) {
  for (const Key& key : table.keys) {
    if (key.standard.kind == Standard::Kind::required) require(toml_table, table, key.name);
  }
  read_values(table, toml_table, folder, target, bus);
}

// Defaults are read as if the file had them.
void set_defaults(const KeyTable& table, Target target, BusKind bus = BusKind::any) {
  std::string text;
  for (const Key& key : table.keys) {
    if (is_key_of(key, bus) && key.standard.kind == Standard::Kind::value) {
      text += example_of(key) + "\n";
    }
  }
  const std::string file = "defaults of " + heading_of(table);
  const toml::table parsed = toml::parse(text, file);
  std::vector<std::string> mistakes;
  TomlTable toml_table(file, parsed, heading_of(table), mistakes);
  read_values(table, toml_table, {}, target, bus);
  if (!mistakes.empty()) throw std::logic_error(mistakes.front());
}

// ---- What is between keys.

// Whether the gateway asks this unit of the bus at all.
bool has_unit(const BusSettings& bus, ModbusAddress unit) {
  const auto holds = [unit](const std::vector<UnitRange>& ranges) {
    return std::any_of(ranges.begin(), ranges.end(),
                       [unit](UnitRange range) { return range.contains(unit); });
  };
  return holds(bus.units) || holds(bus.assign) || holds(bus.scan) ||
         (unit == default_unit && !bus.assign.empty());
}

void check_poll(TomlTable& toml_table, Settings& settings) {
  if (settings.poll.leave_after > settings.poll.interval) return;
  const toml::node* culprit = toml_table.find("leave_after");
  if (culprit == nullptr) culprit = toml_table.find("interval");
  toml_table.mistake(culprit != nullptr ? *culprit : toml_table.table(),
                     "leave_after is not longer than interval, so nodes would leave between two "
                     "questions; make leave_after several times as long as interval");
}

void check_gpio(TomlTable& toml_table, Settings& settings) {
  const bool is_asked =
      std::any_of(settings.buses.begin(), settings.buses.end(),
                  [](const BusSettings& bus) { return has_unit(bus, default_unit); });
  if ((settings.gpio.alert || settings.gpio.join_button) && !is_asked) {
    toml_table.mistake(
        toml_table.table(),
        "alert and join_button make the gateway look for a new node at unit 247, which "
        "is on no bus; add 247 to the units of one");
  }
}

void check_http(TomlTable& toml_table, Settings& settings) {
  const port::SocketAddress& page = settings.http->listen;
  const port::SocketAddress& server = settings.server.listen;
  if (page.port != 0 && page.port == server.port &&
      (page.host == server.host || page.host == 0 || server.host == 0)) {
    toml_table.mistake(toml_table.table(), "the page and [server] would both listen on port " +
                                               std::to_string(server.port) + "; give one another");
  }
}

// The transceiver has one master, new nodes have a unit to themselves.
void check_bus(TomlTable& toml_table, const KeyTable& table, const BusSettings& bus) {
  const auto* const line = std::get_if<port::SerialLine>(&bus.link);
  if (line != nullptr && bus.send_enable && line->direction == port::Direction::kernel) {
    toml_table.mistake(*toml_table.find("rs485_line"),
                       "both the driver and a line would switch the transceiver; take rs485 or "
                       "rs485_line out");
  }
  if (toml_table.find("assign") == nullptr && toml_table.find("scan") == nullptr) {
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
  const auto* const address = std::get_if<port::SocketAddress>(&bus.link);
  const auto* const other_address = std::get_if<port::SocketAddress>(&other.link);
  if (address != nullptr && other_address != nullptr && address->host == other_address->host &&
      address->port == other_address->port) {
    for (const ModbusAddress unit : UnitRange{.first = 1, .last = unit_max}) {
      if (!has_unit(bus, unit) || !has_unit(other, unit)) continue;
      toml_table.mistake(toml_table.table(),
                         "unit " + std::to_string(unit.value) + " at " + to_string(*address) +
                             " is asked by another [[bus]] too; take it out of one");
      return;
    }
  }
  if (bus.name == other.name) {
    toml_table.mistake(toml_table.table(),
                       "two buses are named '" + bus.name + "'; give one another 'name'");
  }
}

// ---- Lists of tables.

// Units of the bus that need a timeout of their own.
void read_slow(TomlTable& toml_table, BusSettings& bus) {
  SlowUnits slow{.units = {}, .timeout = bus.timeout};
  read_keys(key_table("bus.slow"), toml_table, {}, &slow);
  for (const UnitRange range : slow.units) {
    bus.unit_timeouts.push_back({.units = range, .timeout = slow.timeout});
    if (bus.units.empty() && bus.assign.empty() && bus.scan.empty()) continue;
    for (const ModbusAddress unit : range) {
      if (has_unit(bus, unit)) continue;
      toml_table.mistake(*toml_table.find("units"),
                         "unit " + std::to_string(unit.value) +
                             " is not among the units of its bus; add it "
                             "there, or take it out here");
      break;
    }
  }
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
  check_bus(toml_table, table, bus);
  toml_table.each("slow", [&](TomlTable& slow) { read_slow(slow, bus); });
  for (const BusSettings& other : settings.buses) check_against(toml_table, bus, other);
  settings.buses.push_back(std::move(bus));
}

void read_feature(TomlTable& toml_table, Settings& settings) {
  FeatureSettings feature{.from = {}, .to = {}, .name = {}, .source = toml_table.place()};
  read_keys(key_table("feature"), toml_table, {}, &feature);
  if (toml_table.find("from") && toml_table.find("to") && feature.from == feature.to) {
    toml_table.mistake(toml_table.table(), "a feature from node " + to_string(feature.from) +
                                               " to itself; give two different serials");
  }
  settings.features.push_back(std::move(feature));
}

// ---- The whole file.

void note_site(TomlTable& toml_table, Settings& settings) {
  settings.site.source = toml_table.place();
}

// What is done with a table: each of a list is read into something new, any other is read into the
// settings and then checked.
struct TableWork {
  std::string_view table;
  void (*work)(TomlTable&, Settings&);
};
constexpr TableWork list_readers[] = {{"bus", read_bus}, {"feature", read_feature}};
constexpr TableWork checks[] = {
    {"site", note_site}, {"poll", check_poll}, {"gpio", check_gpio}, {"http", check_http}};

void read_list(TomlTable& file, const KeyTable& table, Settings& settings) {
  const auto reader = std::find_if(std::begin(list_readers), std::end(list_readers),
                                   [&](const TableWork& work) { return work.table == table.name; });
  if (reader == std::end(list_readers)) {
    throw std::logic_error("nothing reads " + heading_of(table));
  }
  file.each(table.name, [&](TomlTable& toml_table) { reader->work(toml_table, settings); });
}

void read_table(TomlTable& file, const KeyTable& table, const std::filesystem::path& folder,
                Settings& settings) {
  if (table.begin == nullptr) set_defaults(table, &settings);
  file.sub(table.name, [&](TomlTable& toml_table) {
    if (table.begin != nullptr) {
      table.begin(settings);
      set_defaults(table, &settings);
    }
    read_keys(table, toml_table, folder, &settings);
    for (const TableWork& check : checks) {
      if (check.table == table.name) check.work(toml_table, settings);
    }
  });
}

void read_all(TomlTable& file, const std::filesystem::path& folder, Settings& settings) {
  for (const KeyTable& table : key_tables()) {
    if (table.required != nullptr) file.require(table.name, table.required);
    if (table.kind != KeyTable::Kind::list) {
      read_table(file, table, folder, settings);
    } else if (!is_nested(table)) {
      read_list(file, table, settings);
    }
  }
}

}  // namespace

Settings read_settings(const std::string& path, std::vector<std::string>& mistakes) {
  Settings settings;
  toml::table parsed;
  try {
    parsed = toml::parse(files::read_bytes(path), path);
  } catch (const files::InputError& error) {
    mistakes.push_back(std::string(error.what()) + "; give the path of the settings");
    return settings;
  } catch (const toml::parse_error& error) {
    mistakes.push_back(path + ":" + std::to_string(error.source().begin.line) + ": " +
                       std::string(error.description()) +
                       "; correct the TOML there (texts stand in quotes)");
    return settings;
  }
  const std::size_t before = mistakes.size();
  TomlTable file(path, parsed, "", mistakes);
  read_all(file, std::filesystem::path(path).parent_path(), settings);
  file.finish();
  // Keys come in alphabetical order; a person reads from the top of the file.
  const auto line = [&](const std::string& mistake) {
    return std::strtoul(mistake.c_str() + path.size() + 1, nullptr, 10);
  };
  std::stable_sort(mistakes.begin() + static_cast<std::ptrdiff_t>(before), mistakes.end(),
                   [&](const std::string& a, const std::string& b) { return line(a) < line(b); });
  return settings;
}

std::string link_name(const BusSettings& bus) {
  const auto* const line = std::get_if<port::SerialLine>(&bus.link);
  return line != nullptr ? line->path : to_string(std::get<port::SocketAddress>(bus.link));
}

port::Duration timeout_of(const BusSettings& bus, ModbusAddress address) {
  port::Duration timeout = bus.timeout;
  for (const UnitTimeout& other : bus.unit_timeouts) {
    if (other.units.contains(address)) timeout = other.timeout;
  }
  return timeout;
}

}  // namespace etcm::firmware
