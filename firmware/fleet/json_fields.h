// What a program that nobody answers for says of itself: the fields of a JSON object, each checked.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "etcm/files/json.h"

namespace etcm::firmware {

// Bounds on one message.
inline constexpr std::size_t fleet_depth_max = 8;
inline constexpr std::size_t fleet_values_max = 100'000;

// The value of a text, whatever is in it; none, and what is wrong, where that is no JSON, nests too
// deep or has a key twice. O(size).
std::optional<files::JsonValue> parse_message(std::string_view text, std::string& wrong);

// Takes fields of one object. What is wrong first is kept, as in "x is no number"; fields that are
// not asked for may be anything.
class JsonFields {
 public:
  // Must outlive it. `where` is what its fields are told under, such as "readings/3/", or empty.
  explicit JsonFields(const files::JsonValue& object, std::string where = {});

  bool has(std::string_view key) const;
  // 0, empty or false where something is wrong.
  std::uint32_t number(std::string_view key, std::uint32_t most);
  std::int32_t signed_number(std::string_view key, std::int32_t magnitude_most);
  std::string text(std::string_view key, std::size_t bytes_max);
  // A number as it stands there.
  std::string digits(std::string_view key, std::size_t bytes_max);
  bool boolean(std::string_view key);
  std::uint64_t hash(std::string_view key);
  // In 10^-9, to the nearest.
  std::int64_t nano(std::string_view key);
  // Of an array of no more than that; null where something is wrong.
  const files::JsonValue* list(std::string_view key, std::size_t count_max);
  const files::JsonValue* object(std::string_view key);

  void reject(std::string_view key, std::string_view why);
  const std::string& wrong() const { return wrong_; }
  bool is_sound() const { return wrong_.empty(); }

 private:
  const files::JsonValue* find(std::string_view key, files::JsonValue::Kind kind,
                               std::string_view why);

  const files::JsonValue& object_;
  std::string where_;
  std::string wrong_;
};

// A whole number of that magnitude; none where it is something else.
std::optional<std::int64_t> whole_number(const files::JsonValue& value, std::int64_t least,
                                         std::int64_t most);

}  // namespace etcm::firmware
