// JSON that is written piece by piece: commas come by themselves.
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace etcm::firmware {

class JsonText {
 public:
  // Each begins what end() closes; a value of an object needs its key() first.
  JsonText& object() { return open('{', '}'); }
  JsonText& array() { return open('[', ']'); }
  JsonText& end();
  JsonText& key(std::string_view name);

  // What is no UTF-8 becomes "?".
  JsonText& text(std::string_view value);
  // As it is: a number that was checked, or a document.
  JsonText& raw(std::string_view value);
  JsonText& boolean(bool value) { return raw(value ? "true" : "false"); }
  template <std::integral Number>
  JsonText& number(Number value) {
    return raw(std::to_string(value));
  }
  // In 10^-9, exactly. REQUIRES: not the least of its type.
  JsonText& nano(std::int64_t value);
  // Sixteen digits, as a text: programs that read JSON keep 53 bits of a number.
  JsonText& hash(std::uint64_t value);

  std::string take() { return std::move(text_); }

 private:
  JsonText& open(char begin, char end);
  void separate();

  std::string text_;
  std::string closing_;
  bool is_first_ = true;
};

// "2026-03-01T14:03:10Z", of seconds since the beginning of 1970.
std::string utc_text(std::int64_t unix_s);

// The digits of a number, so many of them.
std::string hex_text(std::uint64_t value, std::size_t digits);

}  // namespace etcm::firmware
