// Every key of the configuration file, one row each. By this table the file is read, defaults are
// set, a reload knows what it may change, and `etcm-gateway --settings`, the guide and
// gateway.toml(5) are printed. Whatever is between keys (leave_after is longer than interval) is
// checked in settings.cpp, bus_reader.cpp and mqtt_checks.cpp.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "firmware/config/settings.h"
#include "firmware/config/settings_types.h"

namespace etcm::firmware {

// What holds where the file does not have the key.
struct Standard {
  enum class Kind : std::uint8_t {
    value,        // `toml`
    required,     // the file must have it; `toml` is an example
    conditional,  // the same, but not always; `words` tell when
    unset,        // nothing, or what `words` tell; `toml` is an example
  };
  Kind kind;
  const char* toml;  // a value as it is written
  const char* words;
};

// When another value takes effect.
enum class Effect : std::uint8_t {
  at_once,
  additions,  // units that are added are asked at once; any other change waits for a restart
  restart,
};
// "at once", "additions", "restart".
const char* to_string(Effect effect);

// Which [[bus]] has the key.
enum class BusKind : std::uint8_t { any, tcp, rtu };

struct Key {
  const char* name;
  ValueType type;
  Standard standard;
  Effect effect;
  const char* text;             // what it decides; Markdown, one sentence without its full stop
  const char* range = nullptr;  // where that of the type says too little
  BusKind bus = BusKind::any;
};

// A table of the file: "[poll]", or "[[bus]]", which may be there several times; without a name
// the file itself.
struct KeyTable {
  enum class Kind : std::uint8_t {
    always,    // its defaults hold without it
    optional,  // what it is about is not done without it
    list,
  };
  const char* name;
  Kind kind;
  const char* standard;  // what holds without it, for the guide
  const char* text;
  std::span<const Key> keys;
  const char* required = nullptr;  // what to add, for the file must have it
  // Of an optional one that is not in the settings until it is in the file.
  bool (*is_there)(const Settings&) = nullptr;
  void (*begin)(Settings&) = nullptr;
};

// All of them. A table stands behind those that it is checked against.
std::span<const KeyTable> key_tables();

// REQUIRES: there is one of this name.
const KeyTable& key_table(std::string_view name);
const Key& key_of(const KeyTable& table, std::string_view name);

BusKind kind_of(const BusSettings& bus);
// Whether a [[bus]] of this kind has the key.
constexpr bool is_key_of(const Key& key, BusKind kind) {
  return key.bus == BusKind::any || key.bus == kind;
}

// Whether it belongs to a table of another list, as [[bus.device]] does.
constexpr bool is_nested(const KeyTable& table) {
  return std::string_view(table.name).find('.') != std::string_view::npos;
}

// "[poll]", "[[bus]]".
std::string heading_of(const KeyTable& table);

// "[poll] interval", as the log names it.
std::string path_of(const KeyTable& table, const Key& key);

}  // namespace etcm::firmware
