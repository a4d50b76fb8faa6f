#include "firmware/fleet/json_text.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>

#include "etcm/files/decimal.h"
#include "etcm/port/utf8.h"

namespace etcm::firmware {

namespace {

// What write_nano() writes to.
struct Appender {
  std::string& text;
  Appender& operator<<(std::string_view part) {
    text += part;
    return *this;
  }
  Appender& operator<<(std::int64_t number) {
    text += std::to_string(number);
    return *this;
  }
};

void append_escaped(std::string& out, std::string_view value) {
  while (!value.empty()) {
    const auto code = static_cast<unsigned char>(value.front());
    if (code < 0x20) {
      out += "\\u00" + hex_text(code, 2);
      value.remove_prefix(1);
      continue;
    }
    const std::size_t size = port::utf8_character(value);
    if (size == 0) {
      out += '?';
      value.remove_prefix(1);
      continue;
    }
    if (code == '"' || code == '\\') out += '\\';
    out += value.substr(0, size);
    value.remove_prefix(size);
  }
}

}  // namespace

std::string utc_text(std::int64_t unix_s) {
  // The last second of the year 9999: a later one has no such text.
  const std::chrono::sys_seconds at{
      std::chrono::seconds(std::min<std::int64_t>(unix_s, 253'402'300'799))};
  const auto day = std::chrono::floor<std::chrono::days>(at);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss time{at - day};
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02dZ",
                static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), static_cast<int>(time.hours().count()),
                static_cast<int>(time.minutes().count()), static_cast<int>(time.seconds().count()));
  return text.data();
}

std::string hex_text(std::uint64_t value, std::size_t digits) {
  std::string text(digits, '0');
  for (std::size_t at = digits; at-- > 0; value >>= 4) text[at] = "0123456789abcdef"[value & 15];
  return text;
}

void JsonText::separate() {
  if (!is_first_) text_ += ',';
  is_first_ = false;
}

JsonText& JsonText::open(char begin, char end) {
  separate();
  text_ += begin;
  closing_ += end;
  is_first_ = true;
  return *this;
}

JsonText& JsonText::end() {
  text_ += closing_.back();
  closing_.pop_back();
  is_first_ = false;
  return *this;
}

JsonText& JsonText::key(std::string_view name) {
  text(name);
  text_ += ':';
  is_first_ = true;
  return *this;
}

JsonText& JsonText::text(std::string_view value) {
  separate();
  text_ += '"';
  append_escaped(text_, value);
  text_ += '"';
  return *this;
}

JsonText& JsonText::raw(std::string_view value) {
  separate();
  text_ += value;
  return *this;
}

JsonText& JsonText::nano(std::int64_t value) {
  separate();
  Appender out{text_};
  files::write_nano(out, value);
  return *this;
}

JsonText& JsonText::hash(std::uint64_t value) { return text(hex_text(value, 16)); }

}  // namespace etcm::firmware
