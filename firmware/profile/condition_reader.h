// What a test compares its number with, as profiles write it.
#pragma once

#include "firmware/profile/field.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

// `equals`, `not_equals`, or `at_least` and `at_most`. REQUIRES: the condition has its number.
void read_comparison(TomlTable& table, Condition& condition);

}  // namespace etcm::firmware
