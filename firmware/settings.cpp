#include "settings.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

#include "etcm/analysis.h"
#include "etcm/files/decimal.h"
#include "etcm/files/error.h"
#include "etcm/files/record_reader.h"
#include "etcm/policy.h"
#include "mesh_map.h"
#include "node_map.h"
#include "section.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t unit_max = 247;

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

void read_mesh(Section& section, MeshConfig& mesh) {
  section.require("vertices_max", "vertices_max = 1000");
  section.read("vertices_max", mesh.vertices_max, 1,
               std::min(mesh_map_vertices_max(), vertices_limit));
  section.read("features_max", mesh.features_max, 0, features_limit);
  section.read("steiner_max", mesh.steiner_max, 0, vertices_limit);
  section.read("steps_max", mesh.steps_max, 0, std::numeric_limits<std::uint32_t>::max());
  section.read<SplitPolicy>("policy", mesh.policy,
                            {{"default", split_default}, {"paper", split_paper}});
}

void read_poll(Section& section, PollSettings& poll) {
  section.read("interval", poll.interval, 1ms);
  section.read("timeout", poll.timeout, 1ms);
  section.read("outstanding", poll.outstanding_max, 1, 32);
  section.read("absent_interval", poll.absent_interval, 1ms);
  section.read("stale_after", poll.stale_after, 1ms);
  section.read("leave_after", poll.leave_after, 1ms);
  section.read("dead_band", poll.dead_band, 0, static_cast<std::uint32_t>(position_max));
  if (poll.leave_after <= poll.interval) {
    const toml::node* culprit = section.find("leave_after");
    if (culprit == nullptr) culprit = section.find("interval");
    section.mistake(*culprit,
                    "leave_after is not longer than interval, so nodes would leave between two "
                    "questions; make leave_after several times as long as interval");
  }
}

port::SerialLine read_line(Section& section) {
  port::SerialLine line;
  section.read("rtu", line.path, "rtu = \"/dev/serial/by-path/...\"");
  section.read("baud", line.baud, 1200, 921600);
  if (const toml::node* node = section.find("baud"); node != nullptr && !port::is_baud(line.baud)) {
    section.mistake(*node,
                    "'baud' is no usual speed; give 1200, 2400, 4800, 9600, 19200, 38400, 57600, "
                    "115200, 230400, 460800 or 921600");
  }
  section.read<port::Parity>(
      "parity", line.parity,
      {{"none", port::Parity::none}, {"even", port::Parity::even}, {"odd", port::Parity::odd}});
  std::uint32_t stop_bits = line.stop_bits;
  section.read("stop_bits", stop_bits, 1, 2);
  line.stop_bits = static_cast<std::uint8_t>(stop_bits);
  section.read<port::Direction>(
      "rs485", line.direction,
      {{"adapter", port::Direction::adapter}, {"kernel", port::Direction::kernel}});
  return line;
}

// The link, and what only this kind of link has.
void read_link(Section& section, BusSettings& bus) {
  const toml::node* const rtu = section.find("rtu");
  const toml::node* const tcp = section.find("tcp");
  if (rtu != nullptr) {
    if (tcp != nullptr) {
      section.mistake(*tcp, "a bus with both 'tcp' and 'rtu'; take one out, or make it two buses");
    }
    const port::SerialLine line = read_line(section);
    bus.outstanding_max = 1;
    section.read("quiet", bus.quiet, 0ms);
    section.read("rs485_line", bus.send_enable);
    if (bus.send_enable && line.direction == port::Direction::kernel) {
      section.mistake(*section.find("rs485_line"),
                      "both the driver and a line would switch the transceiver; take rs485 or "
                      "rs485_line out");
    }
    bus.name = line.path;
    bus.link = line;
    return;
  }
  if (tcp == nullptr) {
    section.mistake(section.table(),
                    "[[bus]] has neither 'tcp' nor 'rtu'; add one, such as tcp = "
                    "\"127.0.0.1:502\" or rtu = \"/dev/serial/by-path/...\"");
  }
  port::SocketAddress address;
  section.read("tcp", address);
  section.read("outstanding", bus.outstanding_max, 1, 32);
  bus.name = to_string(address);
  bus.link = address;
}

// Units from 1 to 247; where the text is wrong, none.
std::vector<UnitRange> read_units(Section& section, const std::string& key = "units") {
  const toml::node* const node = section.find(key);
  if (node == nullptr) return {};
  const auto text = node->value_exact<std::string>();
  const auto units = text ? parse_units(*text) : std::nullopt;
  if (units) return *units;
  section.mistake(*node, "'" + key +
                             "' must list units from 1 to 247, each once; write it as \"1-60\" or "
                             "\"1-3,9\"");
  return {};
}

// Whom the gateway asks: the units it is told, those it gives to new nodes, those it looks for.
void read_all_units(Section& section, BusSettings& bus) {
  bus.assign = read_units(section, "assign");
  bus.scan = read_units(section, "scan");
  section.read("scan_budget", bus.scan_budget, 1ms);
  if (section.find("assign") == nullptr && section.find("scan") == nullptr) {
    section.require("units", "units = \"1-60\"");
  }
  bus.units = read_units(section);
  const bool gives_default = std::any_of(bus.assign.begin(), bus.assign.end(), [](UnitRange range) {
    return range.last == default_unit;
  });
  if (gives_default) {
    section.mistake(*section.find("assign"),
                    "247 is where new nodes answer and cannot be given to one; take it out");
  }
}

// Units of the bus that need a timeout of their own.
void read_slow(Section& section, BusSettings& bus) {
  port::Duration timeout = bus.timeout;
  section.require("timeout", "timeout = \"500ms\"");
  section.require("units", "units = \"1-60\"");
  section.read("timeout", timeout, 1ms);
  for (const UnitRange range : read_units(section)) {
    bus.unit_timeouts.push_back({.units = range, .timeout = timeout});
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

void read_bus(Section& section, const PollSettings& poll, std::vector<BusSettings>& buses) {
  BusSettings bus;
  bus.timeout = poll.timeout;
  bus.quiet = 50ms;
  bus.outstanding_max = poll.outstanding_max;
  bus.scan_budget = 20ms;
  read_link(section, bus);
  section.read("name", bus.name, "name = \"yard\"");
  section.read("timeout", bus.timeout, 1ms);
  section.read<WordOrder>("word_order", bus.word_order,
                          {{"ABCD", WordOrder::abcd},
                           {"BADC", WordOrder::badc},
                           {"CDAB", WordOrder::cdab},
                           {"DCBA", WordOrder::dcba}});
  read_all_units(section, bus);
  section.each("slow", [&](Section& slow) { read_slow(slow, bus); });
  for (const BusSettings& other : buses) check_against(section, bus, other);
  buses.push_back(std::move(bus));
}

void read_gpio(Section& section, const std::vector<BusSettings>& buses, GpioSettings& gpio) {
  section.read("alert", gpio.alert);
  section.read("join_button", gpio.join_button);
  section.read("status_led", gpio.status_led);
  section.read("watchdog", gpio.watchdog);
  section.read("debounce", gpio.debounce, 0ms);
  const bool is_asked = std::any_of(buses.begin(), buses.end(),
                                    [](const BusSettings& bus) { return has_unit(bus, unit_max); });
  if ((gpio.alert || gpio.join_button) && !is_asked) {
    section.mistake(section.table(),
                    "alert and join_button make the gateway look for a new node at unit 247, which "
                    "is on no bus; add 247 to the units of one");
  }
}

// A decimal in 10^-9, exactly. In quotes: a number of TOML would be a binary fraction.
void read_nano(Section& section, const toml::node& node, const std::string& what,
               std::int64_t least, std::int64_t& value) {
  std::optional<files::Decimal> decimal;
  if (const auto text = node.value_exact<std::string>()) decimal = files::Decimal::parse(*text);
  if (const auto whole = node.value_exact<std::int64_t>()) decimal = files::Decimal::of(*whole);
  const auto nano =
      decimal ? (*decimal * files::Decimal::of(site_nano)).to_integer() : std::nullopt;
  if (nano && *nano >= least && *nano <= site_nano * 1'000'000'000) {
    value = *nano;
  } else {
    section.mistake(node, what);
  }
}

void read_site_table(Section& section, const std::filesystem::path& folder, SiteSettings& site) {
  site.place = section.place();
  section.require("file", "file = \"site.geojson\"");
  section.read("file", site.path, "file = \"site.geojson\"");
  if (!site.path.empty()) site.path = folder / site.path;
  section.read<PolyNodes>("nodes", site.poly_nodes,
                          {{"serials", PolyNodes::serials}, {"anchors", PolyNodes::anchors}});
  if (const toml::node* node = section.find("unit")) {
    read_nano(section, *node,
              "'unit' must be a positive decimal of at most nine digits behind the point, in "
              "quotes; write it as \"1\" or \"0.01\"",
              1, site.unit);
  }
  if (const toml::node* node = section.find("origin")) {
    const std::string what =
        "'origin' must be two decimals in quotes; write it as [\"569000\", \"7034000.5\"]";
    const toml::array* const both = node->as_array();
    if (both == nullptr || both->size() != 2) {
      section.mistake(*node, what);
    } else {
      const std::size_t before = section.mistake_count();
      read_nano(section, (*both)[0], what, -site_nano * 1'000'000'000, site.origin_x);
      if (section.mistake_count() == before) {
        read_nano(section, (*both)[1], what, -site_nano * 1'000'000'000, site.origin_y);
      }
    }
  }
  section.read("round", site.round);
}

void read_feature(Section& section, std::vector<FeatureSettings>& features) {
  FeatureSettings feature{.from = {}, .to = {}, .name = {}, .place = section.place()};
  section.require("from", "from = 1001");
  section.require("to", "to = 1002");
  section.read("from", feature.from.serial, 0, no_serial - 1);
  section.read("to", feature.to.serial, 0, no_serial - 1);
  if (section.find("from") && section.find("to") && feature.from == feature.to) {
    section.mistake(section.table(), "a feature from node " + to_string(feature.from) +
                                         " to itself; give two different serials");
  }
  features.push_back(std::move(feature));
}

void read_allow(Section& section, std::vector<port::Network>& allow) {
  const toml::node* const node = section.find("allow");
  if (node == nullptr) return;
  const toml::array* const list = node->as_array();
  std::vector<port::Network> networks;
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    const auto text = (*list)[i].value_exact<std::string>();
    const auto network = text ? port::parse_network(*text) : std::nullopt;
    if (!network) break;
    networks.push_back(*network);
  }
  if (list == nullptr || networks.size() != list->size()) {
    section.mistake(*node,
                    "'allow' must list networks; write it as [\"127.0.0.0/8\", \"10.0.0.0/8\"]");
  } else {
    allow = std::move(networks);
  }
}

void read_all(Section& file, const std::filesystem::path& folder, Settings& settings) {
  file.sub("site", [&](Section& section) { read_site_table(section, folder, settings.site); });
  file.require("mesh", "[mesh] with vertices_max");
  file.sub("mesh", [&](Section& section) { read_mesh(section, settings.mesh); });
  file.sub("poll", [&](Section& section) { read_poll(section, settings.poll); });
  file.require("bus", "[[bus]] with tcp or rtu, and units");
  file.each("bus", [&](Section& section) { read_bus(section, settings.poll, settings.buses); });
  file.sub("write_back",
           [&](Section& section) { section.read("enabled", settings.write_back.is_enabled); });
  file.sub("server", [&](Section& section) {
    section.read("listen", settings.server.listen);
    read_allow(section, settings.server.allow);
    section.read("clients_max", settings.server.clients_max, 1, 1000);
  });
  file.sub("http", [&](Section& section) {
    HttpSettings http;
    http.listen = {.host = 0x7f000001, .port = 8080};
    http.clients_max = 32;
    section.read("listen", http.listen);
    read_allow(section, http.allow);
    section.read("clients_max", http.clients_max, 1, 1000);
    const port::SocketAddress& server = settings.server.listen;
    if (http.listen.port != 0 && http.listen.port == server.port &&
        (http.listen.host == server.host || http.listen.host == 0 || server.host == 0)) {
      section.mistake(section.table(), "the page and [server] would both listen on port " +
                                           std::to_string(server.port) + "; give one another");
    }
    settings.http = http;
  });
  file.sub("files", [&](Section& section) {
    FileSettings files{.folder = {}, .name = "mesh", .interval = 1s};
    section.require("folder", "folder = \"/var/lib/etcm\"");
    section.read("folder", files.folder, "folder = \"/var/lib/etcm\"");
    files.folder = folder / files.folder;
    section.read("name", files.name, "name = \"mesh\"");
    section.read("interval", files.interval, 1ms);
    settings.files = std::move(files);
  });
  file.sub("state", [&](Section& section) {
    StateSettings state{.folder = {}, .interval = 1min};
    section.require("folder", "folder = \"/var/lib/etcm\"");
    section.read("folder", state.folder, "folder = \"/var/lib/etcm\"");
    state.folder = folder / state.folder;
    section.read("interval", state.interval, 1s);
    settings.state = std::move(state);
  });
  file.sub("gpio", [&](Section& section) { read_gpio(section, settings.buses, settings.gpio); });
  file.sub("analysis", [&](Section& section) {
    section.read("radio_range", settings.analysis.radio_range, 1, range_max);
    section.read("sensing_range", settings.analysis.sensing_range, 1, range_max);
  });
  file.each("feature", [&](Section& section) { read_feature(section, settings.features); });
}

}  // namespace

Settings read_settings(const std::string& path, std::vector<std::string>& mistakes) {
  Settings settings;
  settings.poll = {.interval = 1s,
                   .timeout = 200ms,
                   .absent_interval = 10s,
                   .stale_after = 5s,
                   .leave_after = 30s};
  settings.gpio.debounce = 20ms;
  settings.server.listen = {.host = 0x7f000001, .port = 1502};
  settings.server.clients_max = 16;

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

port::Duration timeout_of(const BusSettings& bus, std::uint8_t unit) {
  port::Duration timeout = bus.timeout;
  for (const UnitTimeout& other : bus.unit_timeouts) {
    if (other.units.first <= unit && unit <= other.units.last) timeout = other.timeout;
  }
  return timeout;
}

std::optional<port::Duration> parse_duration(const std::string& text) {
  std::int64_t count = 0;
  const char* end = text.data() + text.size();
  const auto [unit, error] = std::from_chars(text.data(), end, count);
  // In the largest unit this is far from overflow.
  if (error != std::errc{} || count < 0 || count > 86'400'000) return std::nullopt;
  const std::string_view name(unit, static_cast<std::size_t>(end - unit));
  if (name == "ms") return std::chrono::milliseconds(count);
  if (name == "s") return std::chrono::seconds(count);
  if (name == "min") return std::chrono::minutes(count);
  return std::nullopt;
}

std::optional<std::vector<UnitRange>> parse_units(const std::string& text) {
  std::vector<UnitRange> ranges;
  std::set<std::uint8_t> seen;
  const char* at = text.data();
  const char* end = at + text.size();
  while (true) {
    UnitRange range;
    auto parsed = std::from_chars(at, end, range.first);
    if (parsed.ec != std::errc{}) return std::nullopt;
    range.last = range.first;
    if (parsed.ptr != end && *parsed.ptr == '-') {
      parsed = std::from_chars(parsed.ptr + 1, end, range.last);
      if (parsed.ec != std::errc{}) return std::nullopt;
    }
    if (range.first < 1 || range.last > unit_max || range.first > range.last) return std::nullopt;
    for (unsigned unit = range.first; unit <= range.last; ++unit) {
      if (!seen.insert(static_cast<std::uint8_t>(unit)).second) return std::nullopt;
    }
    ranges.push_back(range);
    if (parsed.ptr == end) return ranges;
    if (*parsed.ptr != ',') return std::nullopt;
    at = parsed.ptr + 1;
  }
}

}  // namespace etcm::firmware
