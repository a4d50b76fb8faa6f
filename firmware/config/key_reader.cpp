#include "firmware/config/key_reader.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace etcm::firmware {

namespace {

// As the person would write it.
std::string example_of(const Key& key) { return std::string(key.name) + " = " + key.standard.toml; }

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

}  // namespace

void require(TomlTable& toml_table, const KeyTable& table, const char* name) {
  toml_table.require(name, example_of(key_of(table, name)));
}

void read_keys(const KeyTable& table, TomlTable& toml_table, const std::filesystem::path& folder,
               Target target, BusKind bus) {
  for (const Key& key : table.keys) {
    if (key.standard.kind == Standard::Kind::required) require(toml_table, table, key.name);
  }
  read_values(table, toml_table, folder, target, bus);
}

void set_defaults(const KeyTable& table, Target target, BusKind bus) {
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

}  // namespace etcm::firmware
