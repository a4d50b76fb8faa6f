#include "firmware/fleet/json_fields.h"

#include <charconv>
#include <limits>

#include "etcm/files/decimal.h"
#include "etcm/files/error.h"

namespace etcm::firmware {

using files::JsonValue;
using FieldKind = JsonValue::Kind;

namespace {

// The longest number that is looked at: it has all digits that any field may have.
constexpr std::size_t number_bytes_max = 40;

std::optional<files::Decimal> decimal_of(const JsonValue& value) {
  if (value.kind != FieldKind::number || value.text.size() > number_bytes_max) return std::nullopt;
  return files::Decimal::parse(value.text);
}

}  // namespace

std::optional<JsonValue> parse_message(std::string_view text, std::string& wrong) {
  constexpr files::JsonBounds bounds{.values = fleet_values_max, .depth = fleet_depth_max};
  try {
    return files::parse_json(text, "", bounds);
  } catch (const files::InputError& error) {
    // Without the line, what was read there, which may be anything, and the cure for files.
    const std::string_view what = error.what();
    const std::size_t from = what.find(": ") + 2;
    wrong = std::string(what.substr(from, what.find(';') - from));
    return std::nullopt;
  }
}

std::optional<std::int64_t> whole_number(const JsonValue& value, std::int64_t least,
                                         std::int64_t most) {
  std::optional<std::int64_t> number;
  std::int64_t plain = 0;
  const char* const end = value.text.data() + value.text.size();
  const auto [stop, error] = std::from_chars(value.text.data(), end, plain);
  if (value.kind == FieldKind::number && error == std::errc{} && stop == end) {
    number = plain;
  } else if (const auto decimal = decimal_of(value)) {
    number = decimal->to_integer();
  }
  if (!number || *number < least || *number > most) return std::nullopt;
  return number;
}

JsonFields::JsonFields(const JsonValue& object, std::string where)
    : object_(object), where_(std::move(where)) {
  if (object.kind != FieldKind::object) wrong_ = where_ + "is no object";
}

void JsonFields::reject(std::string_view key, std::string_view why) {
  if (!wrong_.empty()) return;
  wrong_ = where_;
  wrong_ += key;
  if (!why.empty()) wrong_ += ' ';
  wrong_ += why;
}

const JsonValue* JsonFields::find(std::string_view key, FieldKind kind, std::string_view why) {
  const JsonValue* const value = object_.find(key);
  if (value == nullptr) {
    reject(key, "is missing");
  } else if (value->kind != kind) {
    reject(key, why);
  } else {
    return value;
  }
  return nullptr;
}

bool JsonFields::has(std::string_view key) const { return object_.find(key) != nullptr; }

std::uint32_t JsonFields::number(std::string_view key, std::uint32_t most) {
  const JsonValue* const value = find(key, FieldKind::number, "is no number");
  if (value == nullptr) return 0;
  const auto number = whole_number(*value, 0, most);
  if (!number) reject(key, "is out of range");
  return static_cast<std::uint32_t>(number.value_or(0));
}

std::int32_t JsonFields::signed_number(std::string_view key, std::int32_t magnitude_most) {
  const JsonValue* const value = find(key, FieldKind::number, "is no number");
  if (value == nullptr) return 0;
  const auto number = whole_number(*value, -magnitude_most, magnitude_most);
  if (!number) reject(key, "is out of range");
  return static_cast<std::int32_t>(number.value_or(0));
}

std::string JsonFields::text(std::string_view key, std::size_t bytes_max) {
  const JsonValue* const value = find(key, FieldKind::text, "is no text");
  if (value == nullptr) return {};
  if (value->text.size() <= bytes_max) return value->text;
  reject(key, "is too long");
  return {};
}

std::string JsonFields::digits(std::string_view key, std::size_t bytes_max) {
  const JsonValue* const value = find(key, FieldKind::number, "is no number");
  if (value == nullptr) return {};
  if (value->text.size() <= bytes_max) return value->text;
  reject(key, "is too long");
  return {};
}

bool JsonFields::boolean(std::string_view key) {
  const JsonValue* const value = find(key, FieldKind::boolean, "is neither true nor false");
  return value != nullptr && value->is_true;
}

std::uint64_t JsonFields::hash(std::string_view key) {
  const JsonValue* const value = find(key, FieldKind::text, "is no text");
  if (value == nullptr) return 0;
  std::uint64_t hash = 0;
  const char* const end = value->text.data() + value->text.size();
  const auto [stop, error] = std::from_chars(value->text.data(), end, hash, 16);
  if (error == std::errc{} && stop == end && value->text.size() == 16) return hash;
  reject(key, "is no hash of 16 digits");
  return 0;
}

std::int64_t JsonFields::nano(std::string_view key) {
  const JsonValue* const value = find(key, FieldKind::number, "is no number");
  if (value == nullptr) return 0;
  const auto decimal = decimal_of(*value);
  const auto number = decimal
                          ? (*decimal * files::Decimal::of(1'000'000'000)).rounded().to_integer()
                          : std::nullopt;
  if (number && *number != std::numeric_limits<std::int64_t>::min()) return *number;
  reject(key, "is out of range");
  return 0;
}

const JsonValue* JsonFields::list(std::string_view key, std::size_t count_max) {
  const JsonValue* const value = find(key, FieldKind::array, "is no list");
  if (value == nullptr || value->items.size() <= count_max) return value;
  reject(key, "is too long");
  return nullptr;
}

const JsonValue* JsonFields::object(std::string_view key) {
  return find(key, FieldKind::object, "is no object");
}

}  // namespace etcm::firmware
