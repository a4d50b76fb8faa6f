// Values as profiles write them. A mistake is told as TomlTable tells it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "firmware/profile/fraction.h"
#include "firmware/toml/toml_table.h"

namespace etcm::firmware {

// A key, in the quotes of a sentence.
std::string quoted_key(std::string_view key);

inline constexpr const char* how_to_write_number =
    "write it as 10, \"0.001\" or \"1/60000\" (a number with a point stands in quotes, so that it "
    "is exact)";

// A number in words of TOML, exactly; nothing where it is none.
std::optional<Fraction> fraction_of(const toml::node& node);
// The same in 10^-9.
std::optional<std::int64_t> nano_of(const toml::node& node);

// Tells where a text or a list stands for a number. False: neither does.
bool tell_of_no_number(TomlTable& table, const char* key, const toml::node& node,
                       const std::string& example);

// Calls `read` for the table that `node` is, the value of the key.
void read_inner(TomlTable& table, const std::string& key, const toml::node& node,
                const std::function<void(TomlTable&)>& read);

// A whole number of the key; nothing where there is none, and after a mistake.
std::optional<std::int64_t> read_whole(TomlTable& table, const char* key, std::int64_t least,
                                       std::int64_t most);

// A decimal above 0 in 10^-9; nothing where there is none, or after a mistake.
std::optional<std::int64_t> read_positive(TomlTable& table, const char* key);

// A text that a person can read; empty after a mistake, and where there is none.
std::string read_text(TomlTable& table, const char* key);

template <class Value>
struct Word {
  std::string_view word;
  Value value;
};

// What the word of the key stands for; null where there is none, and after a mistake.
template <class Value>
const Value* read_word(TomlTable& table, const char* key, std::span<const Word<Value>> words) {
  const toml::node* const node = table.find(key);
  if (node == nullptr) return nullptr;
  const auto text = node->value_exact<std::string>();
  std::string list;
  for (const Word<Value>& word : words) {
    if (text && *text == word.word) return &word.value;
    list += (list.empty() ? "\"" : ", \"") + std::string(word.word) + "\"";
  }
  table.mistake(*node, quoted_key(key) + " is unknown; write one of " + list);
  return nullptr;
}

}  // namespace etcm::firmware
