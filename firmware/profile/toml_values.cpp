#include "firmware/profile/toml_values.h"

#include <algorithm>

#include "firmware/profile/number.h"

namespace etcm::firmware {

std::string quoted_key(std::string_view key) { return "'" + std::string(key) + "'"; }

std::optional<Fraction> fraction_of(const toml::node& node) {
  if (const auto whole = node.value_exact<std::int64_t>()) {
    return *whole == INT64_MIN ? std::nullopt : std::optional(Fraction::of(*whole));
  }
  if (const auto text = node.value_exact<std::string>()) return Fraction::parse(*text);
  return std::nullopt;
}

std::optional<std::int64_t> nano_of(const toml::node& node) {
  const auto fraction = fraction_of(node);
  return fraction ? scaled(nano_per_one, *fraction) : std::nullopt;
}

bool tell_of_no_number(TomlTable& table, const char* key, const toml::node& node,
                       const std::string& example) {
  if (node.is_string()) {
    const std::string text = node.value_exact<std::string>().value_or("");
    const bool is_number =
        !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
    table.mistake(node, quoted_key(key) + " is a text; write the number without quotes: " + key +
                            " = " + (is_number ? text : example));
    return true;
  }
  if (!node.is_array()) return false;
  table.mistake(node, quoted_key(key) + " is a list; give one number: " + key + " = " + example);
  return true;
}

std::optional<std::int64_t> read_whole(TomlTable& table, const char* key, std::int64_t least,
                                       std::int64_t most) {
  const toml::node* const node = table.find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value_exact<std::int64_t>();
  if (value && *value >= least && *value <= most) return value;
  if (tell_of_no_number(table, key, *node, std::to_string(least))) return std::nullopt;
  table.mistake(*node, quoted_key(key) + " is out of range; give a whole number from " +
                           std::to_string(least) + " to " + std::to_string(most));
  return std::nullopt;
}

std::optional<std::int64_t> read_positive(TomlTable& table, const char* key) {
  const toml::node* const node = table.find(key);
  if (node == nullptr) return std::nullopt;
  const auto nano = nano_of(*node);
  if (nano && *nano > 0) return nano;
  table.mistake(*node, std::string("'") + key +
                           "' must be a decimal above 0, in quotes; write it as " + key +
                           " = \"30\"");
  return std::nullopt;
}

std::string read_text(TomlTable& table, const char* key) {
  const toml::node* const node = table.find(key);
  if (node == nullptr) return "";
  std::string text = node->value_exact<std::string>().value_or("");
  const bool is_readable = std::none_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < ' ' || c == '\x7f';
  });
  if (!text.empty() && is_readable) return text;
  table.mistake(*node, quoted_key(key) + " must be a text in one line; write it in quotes");
  return "";
}

void read_inner(TomlTable& table, const std::string& key, const toml::node& node,
                const std::function<void(TomlTable&)>& read) {
  if (!node.is_table()) {
    return table.mistake(
        node, quoted_key(key) + " must be a table; write it as " + key + " = { register = 200 }");
  }
  TomlTable inner = table.inner(key, *node.as_table());
  read(inner);
  inner.finish();
}

}  // namespace etcm::firmware
