#include "firmware/status/text_writer.h"

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
