// The keys of a number in registers (number.h), as profiles write them.
#pragma once

#include <cstdint>

#include "firmware/profile/number.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

// Its type, and of how many registers it is.
void read_type(TomlTable& table, Number& number);

// How they are to be understood: order, mask, scale, offset, none. REQUIRES: the type is read.
void read_meaning(TomlTable& table, Number& number);

// The bits that the mask leaves; all where there is none.
std::uint64_t bits_of(const Number& number);

}  // namespace etcm::firmware
