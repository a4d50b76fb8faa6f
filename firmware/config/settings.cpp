#include "firmware/config/settings.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "etcm/files/error.h"
#include "etcm/files/record_reader.h"
#include "firmware/config/bus_reader.h"
#include "firmware/config/cross_checks.h"
#include "firmware/config/key_reader.h"
#include "firmware/config/mqtt_checks.h"
#include "firmware/config/names.h"
#include "firmware/config/settings_keys.h"
#include "firmware/config/unit_count.h"
#include "firmware/profile/profile_reader.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

namespace {

// ---- What is between keys.

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

// ---- Lists of tables.

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
  const std::string installed = installed_profiles();
  if (std::filesystem::exists(installed, ignored)) add_profiles(installed, settings, mistakes);
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
