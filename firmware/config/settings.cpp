#include "firmware/config/settings.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "etcm/files/error.h"
#include "etcm/files/record_reader.h"
#include "firmware/config/cross_checks.h"
#include "firmware/config/names.h"
#include "firmware/config/settings_keys.h"
#include "firmware/config/settings_types.h"
#include "firmware/config/unit_count.h"
#include "firmware/profile/profile_reader.h"
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

// Whether one of two keys that go together is there; one alone is a mistake.
bool has_both(TomlTable& toml_table, const char* one, const char* other) {
  const toml::node* const first = toml_table.find(one);
  const toml::node* const second = toml_table.find(other);
  if ((first == nullptr) != (second == nullptr)) {
    toml_table.mistake(first != nullptr ? *first : *second,
                       std::string("'") + one + "' and '" + other + "' go together; add '" +
                           (first == nullptr ? one : other) + "', or take the other out");
  }
  return first != nullptr || second != nullptr;
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
  const bool is_asked = std::any_of(settings.buses.begin(), settings.buses.end(),
                                    [](const BusSettings& bus) { return asks(bus, default_unit); });
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
  if (is_one_place(page, server)) {
    toml_table.mistake(toml_table.table(), "the page and [server] would both listen on port " +
                                               std::to_string(server.port) + "; give one another");
  }
  const toml::node* const allow = toml_table.find("allow");
  std::string place = allow != nullptr ? toml_table.place(*allow) : toml_table.place();
  settings.http->allow_place = place.replace(place.rfind(':'), 1, ", line ");
}

void check_files(TomlTable& toml_table, Settings& settings) {
  if (settings.files->name.find('/') == std::string::npos) return;
  toml_table.mistake(*toml_table.find("name"),
                     "'name' is that of files in 'folder'; take each / out of it, and give the "
                     "path in 'folder'");
}

// A Unix socket's path has a place of its own, and an end.
void check_control(TomlTable& toml_table, Settings& settings) {
  constexpr std::size_t bytes_max = 107;
  const std::size_t bytes = settings.control.socket.size();
  if (bytes <= bytes_max) return;
  toml_table.mistake(*toml_table.find("socket"), "'socket' is a path of " + std::to_string(bytes) +
                                                     " bytes, and no more than " +
                                                     std::to_string(bytes_max) +
                                                     " are possible; give a shorter one");
}

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

// ---- The broker of a fleet.

void check_tls(TomlTable& toml_table, const MqttSettings& mqtt) {
  has_both(toml_table, "tls_certificate", "tls_key");
  has_both(toml_table, "psk_identity", "psk_file");
  if (!mqtt.tls_ca.empty() && !mqtt.psk_file.empty()) {
    toml_table.mistake(*toml_table.find("psk_file"),
                       "TLS both by certificates and by a key that both know; take tls_ca or "
                       "psk_file out");
  }
  if (mqtt.tls_ca.empty() && !mqtt.tls_certificate.empty()) {
    toml_table.mistake(*toml_table.find("tls_certificate"),
                       "a certificate is for TLS, which needs tls_ca too; add it");
  }
}

// Of a part of a topic, which may have levels of its own where `has_levels`.
void check_topic(TomlTable& toml_table, const char* key, const std::string& topic,
                 bool has_levels) {
  constexpr std::size_t topic_most = 64;
  const toml::node* const node = toml_table.find(key);
  if (node == nullptr || topic.empty()) return;
  const bool has_empty_level = ("/" + topic + "/").find("//") != std::string::npos;
  const bool has_marks = topic.find_first_of(has_levels ? "+#" : "+#/") != std::string::npos;
  const bool has_control = std::any_of(topic.begin(), topic.end(), [](char byte) {
    return static_cast<unsigned char>(byte) < ' ' || byte == 0x7f;
  });
  if (!has_empty_level && !has_marks && !has_control && topic.size() <= topic_most) return;
  toml_table.mistake(*node, std::string("'") + key + "' is no part of a topic; give it 1 to " +
                                std::to_string(topic_most) + " bytes without " +
                                (has_levels ? "'+' and '#', and no '/' at an end or beside another"
                                            : "'/', '+' and '#'"));
}

// What a gateway may write, etcm/v1/SITE/NAME/#, has the topic above it in it: that of the site.
void check_names(TomlTable& toml_table, const MqttSettings& mqtt) {
  struct Name {
    const char* key;
    const std::string& value;
  };
  for (const Name& name : {Name{"name", mqtt.name}, Name{"user", mqtt.user},
                           Name{"psk_identity", mqtt.psk_identity}}) {
    if (name.value != "site") continue;
    toml_table.mistake(*toml_table.find(name.key),
                       std::string("'") + name.key +
                           "' may not be \"site\", for a broker could let it write the site of "
                           "all; give it another name, such as \"north\"");
    return;
  }
}

void check_mqtt(TomlTable& toml_table, Settings& settings) {
  constexpr std::uint16_t plain_port = 1883;
  constexpr std::uint16_t tls_port = 8883;
  MqttSettings& mqtt = *settings.mqtt;
  check_names(toml_table, mqtt);
  check_tls(toml_table, mqtt);
  mqtt.is_alone = mqtt.share == FleetShare::publish && toml_table.find("share") != nullptr;
  check_topic(toml_table, "sparkplug", mqtt.sparkplug, false);
  check_topic(toml_table, "home_assistant", mqtt.home_assistant, true);
  const bool has_tls = !mqtt.tls_ca.empty() || !mqtt.psk_file.empty();
  if (mqtt.broker.port == 0) mqtt.broker.port = has_tls ? tls_port : plain_port;
  if (mqtt.user.empty() && !mqtt.password_file.empty()) mqtt.user = mqtt.name;
  if (mqtt.period_min > mqtt.period_max) {
    const toml::node* culprit = toml_table.find("period_max");
    if (culprit == nullptr) culprit = toml_table.find("period_min");
    toml_table.mistake(culprit != nullptr ? *culprit : toml_table.table(),
                       "period_min is longer than period_max; make it shorter");
  }
}

// ---- Lists of tables.

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

void read_feature(TomlTable& toml_table, Settings& settings) {
  FeatureSettings feature{.from = {}, .to = {}, .name = {}, .source = toml_table.place()};
  read_keys(key_table("feature"), toml_table, {}, &feature);
  if (toml_table.find("from") && toml_table.find("to") && feature.from == feature.to) {
    toml_table.mistake(toml_table.table(), "a feature from node " + to_string(feature.from) +
                                               " to itself; give two different serials");
  }
  settings.features.push_back(std::move(feature));
}

void read_node(TomlTable& toml_table, Settings& settings) {
  NodeSettings node{.bus = {}, .source = toml_table.place()};
  read_keys(key_table("node"), toml_table, {}, &node);
  const bool in_plane = has_both(toml_table, "x", "y");
  const bool in_degrees = has_both(toml_table, "longitude", "latitude");
  if (toml_table.find("bus") != nullptr && toml_table.find("unit") == nullptr) {
    return require(toml_table, key_table("node"), "unit");
  }
  // Half a place is a mistake already.
  const toml::node* const longitude = toml_table.find("longitude");
  if (in_plane && longitude != nullptr && toml_table.find("latitude") != nullptr) {
    toml_table.mistake(*longitude,
                       "a place both in the plane and in degrees; take one of the two out");
  }
  const bool has_place = in_plane || in_degrees;
  if (toml_table.find("unit") == nullptr) {
    const bool is_named_by_serial = node.serial && !node.name.empty() && !has_place;
    if (!is_named_by_serial) return require(toml_table, key_table("node"), "unit");
  } else if (node.address == 0) {
    return;  // a mistake already
  }
  NodeName name{.bus = node.bus,
                .address = node.address,
                .name = std::exchange(node.name, {}),
                .source = node.source};
  if (node.address == 0) name.serial = Serial{*node.serial};
  NodeMistake wrong;
  // One that only has a name may be a node of our own.
  if (node.address != 0 && (name.name.empty() || node.serial || has_place)) {
    wrong = add_node(settings, std::move(node));
  }
  if (wrong.what.empty() && !name.name.empty()) wrong = add_name(settings, std::move(name));
  if (wrong.what.empty()) return;
  const toml::node* const culprit = toml_table.find(wrong.key);
  toml_table.mistake(culprit != nullptr ? *culprit : toml_table.table(), wrong.what);
}

// ---- The whole file.

// Far more than settings of all nodes there may be.
constexpr std::size_t file_bytes_max = 16 << 20;

// Those of a file, or of a folder, whose names are not known yet.
void add_profiles(const std::string& path, Settings& settings, std::vector<std::string>& mistakes) {
  for (Profile& profile : read_profiles(path, mistakes)) {
    if (find_profile(settings, profile.name) != nullptr) continue;
    settings.device_profiles.push_back(std::move(profile));
  }
}

// Those of the file itself come first: they take the place of others of their name.
void read_all_profiles(TomlTable& file, const std::filesystem::path& folder, Settings& settings,
                       std::vector<std::string>& mistakes) {
  const KeyTable& table = key_table("");
  read_keys(table, file, folder, &settings);
  file.each("profile", [&](TomlTable& toml_table) {
    Profile profile = read_profile(toml_table);
    const toml::node* const name = toml_table.find("name");
    if (name != nullptr && profile.name == node_profile) {
      toml_table.mistake(*name, "'etcm' is the profile of nodes of our own; take another name");
    } else if (name != nullptr && find_profile(settings, profile.name) != nullptr) {
      toml_table.mistake(
          *name, "another [[profile]] is named '" + profile.name + "' too; give one another name");
    }
    settings.device_profiles.push_back(std::move(profile));
  });
  const std::size_t before = mistakes.size();
  std::error_code ignored;
  for (const std::string& path : settings.profiles) {
    if (std::filesystem::exists(path, ignored)) {
      add_profiles(path, settings, mistakes);
    } else {
      file.mistake(*file.find("profiles"),
                   "there is no " + path +
                       "; give a file with profiles, or a folder. Those of the package need no "
                       "'profiles'");
    }
  }
  if (std::filesystem::exists(ETCM_PROFILES, ignored)) {
    add_profiles(ETCM_PROFILES, settings, mistakes);
  }
  settings.has_all_profiles = mistakes.size() == before;
}

void note_site(TomlTable& toml_table, Settings& settings) {
  settings.site.source = toml_table.place();
}

// What is done with a table: each of a list is read into something new, any other is read into the
// settings and then checked.
struct TableWork {
  std::string_view table;
  void (*work)(TomlTable&, Settings&);
};
constexpr TableWork list_readers[] = {
    {"bus", read_bus}, {"node", read_node}, {"feature", read_feature}};
constexpr TableWork table_checks[] = {
    {"site", note_site},        {"poll", check_poll}, {"gpio", check_gpio}, {"files", check_files},
    {"control", check_control}, {"http", check_http}, {"mqtt", check_mqtt}};

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
    for (const TableWork& check : table_checks) {
      if (check.table == table.name) check.work(toml_table, settings);
    }
  });
}

void read_all(TomlTable& file, const std::filesystem::path& folder, Settings& settings,
              std::vector<std::string>& mistakes) {
  read_all_profiles(file, folder, settings, mistakes);
  for (const KeyTable& table : key_tables()) {
    if (*table.name == '\0') continue;
    if (table.kind != KeyTable::Kind::list) {
      read_table(file, table, folder, settings);
    } else if (!is_nested(table)) {
      read_list(file, table, settings);
    }
  }
  for (const KeyTable& table : key_tables()) {
    if (table.required != nullptr) file.require(table.name, table.required);
  }
}

}  // namespace

Settings read_settings(const std::string& path, std::vector<std::string>& mistakes) {
  Settings settings;
  toml::table parsed;
  try {
    parsed = toml::parse(files::read_text(path, file_bytes_max), path);
  } catch (const files::InputError& error) {
    mistakes.push_back(error.what());
    return settings;
  } catch (const toml::parse_error& error) {
    const std::string_view what = error.description();
    const bool is_open = what.find("string: unescaped control characters") != what.npos;
    mistakes.push_back(
        path + ":" + std::to_string(error.source().begin.line) + ": " +
        (is_open ? "a text has no end in its line; put a quote (\") behind it"
                 : std::string(what) + "; correct the TOML there (texts stand in quotes)"));
    keep_to_lines(mistakes);
    return settings;
  }
  const std::size_t before = mistakes.size();
  TomlTable file(path, parsed, "", mistakes);
  read_all(file, std::filesystem::path(path).parent_path(), settings, mistakes);
  file.finish();
  settings.room = unit_room_of(settings);
  if (mistakes.size() == before) check_across(parsed, path, settings, mistakes);
  // Keys come in alphabetical order; a person reads from the top of the file.
  const auto line = [&](const std::string& mistake) {
    return mistake.starts_with(path + ":")
               ? std::strtoul(mistake.c_str() + path.size() + 1, nullptr, 10)
               : 0;  // of another file, which is read first
  };
  std::stable_sort(mistakes.begin() + static_cast<std::ptrdiff_t>(before), mistakes.end(),
                   [&](const std::string& a, const std::string& b) { return line(a) < line(b); });
  keep_to_lines(mistakes, before);
  return settings;
}

}  // namespace etcm::firmware
