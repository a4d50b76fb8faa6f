// JSON of any origin, and the decimals in it.
#include <string>

#include "etcm/files/decimal.h"
#include "etcm/files/json.h"
#include "fuzz_target.h"

namespace etcm::fuzz {
namespace {

void check_decimal(std::string_view text) {
  const auto number = files::Decimal::parse(text);
  if (!number) return;
  const auto again = files::Decimal::parse(number->to_string());
  require(!again || *again == *number, "a decimal reads back as another one");
  static_cast<void>(number->to_double());
  const files::Decimal rounded = number->rounded();
  require(rounded.is_integer(), "what is rounded is no integer");
  if (const auto whole = number->to_integer()) {
    require(files::Decimal::of(*whole) == *number, "an integer is another one");
  }
  const files::Decimal square = *number * *number;
  require(square.is_zero() == number->is_zero() && !square.is_negative(), "a square below 0");
}

void check(const files::JsonValue& value, std::size_t depth) {
  require(depth <= 64, "it nests too deep");
  if (value.kind == files::JsonValue::Kind::number) check_decimal(value.text);
  if (value.kind == files::JsonValue::Kind::object) {
    require(value.keys.size() == value.items.size(), "keys and values are not as many");
    for (std::size_t i = 0; i < value.keys.size(); ++i) {
      require(value.find(value.keys[i]) == &value.items[i], "a key finds another value");
    }
  }
  for (const files::JsonValue& item : value.items) check(item, depth + 1);
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  const std::string text(text_of(bytes));
  check_decimal(text);
  try {
    check(files::parse_json(text, "text", {.values = 5000, .keys = 100, .depth = 20}), 0);
  } catch (const files::InputError& error) {
    const std::string_view what = error.what();
    require(what.starts_with("text:") && what.find('\n') == what.npos, "a mistake is not one line");
  }
}

}  // namespace etcm::fuzz
