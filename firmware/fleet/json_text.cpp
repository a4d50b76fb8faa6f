#include "firmware/fleet/json_text.h"

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
