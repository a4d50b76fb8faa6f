#include "firmware/status/text_writer.h"

#include <array>
#include <chrono>
#include <cstdio>

#include "etcm/files/decimal.h"

namespace etcm::firmware {

TextWriter& TextWriter::decimal(double value, int digits) {
  const std::size_t begin = size_;
  take(std::to_chars(room_.data() + size_, room_.data() + room_.size(), value,
                     std::chars_format::fixed, digits));
  const std::string_view written = text().substr(begin);
  if (written.find('.') == std::string_view::npos) return *this;
  const std::size_t last = written.find_last_not_of('0');
  size_ = begin + last + (written[last] == '.' ? 0 : 1);
  return *this;
}

TextWriter& TextWriter::nano(std::int64_t value) {
  files::write_nano(*this, value);
  return *this;
}

TextWriter& TextWriter::hash(std::uint64_t value) {
  constexpr std::string_view digits = "0123456789abcdef";
  for (int shift = 60; shift >= 0; shift -= 4) *this << digits.substr(value >> shift & 15, 1);
  return *this;
}

TextWriter& TextWriter::seconds(port::Duration duration) {
  return decimal(std::chrono::duration<double>(duration).count(), 6);
}

std::size_t TextWriter::character(std::string_view text) {
  const std::size_t size = port::utf8_character(text);
  *this << (size == 0 ? "?" : text.substr(0, size));
  return std::max<std::size_t>(size, 1);
}

TextWriter& TextWriter::json(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  *this << "\"";
  while (!text.empty()) {
    const auto code = static_cast<unsigned char>(text.front());
    if (code < 0x20) {
      *this << "\\u00" << digits.substr(code >> 4, 1) << digits.substr(code & 15, 1);
      text.remove_prefix(1);
      continue;
    }
    if (code == '"' || code == '\\') *this << "\\";
    text.remove_prefix(character(text));
  }
  return *this << "\"";
}

TextWriter& TextWriter::utc(std::int64_t unix_ms) {
  if (unix_ms <= 0) return *this;
  // The last second of the year 9999: a later one has no such text.
  const std::chrono::sys_seconds at{
      std::chrono::seconds(std::min<std::int64_t>(unix_ms / 1000, 253'402'300'799))};
  const auto day = std::chrono::floor<std::chrono::days>(at);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss time{at - day};
  std::array<char, 64> text{};
  const int size = std::snprintf(
      text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02dZ", static_cast<int>(date.year()),
      static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
      static_cast<int>(time.hours().count()), static_cast<int>(time.minutes().count()),
      static_cast<int>(time.seconds().count()));
  return *this << std::string_view(text.data(), static_cast<std::size_t>(std::max(size, 0)));
}

TextWriter& TextWriter::csv(std::string_view text) {
  *this << "\"";
  while (!text.empty()) {
    if (static_cast<unsigned char>(text.front()) < 0x20) {
      *this << " ";
      text.remove_prefix(1);
      continue;
    }
    if (text.front() == '"') *this << "\"";
    text.remove_prefix(character(text));
  }
  return *this << "\"";
}

TextWriter& TextWriter::label(std::string_view text) {
  *this << "\"";
  while (!text.empty()) {
    if (text.front() == '\n') {
      *this << "\\n";
      text.remove_prefix(1);
      continue;
    }
    if (text.front() == '"' || text.front() == '\\') *this << "\\";
    text.remove_prefix(character(text));
  }
  return *this << "\"";
}

}  // namespace etcm::firmware
