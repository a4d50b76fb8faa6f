// JSON as it stands in a file: numbers keep their digits, and every value knows its line.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/files/error.h"

namespace etcm::files {

// Bounds on what a hostile or mistaken file can cost.
inline constexpr std::size_t json_bytes_max = std::size_t{16} << 20;
struct JsonBounds {
  std::size_t values = 1'000'000;
  std::size_t keys = 1000;  // of one object
  std::size_t depth = 64;
};

struct JsonValue {
  enum class Kind : unsigned char { null, boolean, number, text, array, object };

  Kind kind = Kind::null;
  bool is_true = false;
  std::size_t line_number = 0;
  std::string text;               // of a text; of a number as it stands in the file
  std::vector<JsonValue> items;   // elements of an array; values of an object
  std::vector<std::string> keys;  // of an object, as many as items

  // The value of a key of an object; null without one, and for what is no object.
  const JsonValue* find(std::string_view key) const;
};

// "an object", "a number": what a person calls it.
const char* to_string(JsonValue::Kind kind);

// Reads the file. Throws InputError with the line for what is no JSON, for a key that stands twice,
// and for what exceeds the bounds above.
JsonValue read_json(const std::string& path);

// The same of a text, which the message calls `name`. O(size).
JsonValue parse_json(std::string_view text, const std::string& name, const JsonBounds& bounds = {});

}  // namespace etcm::files
