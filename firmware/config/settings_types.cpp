#include "firmware/config/settings_types.h"

#include <charconv>
#include <limits>
#include <set>

#include "etcm/files/decimal.h"
#include "firmware/config/names.h"
#include "firmware/fleet/fleet_record.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

constexpr std::int64_t nano_max = site_nano * 1'000'000'000;

// "500ms", with its quotes.
std::string text_of(port::Duration duration) {
  const bool is_whole = duration % 1s == port::Duration{};
  return is_whole ? "\"" + std::to_string(duration / 1s) + "s\""
                  : "\"" + std::to_string(duration / 1ms) + "ms\"";
}

// "1-60" or "7" or "1-3,9"; a range also as "1:60", as etcm-bus and mbpoll have it.
std::optional<std::vector<UnitRange>> parse_units(const std::string& text) {
  std::vector<UnitRange> ranges;
  std::set<ModbusAddress> seen;
  const char* at = text.data();
  const char* end = at + text.size();
  while (true) {
    UnitRange range;
    auto parsed = std::from_chars(at, end, range.first);
    if (parsed.ec != std::errc{}) return std::nullopt;
    range.last = range.first;
    if (parsed.ptr != end && (*parsed.ptr == '-' || *parsed.ptr == ':')) {
      parsed = std::from_chars(parsed.ptr + 1, end, range.last);
      if (parsed.ec != std::errc{}) return std::nullopt;
    }
    if (range.first < 1 || range.last > unit_max || range.first > range.last) return std::nullopt;
    for (const ModbusAddress unit : range) {
      if (!seen.insert(unit).second) return std::nullopt;
    }
    ranges.push_back(range);
    if (parsed.ptr == end) return ranges;
    if (*parsed.ptr != ',') return std::nullopt;
    at = parsed.ptr + 1;
  }
}

// A decimal in 10^-9, exactly. In quotes: a number of TOML would be a binary fraction.
std::optional<std::int64_t> parse_nano(const toml::node& node, std::int64_t least) {
  std::optional<files::Decimal> decimal;
  if (const auto text = node.value_exact<std::string>()) decimal = files::Decimal::parse(*text);
  if (const auto whole = node.value_exact<std::int64_t>()) decimal = files::Decimal::of(*whole);
  const auto nano =
      decimal ? (*decimal * files::Decimal::of(site_nano)).to_integer() : std::nullopt;
  if (!nano || *nano < least || *nano > nano_max) return std::nullopt;
  return nano;
}

// ---- One reading for each type: the value, or none after a mistake is told with its cure.

std::nullopt_t wrong(const GivenKey& key, const toml::node& node, const std::string& what) {
  key.toml_table.mistake(node, what);
  return std::nullopt;
}

std::string quoted(const GivenKey& key) { return "'" + key.name + "'"; }

bool is_digits(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_number_in_quotes(const toml::node& node) {
  return is_digits(node.value_exact<std::string_view>().value_or(""));
}

std::string without_quotes(const GivenKey& key, const toml::node& node) {
  return quoted(key) + " is a number in quotes; write it as " + key.name + " = " +
         node.value_exact<std::string>().value_or("");
}

std::optional<port::Duration> read(const DurationType& type, const GivenKey& key,
                                   const toml::node& node) {
  const auto found = key.toml_table.duration(key.name);
  if (found && *found < type.least) {
    return wrong(key, node, quoted(key) + " is too short; give at least " + text_of(type.least));
  }
  return found;
}

std::optional<std::optional<port::Duration>> read(const OptionalDurationType& type,
                                                  const GivenKey& key, const toml::node& node) {
  const auto found = key.toml_table.duration(key.name);
  if (!found) return std::nullopt;
  if (*found > type.most) {
    return wrong(key, node, quoted(key) + " is too long; give at most " + text_of(type.most));
  }
  return found;
}

std::optional<std::uint32_t> read(const CountType& type, const GivenKey& key,
                                  const toml::node& node) {
  const auto found = node.value_exact<std::int64_t>();
  if (found && *found >= type.least && *found <= type.most) {
    return static_cast<std::uint32_t>(*found);
  }
  if (is_number_in_quotes(node)) return wrong(key, node, without_quotes(key, node));
  return wrong(key, node,
               quoted(key) + " is out of range; give a whole number from " +
                   std::to_string(type.least) + " to " + std::to_string(type.most));
}

std::optional<std::size_t> read(const ChoiceType& type, const GivenKey& key,
                                const toml::node& node) {
  const auto text = node.value_exact<std::string>();
  std::string list;
  for (std::size_t i = 0; i < type.words.size(); ++i) {
    if (text && *text == type.words[i]) return i;
    list += (list.empty() ? "\"" : ", \"") + std::string(type.words[i]) + "\"";
  }
  return wrong(key, node,
               (text ? key.name + " '" + *text + "' is unknown" : quoted(key) + " must be a text") +
                   "; write one of " + list);
}

std::optional<std::uint32_t> read(const BaudType&, const GivenKey& key, const toml::node& node) {
  const auto found = node.value_exact<std::int64_t>();
  if (found && *found > 0 && *found <= std::numeric_limits<std::uint32_t>::max() &&
      port::is_baud(static_cast<std::uint32_t>(*found))) {
    return static_cast<std::uint32_t>(*found);
  }
  if (is_number_in_quotes(node)) return wrong(key, node, without_quotes(key, node));
  return wrong(key, node,
               quoted(key) +
                   " is no speed; give 9600, 19200, 115200, or another whole number from " +
                   std::to_string(port::baud_least) + " to " + std::to_string(port::baud_most));
}

std::optional<bool> read(const FlagType&, const GivenKey& key, const toml::node& node) {
  const auto found = node.value_exact<bool>();
  if (found) return *found;
  return wrong(key, node,
               quoted(key) + " must be true or false; write it as " + key.name + " = true");
}

std::optional<std::string> read(const TextType&, const GivenKey& key, const toml::node& node) {
  const auto found = node.value_exact<std::string>();
  if (found && !found->empty()) return *found;
  return wrong(key, node,
               quoted(key) + " must be a text; write it as " + key.name + " = " + key.example);
}

std::optional<std::string> read(const CalledType&, const GivenKey& key, const toml::node& node) {
  const auto found = node.value_exact<std::string>();
  if (found && is_name(*found)) return *found;
  return wrong(key, node,
               quoted(key) + " must be a text of 1 to " + std::to_string(name_bytes_max) +
                   " bytes in one line, without control characters; write it as " + key.name +
                   " = " + key.example);
}

std::optional<std::string> read(const PathType&, const GivenKey& key, const toml::node& node) {
  const auto found = read(TextType{}, key, node);
  if (!found) return std::nullopt;
  return (key.folder / *found).string();
}

std::optional<std::vector<std::string>> read(const PathsType&, const GivenKey& key,
                                             const toml::node& node) {
  const toml::array* const list = node.as_array();
  const std::size_t count = list != nullptr ? list->size() : 1;
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < count; ++i) {
    const auto text = (list != nullptr ? (*list)[i] : node).value_exact<std::string>();
    if (!text || text->empty()) break;
    paths.push_back((key.folder / *text).string());
  }
  if (paths.size() == count) return paths;
  return wrong(key, node,
               quoted(key) + " must be a path or a list of paths; write it as " + key.name + " = " +
                   key.example);
}

std::optional<port::SocketAddress> read(const AddressType&, const GivenKey& key,
                                        const toml::node& node) {
  const auto text = node.value_exact<std::string>();
  const auto found = text ? port::parse_socket_address(*text) : std::nullopt;
  if (found) return found;
  // The name that every machine has for itself.
  const auto end = text ? port::parse_endpoint(*text) : std::nullopt;
  if (end && end->host == "localhost") {
    return port::parse_socket_address("127.0.0.1:" + std::to_string(end->port));
  }
  // With the port that was meant, or else that of the example, which stands in quotes.
  const auto port_in = [](const std::string& place) {
    const std::size_t last = place.find_last_of("0123456789");
    const std::size_t before = place.find_last_not_of("0123456789", last);
    return last == place.npos ? "" : place.substr(before + 1, last - before);
  };
  std::string port = text ? port_in(*text) : "";
  if (port.empty() || port.size() > 5) port = port_in(key.example);
  const auto at = [&port](const char* host) { return "\"" + (host + (':' + port)) + "\""; };
  // One that leads here today may lead elsewhere at the next start.
  const bool is_named = end && port::has_name(*end);
  return wrong(
      key, node,
      quoted(key) +
          (is_named ? " has the name '" + end->host +
                          "'; it takes addresses of this machine, and of names localhost alone"
                    : std::string(" is no address of this machine")) +
          "; write it as " + at("127.0.0.1") + ", " + at("localhost") + ", " + at("[::1]") +
          ", or " + at("[::]") + " for all of its addresses");
}

std::optional<std::optional<port::SocketAddress>> read(const OptionalAddressType&,
                                                       const GivenKey& key,
                                                       const toml::node& node) {
  const auto found = read(AddressType{}, key, node);
  if (!found) return std::nullopt;
  return found;
}

std::optional<port::Endpoint> read(const EndpointType& type, const GivenKey& key,
                                   const toml::node& node) {
  const auto text = node.value_exact<std::string>();
  auto found = text ? port::parse_endpoint(*text) : std::nullopt;
  if (type.has_standard_port) {
    // Port 0 is none, so that it can stand for a port that is not given.
    if (found && found->port == 0)
      found.reset();
    else if (!found && text)
      found = port::parse_endpoint(*text, std::uint16_t{0});
    if (found) return found;
    return wrong(key, node,
                 quoted(key) +
                     " is neither an address nor a name; write it as \"192.0.2.5\", "
                     "\"mqtt.example:8883\", or an IPv6 address in brackets, "
                     "\"[2001:db8::1]:1883\"");
  }
  if (found) return found;
  return wrong(key, node,
               quoted(key) +
                   " is neither an address nor a name with a port; write it as \"127.0.0.1:502\", "
                   "\"plc.example:502\", or an IPv6 address in brackets, \"[2001:db8::1]:502\"");
}

std::optional<std::string> read(const NameType&, const GivenKey& key, const toml::node& node) {
  const auto found = node.value_exact<std::string>();
  if (found && is_fleet_name(*found)) return *found;
  return wrong(key, node,
               quoted(key) + " must be a name of 1 to " + std::to_string(fleet_name_max) +
                   " letters, digits, '-', '_' and '.'; write it as " + key.name + " = " +
                   key.example);
}

std::optional<std::vector<port::Network>> read(const NetworksType&, const GivenKey& key,
                                               const toml::node& node) {
  constexpr const char* cure = "; write it as [\"127.0.0.0/8\", \"::1/128\", \"192.168.1.20\"]";
  const toml::array* const list = node.as_array();
  if (list == nullptr) return wrong(key, node, quoted(key) + " must list networks" + cure);
  std::vector<port::Network> networks;
  for (const toml::node& entry : *list) {
    const auto text = entry.value_exact<std::string>();
    const auto network = text ? port::parse_network(*text) : std::nullopt;
    if (!network) {
      return wrong(key, entry,
                   quoted(key) +
                       (text ? " has \"" + *text + "\", which is no network"
                             : std::string(" has what is no text, and so no network")) +
                       cure);
    }
    networks.push_back(*network);
  }
  return networks;
}

// Empty where the text is no name of a host.
std::string host_name_of(const std::string& text) {
  const auto end = port::parse_endpoint(text, std::uint16_t{0});
  if (!end || !port::has_name(*end) || text.find(':') != std::string::npos) return {};
  return end->host.substr(0, end->host.size() - (end->host.ends_with('.') ? 1 : 0));
}

std::optional<std::vector<std::string>> read(const HostNamesType&, const GivenKey& key,
                                             const toml::node& node) {
  const toml::array* const list = node.as_array();
  std::vector<std::string> names;
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    const auto text = (*list)[i].value_exact<std::string>();
    std::string name = text ? host_name_of(*text) : std::string();
    if (name.empty()) break;
    names.push_back(std::move(name));
  }
  if (list != nullptr && names.size() == list->size()) return names;
  return wrong(key, node,
               quoted(key) + " must list names of hosts, without a port; write it as " + key.name +
                   " = " + key.example);
}

std::optional<std::vector<UnitRange>> read(const UnitsType&, const GivenKey& key,
                                           const toml::node& node) {
  const auto text = node.value_exact<std::string>();
  auto found = text ? parse_units(*text) : std::nullopt;
  if (found) return found;
  return wrong(
      key, node,
      quoted(key) + " must list units from 1 to 247, each once; write it as \"1-60\" or \"1-3,9\"");
}

std::optional<std::optional<LineSettings>> read(const BoardLineType&, const GivenKey& key,
                                                const toml::node& node) {
  const auto text = read(TextType{}, key, node);
  if (!text) return std::nullopt;
  const bool is_active_low = text->starts_with('!');
  return LineSettings{.name = text->substr(is_active_low ? 1 : 0), .is_active_low = is_active_low};
}

std::optional<std::optional<std::uint32_t>> read(const OptionalCountType& type, const GivenKey& key,
                                                 const toml::node& node) {
  const auto found = read(CountType{{}, type.least, type.most, {}}, key, node);
  if (!found) return std::nullopt;
  return std::optional(*found);
}

std::optional<std::optional<std::int64_t>> read(const DecimalType& type, const GivenKey& key,
                                                const toml::node& node) {
  const auto found = parse_nano(node, -type.most);
  if (found && *found <= type.most) return std::optional(*found);
  return wrong(key, node,
               quoted(key) + " must be a decimal from -" + std::to_string(type.most / site_nano) +
                   " to " + std::to_string(type.most / site_nano) +
                   ", with at most nine digits behind the point, in quotes; write it as " +
                   key.example);
}

std::optional<std::int64_t> read(const ScaleType&, const GivenKey& key, const toml::node& node) {
  const auto found = parse_nano(node, 1);
  if (found) return found;
  return wrong(key, node,
               quoted(key) +
                   " must be a positive decimal of at most nine digits behind the point, in "
                   "quotes; write it as \"1\" or \"0.01\"");
}

std::optional<SiteOrigin> read(const OriginType&, const GivenKey& key, const toml::node& node) {
  const toml::array* const both = node.as_array();
  if (both != nullptr && both->size() == 2) {
    const auto x = parse_nano((*both)[0], -nano_max);
    const auto y = parse_nano((*both)[1], -nano_max);
    if (x && y) return SiteOrigin{.x = *x, .y = *y};
  }
  return wrong(
      key, node,
      quoted(key) + " must be two decimals in quotes; write it as [\"569000\", \"7034000.5\"]");
}

// ---- One range for each type, as Markdown.

std::string range(const DurationType& type) {
  return type.least > 1ms ? "duration, at least `" + text_of(type.least) + "`" : "duration";
}
std::string range(const OptionalDurationType& type) {
  return "duration, at most `" + text_of(type.most) + "`";
}
std::string range(const CountType& type) {
  return (type.measure.empty() ? "" : std::string(type.measure) + ", ") +
         std::to_string(type.least) + " ... " + std::to_string(type.most);
}
std::string range(const ChoiceType& type) {
  std::string list;
  for (const std::string_view word : type.words) {
    list += (list.empty() ? "`" : ", `") + ("\"" + std::string(word)) + "\"`";
  }
  return list;
}
std::string range(const BaudType&) {
  return std::to_string(port::baud_least) + " ... " + std::to_string(port::baud_most);
}
std::string range(const FlagType&) { return "`true`, `false`"; }
std::string range(const TextType&) { return "text"; }
std::string range(const CalledType&) {
  return "text of one line, 1 ... " + std::to_string(name_bytes_max) + " bytes";
}
std::string range(const PathType&) { return "path"; }
std::string range(const PathsType&) { return "path, or list of paths"; }
std::string range(const AddressType&) { return "`\"ADDRESS:PORT\"`"; }
std::string range(const OptionalAddressType&) { return range(AddressType{}); }
std::string range(const EndpointType& type) {
  return type.has_standard_port ? "`\"HOST\"`, `\"HOST:PORT\"`" : "`\"HOST:PORT\"`";
}
std::string range(const NameType&) {
  return "1 ... " + std::to_string(fleet_name_max) + " letters, digits, `-`, `_`, `.`";
}
std::string range(const NetworksType&) { return "list of networks"; }
std::string range(const HostNamesType&) { return "list of names"; }
std::string range(const UnitsType&) { return "`\"1-60\"`, `\"1-3,9\"`"; }
std::string range(const BoardLineType&) { return "line"; }
std::string range(const OptionalCountType& type) {
  return std::to_string(type.least) + " ... " + std::to_string(type.most);
}
std::string range(const DecimalType&) { return "decimal in quotes"; }
std::string range(const ScaleType&) { return "decimal in quotes"; }
std::string range(const OriginType&) { return "two decimals in quotes"; }

}  // namespace

void read_value(const ValueType& type, const GivenKey& key, Target target) {
  const toml::node* const node = key.toml_table.find(key.name);
  if (node == nullptr) return;
  std::visit(
      [&](const auto& known) {
        if (auto value = read(known, key, *node)) known.field.set(target, *std::move(value));
      },
      type);
}

void copy_value(const ValueType& type, Target from, Target to) {
  std::visit([&](const auto& known) { known.field.set(to, known.field.get(from)); }, type);
}

bool is_same_value(const ValueType& type, Target a, Target b) {
  return std::visit([&](const auto& known) { return known.field.get(a) == known.field.get(b); },
                    type);
}

std::string range_of(const ValueType& type) {
  return std::visit([](const auto& known) { return range(known); }, type);
}

}  // namespace etcm::firmware
