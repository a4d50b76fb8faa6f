// Reads a [[bus]] with its [[bus.device]], and checks what is between their keys.
#pragma once

#include "firmware/config/settings.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

// Adds it to the buses. REQUIRES: [poll] and the profiles are read, for a bus takes from
// them what it does not say.
void read_bus(TomlTable& toml_table, Settings& settings);

}  // namespace etcm::firmware
