// Fields and tests as profiles write them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/profile/field.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

// Mistakes are told as TomlTable tells them; what comes out is good for use only where there are
// none.
class FieldReader {
 public:
  // What a profile calls register 0; nothing where it says so wrongly: then no register is judged.
  explicit FieldReader(std::optional<std::int64_t> counts_from) : counts_from_(counts_from) {}

  // Tells of registers that are out of range: of all at once where none is within, which is one
  // mistake of the whole profile.
  void tell_registers(TomlTable& profile) const;

  Field read_field(TomlTable& table) const;
  // That of a key, whose value is a table; nothing where there is none.
  std::optional<Field> read_field_of(TomlTable& table, const std::string& key) const;
  // A table, or a list of these.
  std::vector<Condition> read_conditions_of(TomlTable& table, const std::string& key) const;

 private:
  RegisterSpan read_registers(TomlTable& table, std::uint16_t count) const;
  Number read_number(TomlTable& table) const;
  Condition read_condition(TomlTable& table) const;
  void read_parts(TomlTable& table, Field& field) const;

  struct OutOfRange {
    const toml::node* node;
    std::int64_t given;
    std::uint16_t count;
  };

  std::optional<std::int64_t> counts_from_;
  mutable std::uint32_t registers_ = 0;  // that were read
  mutable std::vector<OutOfRange> out_of_range_{};
};

}  // namespace etcm::firmware
