#include "firmware/config/settings.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "etcm/files/error.h"
#include "etcm/files/record_reader.h"
#include "firmware/config/section.h"
#include "firmware/config/settings_keys.h"
#include "firmware/config/settings_types.h"

namespace etcm::firmware {

namespace {

// ---- Reading by the table of keys.

// As the person would write it.
std::string example_of(const Key& key) { return std::string(key.name) + " = " + key.standard.toml; }

void require(Section& section, const KeyTable& table, const char* name) {
  section.require(name, example_of(key_of(table, name)));
}

// `bus` is the kind of a target that is a bus.
void read_values(const KeyTable& table, Section& section, const std::filesystem::path& folder,
                 Target target, BusKind bus) {
  for (const Key& key : table.keys) {
    if (!is_key_of(key, bus)) continue;
    read_value(
        key.type,
        {.section = section, .name = key.name, .example = key.standard.toml, .folder = folder},
        target);
  }
}

void read_keys(const KeyTable& table, Section& section, const std::filesystem::path& folder,
               Target target, BusKind bus = BusKind::any) {
  for (const Key& key : table.keys) {
    if (key.standard.kind == Standard::Kind::required) require(section, table, key.name);
  }
  read_values(table, section, folder, target, bus);
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
  Section section(file, parsed, heading_of(table), mistakes);
  read_values(table, section, {}, target, bus);
  if (!mistakes.empty()) throw std::logic_error(mistakes.front());
}

// ---- What is between keys.

// Whether the gateway asks this unit of the bus at all.
bool has_unit(const BusSettings& bus, unsigned unit) {
  const auto holds = [unit](const std::vector<UnitRange>& ranges) {
    return std::any_of(ranges.begin(), ranges.end(), [unit](UnitRange range) {
      return range.first <= unit && unit <= range.last;
    });
  };
  return holds(bus.units) || holds(bus.assign) || holds(bus.scan) ||
         (unit == default_unit && !bus.assign.empty());
}

void check_poll(Section& section, Settings& settings) {
  if (settings.poll.leave_after > settings.poll.interval) return;
  const toml::node* culprit = section.find("leave_after");
  if (culprit == nullptr) culprit = section.find("interval");
  section.mistake(culprit != nullptr ? *culprit : section.table(),
                  "leave_after is not longer than interval, so nodes would leave between two "
                  "questions; make leave_after several times as long as interval");
}

void check_gpio(Section& section, Settings& settings) {
  const bool is_asked =
      std::any_of(settings.buses.begin(), settings.buses.end(),
                  [](const BusSettings& bus) { return has_unit(bus, default_unit); });
  if ((settings.gpio.alert || settings.gpio.join_button) && !is_asked) {
    section.mistake(section.table(),
                    "alert and join_button make the gateway look for a new node at unit 247, which "
                    "is on no bus; add 247 to the units of one");
  }
}

void check_http(Section& section, Settings& settings) {
  const port::SocketAddress& page = settings.http->listen;
  const port::SocketAddress& server = settings.server.listen;
  if (page.port != 0 && page.port == server.port &&
      (page.host == server.host || page.host == 0 || server.host == 0)) {
    section.mistake(section.table(), "the page and [server] would both listen on port " +
                                         std::to_string(server.port) + "; give one another");
  }
}

// The transceiver has one master, new nodes have a unit to themselves.
void check_bus(Section& section, const KeyTable& table, const BusSettings& bus) {
  const auto* const line = std::get_if<port::SerialLine>(&bus.link);
  if (line != nullptr && bus.send_enable && line->direction == port::Direction::kernel) {
    section.mistake(*section.find("rs485_line"),
                    "both the driver and a line would switch the transceiver; take rs485 or "
                    "rs485_line out");
  }
  if (section.find("assign") == nullptr && section.find("scan") == nullptr) {
    require(section, table, "units");
  }
  const bool gives_default = std::any_of(bus.assign.begin(), bus.assign.end(), [](UnitRange range) {
    return range.last == default_unit;
  });
  if (gives_default) {
    section.mistake(*section.find("assign"),
                    "247 is where new nodes answer and cannot be given to one; take it out");
  }
}

// Two buses may be behind one address, with different units; a serial port has one master.
void check_against(Section& section, const BusSettings& bus, const BusSettings& other) {
  const auto* const line = std::get_if<port::SerialLine>(&bus.link);
  const auto* const other_line = std::get_if<port::SerialLine>(&other.link);
  if (line != nullptr && other_line != nullptr && line->path == other_line->path) {
    section.mistake(section.table(), "another [[bus]] has the serial port " + line->path +
                                         "; put the units of both into one");
    return;
  }
  const auto* const address = std::get_if<port::SocketAddress>(&bus.link);
  const auto* const other_address = std::get_if<port::SocketAddress>(&other.link);
  if (address != nullptr && other_address != nullptr && address->host == other_address->host &&
      address->port == other_address->port) {
    for (unsigned unit = 1; unit <= unit_max; ++unit) {
      if (!has_unit(bus, unit) || !has_unit(other, unit)) continue;
      section.mistake(section.table(), "unit " + std::to_string(unit) + " at " +
                                           to_string(*address) +
                                           " is asked by another [[bus]] too; take it out of one");
      return;
    }
  }
  if (bus.name == other.name) {
    section.mistake(section.table(),
                    "two buses are named '" + bus.name + "'; give one another 'name'");
  }
}

// ---- Lists of tables.

// Units of the bus that need a timeout of their own.
void read_slow(Section& section, BusSettings& bus) {
  SlowUnits slow{.units = {}, .timeout = bus.timeout};
  read_keys(key_table("bus.slow"), section, {}, &slow);
  for (const UnitRange range : slow.units) {
    bus.unit_timeouts.push_back({.units = range, .timeout = slow.timeout});
    if (bus.units.empty() && bus.assign.empty() && bus.scan.empty()) continue;
    for (unsigned unit = range.first; unit <= range.last; ++unit) {
      if (has_unit(bus, unit)) continue;
      section.mistake(*section.find("units"), "unit " + std::to_string(unit) +
                                                  " is not among the units of its bus; add it "
                                                  "there, or take it out here");
      break;
    }
  }
}

// Modbus RTU or TCP, by the key that is there.
BusKind read_kind(Section& section) {
  const toml::node* const rtu = section.find("rtu");
  const toml::node* const tcp = section.find("tcp");
  if (rtu != nullptr && tcp != nullptr) {
    section.mistake(*tcp, "a bus with both 'tcp' and 'rtu'; take one out, or make it two buses");
  }
  if (rtu == nullptr && tcp == nullptr) {
    section.mistake(section.table(),
                    "[[bus]] has neither 'tcp' nor 'rtu'; add one, such as tcp = "
                    "\"127.0.0.1:502\" or rtu = \"/dev/serial/by-path/...\"");
  }
  return rtu != nullptr ? BusKind::rtu : BusKind::tcp;
}

void read_bus(Section& section, Settings& settings) {
  const KeyTable& table = key_table("bus");
  const BusKind kind = read_kind(section);
  BusSettings bus;
  if (kind == BusKind::rtu) bus.link = port::SerialLine{};
  set_defaults(table, &bus, kind);
  bus.timeout = settings.poll.timeout;
  bus.outstanding_max = kind == BusKind::rtu ? 1 : settings.poll.outstanding_max;
  read_keys(table, section, {}, &bus, kind);
  if (bus.name.empty()) bus.name = link_name(bus);
  check_bus(section, table, bus);
  section.each("slow", [&](Section& slow) { read_slow(slow, bus); });
  for (const BusSettings& other : settings.buses) check_against(section, bus, other);
  settings.buses.push_back(std::move(bus));
}

void read_feature(Section& section, Settings& settings) {
  FeatureSettings feature{.from = {}, .to = {}, .name = {}, .place = section.place()};
  read_keys(key_table("feature"), section, {}, &feature);
  if (section.find("from") && section.find("to") && feature.from == feature.to) {
    section.mistake(section.table(), "a feature from node " + to_string(feature.from) +
                                         " to itself; give two different serials");
  }
  settings.features.push_back(std::move(feature));
}

// ---- The whole file.

void note_site(Section& section, Settings& settings) { settings.site.place = section.place(); }

// What is done with a table: each of a list is read into something new, any other is read into the
// settings and then checked.
struct TableWork {
  std::string_view table;
  void (*work)(Section&, Settings&);
};
constexpr TableWork list_readers[] = {{"bus", read_bus}, {"feature", read_feature}};
constexpr TableWork checks[] = {
    {"site", note_site}, {"poll", check_poll}, {"gpio", check_gpio}, {"http", check_http}};

void read_list(Section& file, const KeyTable& table, Settings& settings) {
  const auto reader = std::find_if(std::begin(list_readers), std::end(list_readers),
                                   [&](const TableWork& work) { return work.table == table.name; });
  if (reader == std::end(list_readers)) {
    throw std::logic_error("nothing reads " + heading_of(table));
  }
  file.each(table.name, [&](Section& section) { reader->work(section, settings); });
}

void read_table(Section& file, const KeyTable& table, const std::filesystem::path& folder,
                Settings& settings) {
  if (table.begin == nullptr) set_defaults(table, &settings);
  file.sub(table.name, [&](Section& section) {
    if (table.begin != nullptr) {
      table.begin(settings);
      set_defaults(table, &settings);
    }
    read_keys(table, section, folder, &settings);
    for (const TableWork& check : checks) {
      if (check.table == table.name) check.work(section, settings);
    }
  });
}

void read_all(Section& file, const std::filesystem::path& folder, Settings& settings) {
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
  Section file(path, parsed, "", mistakes);
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

port::Duration timeout_of(const BusSettings& bus, std::uint8_t unit) {
  port::Duration timeout = bus.timeout;
  for (const UnitTimeout& other : bus.unit_timeouts) {
    if (other.units.first <= unit && unit <= other.units.last) timeout = other.timeout;
  }
  return timeout;
}

}  // namespace etcm::firmware
