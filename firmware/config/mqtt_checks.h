// What is between the keys of [mqtt].
#pragma once

#include "firmware/config/settings.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

// Also gives the values that follow from others: the broker's port, the user's name.
void check_mqtt(TomlTable& toml_table, Settings& settings);

}  // namespace etcm::firmware
