#include "firmware/profile/profile_reader.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "etcm/files/error.h"
#include "etcm/files/record_reader.h"
#include "firmware/profile/field_reader.h"
#include "firmware/profile/toml_values.h"

namespace etcm::firmware {

namespace {

// What a protocol data unit has room for.
constexpr std::uint16_t block_max_most = 125;
// 0 is the address on the wire; the others are how manuals count. Of six digits the first is the
// table, as it is of five.
constexpr std::int64_t counts[] = {0, 1, 30001, 40001, 300001, 400001};
// Files beyond this are no profiles.
constexpr std::size_t bytes_max = 1 << 20;

// Nothing after a mistake.
std::optional<std::int64_t> read_counts_from(TomlTable& table) {
  const toml::node* const node = table.find("counts_from");
  if (node == nullptr) return 0;
  const auto given = node->value_exact<std::int64_t>();
  if (given && std::find(std::begin(counts), std::end(counts), *given) != std::end(counts)) {
    return *given;
  }
  table.mistake(*node,
                "'counts_from' is what the manual calls the first register; give 0, 1, 30001, "
                "40001, 300001 or 400001");
  return std::nullopt;
}

void read_serial(TomlTable& table, const FieldReader& fields, Profile& profile) {
  const toml::node* const node = table.find("serial");
  if (node == nullptr) return;
  read_inner(table, "serial", *node, [&](TomlTable& inner) {
    const toml::node* const unit = inner.find("unit");
    if (unit == nullptr) {
      profile.serial = fields.read_field(inner);
    } else if (unit->value_exact<bool>() != true) {
      inner.mistake(*unit,
                    "'unit' can only be true; or give the register of the serial, as in "
                    "serial = { register = 2, type = \"u32\" }");
    }
  });
}

struct Axes {
  Profile::Positioning positioning;
  const char* east;
  const char* north;
};
constexpr Axes plane{Profile::Positioning::plane, "x", "y"};
constexpr Axes earth{Profile::Positioning::degrees, "longitude", "latitude"};

// A letter there tells the hemisphere, and only two of them are of this axis.
void take_axis(TomlTable& table, const char* key, Axis axis, std::uint32_t counts_from,
               Field& field) {
  field.axis = axis;
  if (!field.negative_if) return;
  const std::string letter_register =
      std::to_string(counts_from + field.negative_if->number.span.first);
  for (const char letter : hemispheres_of(*field.negative_if)) {
    if (belongs_to(letter, axis)) continue;
    table.mistake(*table.find(key), std::string("'") + key + "' is negative by the letter " +
                                        letter + ", and has " +
                                        (axis == Axis::longitude ? "E and W" : "N and S") +
                                        "; write negative_if = { register = " + letter_register +
                                        ", equals = \"" + (axis == Axis::longitude ? "W" : "S") +
                                        "\" }, with the register of its letter");
  }
}

void read_axes(TomlTable& table, const FieldReader& fields, const Axes& axes, Profile& profile) {
  const auto east = fields.read_field_of(table, axes.east);
  const auto north = fields.read_field_of(table, axes.north);
  const toml::node* const east_node = table.find(axes.east);
  const toml::node* const north_node = table.find(axes.north);
  if (east_node == nullptr && north_node == nullptr) return;
  if (east_node == nullptr || north_node == nullptr) {
    const char* const given = east_node != nullptr ? axes.east : axes.north;
    const char* const missing = east_node != nullptr ? axes.north : axes.east;
    table.mistake(*table.find(given), std::string("'") + given + "' without '" + missing +
                                          "'; a position needs both: add it");
  }
  if (profile.positioning != Profile::Positioning::surveyed) {
    table.mistake(east_node != nullptr ? *east_node : *north_node,
                  "a position in degrees beside one in the plane ('x', 'y'); take one out");
  }
  profile.positioning = axes.positioning;
  if (east) profile.east = *east;
  if (north) profile.north = *north;
  if (axes.positioning != Profile::Positioning::degrees) return;
  if (east) take_axis(table, axes.east, Axis::longitude, profile.counts_from, profile.east);
  if (north) take_axis(table, axes.north, Axis::latitude, profile.counts_from, profile.north);
}

void read_position(TomlTable& table, const FieldReader& fields, Profile& profile) {
  read_axes(table, fields, plane, profile);
  read_axes(table, fields, earth, profile);
  profile.valid = fields.read_conditions_of(table, "valid");
  profile.speed_max_nano = read_positive(table, "speed_max").value_or(0);
  if (table.find("speed_max") != nullptr && profile.positioning == Profile::Positioning::surveyed) {
    table.mistake(*table.find("speed_max"),
                  "'speed_max' is about the position, and there is none; take it out");
  }
  if (table.find("valid") != nullptr && profile.positioning == Profile::Positioning::surveyed) {
    table.mistake(*table.find("valid"),
                  "'valid' is about the position, and there is none; take it out, or give it to a "
                  "[[profile.reading]]");
  }
}

// A text of so many bytes at the most.
std::string read_short_text(TomlTable& table, const char* key, std::size_t most) {
  std::string text = read_text(table, key);
  if (text.size() > most) {
    table.mistake(*table.find(key),
                  std::string("'") + key + "' has " + std::to_string(text.size()) +
                      " bytes; make it shorter, it can have " + std::to_string(most));
  }
  return text;
}

void read_reading(TomlTable& table, const FieldReader& fields, Profile& profile) {
  Profile::Reading reading;
  table.require("name", "name = \"pressure\"");
  table.require("value", "value = { register = 0, type = \"i16\", scale = \"0.1\" }");
  reading.name = read_short_text(table, "name", reading_name_max);
  reading.unit = read_short_text(table, "unit", reading_unit_max);
  if (const auto value = fields.read_field_of(table, "value")) reading.value = *value;
  reading.valid = fields.read_conditions_of(table, "valid");
  for (const Profile::Reading& other : profile.readings) {
    if (other.name != reading.name || reading.name.empty()) continue;
    table.mistake(*table.find("name"),
                  "two readings are named '" + reading.name + "'; give one another name");
    break;
  }
  profile.readings.push_back(std::move(reading));
}

void read_transfer(TomlTable& table, Profile& profile) {
  const toml::node* const given = table.find("function");
  if (given != nullptr && given->is_array()) {
    table.mistake(*given,
                  "'function' is a list, and a profile reads one table; give 3 or 4, whichever has "
                  "what you need most");
  } else if (const auto function = read_whole(table, "function", 3, 4)) {
    profile.function = static_cast<std::uint8_t>(*function);
  }
  if (const auto pause = table.duration("pause")) profile.pause = *pause;
  if (const auto most = read_whole(table, "block_max", 1, block_max_most)) {
    profile.block_max = static_cast<std::uint16_t>(*most);
  }
  if (const auto gap = read_whole(table, "gap_max", 0, block_max_most)) {
    profile.gap_max = static_cast<std::uint16_t>(*gap);
  }
}

// The first digit of a manual's number says which table it is of.
void check_table_read(TomlTable& table, const Profile& profile) {
  const std::uint32_t first = profile.counts_from;
  if (first < 30001) return;
  const bool is_input = first == 30001 || first == 300001;
  const int function = is_input ? 4 : 3;
  if (profile.function == function) return;
  table.mistake(*table.find("counts_from"),
                std::string("'counts_from' is of ") + (is_input ? "input" : "holding") +
                    " registers, which function " + std::to_string(function) +
                    " reads, and 'function' is " + std::to_string(profile.function) +
                    "; write function = " + std::to_string(function) +
                    ", or number the registers from 1, with counts_from = 1");
}

// Whether no key of it, sound or not, names a register.
bool names_no_register(TomlTable& table) {
  for (const char* const key : {"x", "y", "longitude", "latitude", "reading"}) {
    if (table.find(key) != nullptr) return false;
  }
  const toml::node* const serial = table.find("serial");
  return serial == nullptr || (serial->is_table() && serial->as_table()->contains("unit"));
}

void check_blocks(TomlTable& table, const Profile& profile) {
  if (names_no_register(table)) {
    table.mistake(table.table(),
                  "nothing is read, so that nobody could tell whether the device is there; give it "
                  "a [[profile.reading]] or a position");
  }
  std::uint16_t longest = 0;
  for (const RegisterSpan span : spans_of(profile)) longest = std::max(longest, span.count);
  if (longest > profile.block_max) {
    table.mistake(*table.find("block_max"),
                  "'block_max' has no room for a number of " + std::to_string(longest) +
                      " registers, which must come in one block; give at least " +
                      std::to_string(longest));
  }
}

}  // namespace

Profile read_profile(TomlTable& table) {
  Profile profile;
  table.require("name", "name = \"my-device\"");
  profile.name = read_text(table, "name");
  const std::optional<std::int64_t> counts_from = read_counts_from(table);
  profile.counts_from = static_cast<std::uint32_t>(counts_from.value_or(0));
  const FieldReader fields(counts_from);
  read_transfer(table, profile);
  check_table_read(table, profile);
  read_serial(table, fields, profile);
  read_position(table, fields, profile);
  table.each("reading", [&](TomlTable& inner) { read_reading(inner, fields, profile); });
  fields.tell_registers(table);
  check_blocks(table, profile);
  return profile;
}

namespace {

bool has(const std::vector<Profile>& profiles, const std::string& name) {
  return std::any_of(profiles.begin(), profiles.end(),
                     [&](const Profile& profile) { return profile.name == name; });
}

// None after a mistake.
std::optional<toml::table> parse(const std::string& path, std::vector<std::string>& mistakes) {
  try {
    return toml::parse(files::read_text(path, bytes_max), path);
  } catch (const files::InputError& error) {
    mistakes.push_back(error.what());
  } catch (const toml::parse_error& error) {
    mistakes.push_back(path + ":" + std::to_string(error.source().begin.line) + ": " +
                       std::string(error.description()) +
                       "; correct the TOML there (texts stand in quotes)");
    keep_to_lines(mistakes);
  }
  return std::nullopt;
}

void take_profiles(TomlTable& file, std::vector<Profile>& profiles) {
  file.each("profile", [&](TomlTable& table) {
    Profile profile = read_profile(table);
    if (!profile.name.empty() && has(profiles, profile.name)) {
      table.mistake(*table.find("name"),
                    "two profiles are named '" + profile.name + "'; give one another name");
    }
    profiles.push_back(std::move(profile));
  });
}

void read_file(const std::string& path, std::vector<Profile>& profiles,
               std::vector<std::string>& mistakes) {
  const std::optional<toml::table> parsed = parse(path, mistakes);
  if (!parsed) return;
  TomlTable file(path, *parsed, "", mistakes);
  take_profiles(file, profiles);
  file.finish();
  keep_to_lines(mistakes);
}

// A gateway has a mesh and buses; a file of profiles has neither.
bool is_configuration(const toml::table& parsed) {
  return parsed.contains("mesh") || parsed.contains("bus");
}

}  // namespace

std::string installed_profiles() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return "";
  return (program.parent_path() / ETCM_INSTALLED_PROFILES).lexically_normal();
}

std::vector<Profile> read_profiles(const std::string& path, std::vector<std::string>& mistakes) {
  std::vector<Profile> profiles;
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) {
    read_file(path, profiles, mistakes);
    return profiles;
  }
  std::vector<std::string> paths;
  std::filesystem::directory_iterator entry(path, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (entry->path().extension() == ".toml") paths.push_back(entry->path());
  }
  if (error) mistakes.push_back(path + ": " + error.message() + "; give a folder that can be read");
  std::sort(paths.begin(), paths.end());
  for (const std::string& each : paths) read_file(each, profiles, mistakes);
  return profiles;
}

std::vector<Profile> read_profiles_or_gateways(const std::string& path,
                                               const std::string& installed,
                                               std::vector<std::string>& mistakes) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return read_profiles(path, mistakes);
  const std::optional<toml::table> parsed = parse(path, mistakes);
  if (!parsed) return {};
  if (!is_configuration(*parsed)) return read_profiles(path, mistakes);
  std::vector<Profile> profiles;
  // Its other keys are the gateway's business, which checks them.
  TomlTable file(path, *parsed, "", mistakes);
  take_profiles(file, profiles);
  keep_to_lines(mistakes);
  const auto named = (*parsed)["profiles"].value<std::string>();
  const auto others = std::filesystem::path(path).parent_path() / named.value_or(installed);
  if (!named && !std::filesystem::exists(others, error)) return profiles;
  for (Profile& profile : read_profiles(others, mistakes)) {
    if (!has(profiles, profile.name)) profiles.push_back(std::move(profile));
  }
  return profiles;
}

}  // namespace etcm::firmware
