#include "firmware/status/text_writer.h"

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

TextWriter& TextWriter::seconds(port::Duration duration) {
  return decimal(std::chrono::duration<double>(duration).count(), 6);
}

TextWriter& TextWriter::json(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  *this << "\"";
  for (const char& character : text) {
    const auto code = static_cast<unsigned char>(character);
    if (character == '"' || character == '\\') {
      *this << "\\" << std::string_view(&character, 1);
    } else if (code < 0x20) {
      *this << "\\u00" << digits.substr(code >> 4, 1) << digits.substr(code & 15, 1);
    } else {
      *this << std::string_view(&character, 1);
    }
  }
  return *this << "\"";
}

TextWriter& TextWriter::label(std::string_view text) {
  *this << "\"";
  for (const char& character : text) {
    if (character == '\n') {
      *this << "\\n";
    } else {
      if (character == '"' || character == '\\') *this << "\\";
      *this << std::string_view(&character, 1);
    }
  }
  return *this << "\"";
}

}  // namespace etcm::firmware
