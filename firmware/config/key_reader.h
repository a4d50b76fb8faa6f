// Reads a table of the configuration file by its table of keys (settings_keys.h).
#pragma once

#include <filesystem>

#include "firmware/config/settings_keys.h"
#include "firmware/config/settings_types.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

// A mistake where the key is not there, with the example of its row as the cure.
void require(TomlTable& toml_table, const KeyTable& table, const char* name);

// Into `target`, what the file has; what must be there and is not is a mistake. `folder` is that of
// the file, from which its paths go; `bus` is the kind of a target that is a bus.
void read_keys(const KeyTable& table, TomlTable& toml_table, const std::filesystem::path& folder,
               Target target, BusKind bus = BusKind::any);

// Defaults are read as if the file had them. Throws std::logic_error where the table has a wrong
// one.
void set_defaults(const KeyTable& table, Target target, BusKind bus = BusKind::any);

// Whether one of two keys that go together is there; one alone is a mistake.
bool has_both(TomlTable& toml_table, const char* one, const char* other);

}  // namespace etcm::firmware
