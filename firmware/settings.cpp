#include "settings.h"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

#include "etcm/policy.h"
#include "mesh_map.h"
#include "node_map.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t unit_max = 247;
constexpr port::Duration duration_max = 24h;

std::string place_of(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line);
}

// One table of the file: hands out its values, and knows at the end which keys nobody asked for.
class Section {
 public:
  Section(const std::string& file, const toml::table& table, std::string name,
          std::vector<std::string>& mistakes)
      : file_(file), table_(table), name_(std::move(name)), mistakes_(mistakes) {}

  const toml::node* find(const std::string& key) {
    known_.insert(key);
    return table_.get(key);
  }

  void mistake(const toml::node& node, const std::string& what) {
    mistakes_.push_back(place_of(file_, node) + ": " + what);
  }

  void require(const std::string& key, const std::string& example) {
    if (find(key) == nullptr) {
      mistake(table_, in_section("'" + key + "' is missing") + "; add it, such as " + example);
    }
  }

  void read(const std::string& key, std::string& value, const std::string& example) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    if (const auto found = node->value_exact<std::string>(); found && !found->empty()) {
      value = *found;
    } else {
      mistake(*node, "'" + key + "' must be a text; write it as " + example);
    }
  }

  void read(const std::string& key, port::SocketAddress& value) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto text = node->value_exact<std::string>();
    const auto found = text ? port::parse_socket_address(*text) : std::nullopt;
    if (found) {
      value = *found;
    } else {
      mistake(*node, "'" + key + "' is no address; write it as \"127.0.0.1:502\"");
    }
  }

  void read(const std::string& key, port::Duration& value, port::Duration least) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto text = node->value_exact<std::string>();
    const auto found = text ? parse_duration(*text) : std::nullopt;
    if (!found) {
      mistake(*node, "'" + key + "' is no duration; write it as \"500ms\", \"2s\" or \"5min\"");
    } else if (*found > duration_max) {
      mistake(*node, "'" + key + "' is longer than a day; give less");
    } else if (*found < least) {
      mistake(*node, "'" + key + "' is too short; give at least \"" + std::to_string(least / 1ms) +
                         "ms\"");
    } else {
      value = *found;
    }
  }

  void read(const std::string& key, std::uint32_t& value, std::uint32_t least, std::uint32_t most) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto found = node->value_exact<std::int64_t>();
    if (found && *found >= least && *found <= most) {
      value = static_cast<std::uint32_t>(*found);
    } else {
      mistake(*node, "'" + key + "' is out of range; give a whole number from " +
                         std::to_string(least) + " to " + std::to_string(most));
    }
  }

  // A line of the board; "!" before it: active when low.
  void read(const std::string& key, std::optional<LineSettings>& value) {
    if (find(key) == nullptr) return;
    LineSettings line;
    read(key, line.place, key + " = \"LINE_NAME\"");
    line.is_active_low = line.place.starts_with('!');
    if (line.is_active_low) line.place.erase(0, 1);
    value = line;
  }

  // One of a few words.
  template <class Value>
  void read(const std::string& key, Value& value,
            std::initializer_list<std::pair<std::string_view, Value>> words) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto text = node->value_exact<std::string>();
    std::string list;
    for (const auto& [word, meaning] : words) {
      if (text && *text == word) {
        value = meaning;
        return;
      }
      list += (list.empty() ? "\"" : ", \"") + std::string(word) + "\"";
    }
    mistake(*node, (text ? key + " '" + *text + "' is unknown" : "'" + key + "' must be a text") +
                       "; write one of " + list);
  }

  // Calls `each` for each table of an array of tables.
  void each(const std::string& key, const std::function<void(Section&)>& each_table) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const toml::array* tables = node->as_array();
    if (tables == nullptr || !tables->is_array_of_tables()) {
      mistake(*node, "'" + key + "' must be a list of tables; begin each with [[" + key + "]]");
      return;
    }
    for (const toml::node& element : *tables) {
      Section section(file_, *element.as_table(), "[[" + key + "]]", mistakes_);
      each_table(section);
      section.finish();
    }
  }

  void sub(const std::string& key, const std::function<void(Section&)>& table) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    if (!node->is_table()) {
      mistake(*node, "'" + key + "' must be a table; begin it with [" + key + "]");
      return;
    }
    Section section(file_, *node->as_table(), "[" + key + "]", mistakes_);
    table(section);
    section.finish();
  }

  // Reports keys that mean nothing: most are misspelt.
  void finish() {
    for (const auto& [key, node] : table_) {
      if (known_.contains(std::string(key.str()))) continue;
      std::string list;
      for (const std::string& name : known_) list += (list.empty() ? "" : ", ") + name;
      mistakes_.push_back(file_ + ":" + std::to_string(key.source().begin.line) + ": " +
                          in_section("'" + std::string(key.str()) + "' is unknown") +
                          "; known here: " + list);
    }
  }

  std::string place() const { return place_of(file_, table_); }
  const toml::table& table() const { return table_; }

 private:
  std::string in_section(const std::string& what) const {
    return name_.empty() ? what : what + " in " + name_;
  }

  const std::string& file_;
  const toml::table& table_;
  std::string name_;
  std::vector<std::string>& mistakes_;
  std::set<std::string> known_;
};

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

void read_bus(Section& section, const PollSettings& poll, std::vector<BusSettings>& buses) {
  BusSettings bus;
  bus.timeout = poll.timeout;
  bus.quiet = 50ms;
  bus.outstanding_max = poll.outstanding_max;
  read_link(section, bus);
  section.read("name", bus.name, "name = \"yard\"");
  section.read("timeout", bus.timeout, 1ms);
  section.read<WordOrder>("word_order", bus.word_order,
                          {{"ABCD", WordOrder::abcd},
                           {"BADC", WordOrder::badc},
                           {"CDAB", WordOrder::cdab},
                           {"DCBA", WordOrder::dcba}});
  section.require("units", "units = \"1-60\"");
  if (const toml::node* node = section.find("units")) {
    const auto text = node->value_exact<std::string>();
    const auto units = text ? parse_units(*text) : std::nullopt;
    if (units) {
      bus.units = *units;
    } else {
      section.mistake(*node,
                      "'units' must list units from 1 to 247, each once; write it as "
                      "\"1-60\" or \"1-3,9\"");
    }
  }
  for (const BusSettings& other : buses) {
    if (other.name == bus.name) {
      section.mistake(section.table(), "two buses are named '" + bus.name + "'; rename one");
    }
  }
  buses.push_back(std::move(bus));
}

void read_gpio(Section& section, const std::vector<BusSettings>& buses, GpioSettings& gpio) {
  section.read("alert", gpio.alert);
  section.read("join_button", gpio.join_button);
  section.read("status_led", gpio.status_led);
  section.read("watchdog", gpio.watchdog);
  section.read("debounce", gpio.debounce, 0ms);
  const bool is_asked = std::any_of(buses.begin(), buses.end(), [](const BusSettings& bus) {
    return std::any_of(bus.units.begin(), bus.units.end(),
                       [](UnitRange range) { return range.last == unit_max; });
  });
  if ((gpio.alert || gpio.join_button) && !is_asked) {
    section.mistake(section.table(),
                    "alert and join_button make the gateway look for a new node at unit 247, which "
                    "is on no bus; add 247 to the units of one");
  }
}

void read_feature(Section& section, std::vector<FeatureSettings>& features) {
  FeatureSettings feature{.place = section.place()};
  section.require("from", "from = 1001");
  section.require("to", "to = 1002");
  section.read("from", feature.from, 0, no_serial - 1);
  section.read("to", feature.to, 0, no_serial - 1);
  if (section.find("from") && section.find("to") && feature.from == feature.to) {
    section.mistake(section.table(), "a feature from node " + std::to_string(feature.from) +
                                         " to itself; give two different serials");
  }
  features.push_back(std::move(feature));
}

void read_all(Section& file, const std::filesystem::path& folder, Settings& settings) {
  file.read("site", settings.site, "site = \"site.poly\"");
  if (!settings.site.empty()) settings.site = folder / settings.site;
  file.require("mesh", "[mesh] with vertices_max");
  file.sub("mesh", [&](Section& section) { read_mesh(section, settings.mesh); });
  file.sub("poll", [&](Section& section) { read_poll(section, settings.poll); });
  file.require("bus", "[[bus]] with tcp or rtu, and units");
  file.each("bus", [&](Section& section) { read_bus(section, settings.poll, settings.buses); });
  file.sub("server", [&](Section& section) {
    section.read("listen", settings.server.listen);
    section.read("clients_max", settings.server.clients_max, 1, 1000);
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
  file.sub("gpio", [&](Section& section) { read_gpio(section, settings.buses, settings.gpio); });
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
  settings.server = {.listen = {.host = 0x7f000001, .port = 1502}, .clients_max = 16};

  toml::table parsed;
  try {
    parsed = toml::parse_file(path);
  } catch (const toml::parse_error& error) {
    mistakes.push_back(path + ":" + std::to_string(error.source().begin.line) + ": " +
                       std::string(error.description()) + "; correct the TOML there");
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
