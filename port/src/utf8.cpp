#include "etcm/port/utf8.h"

namespace etcm::port {

namespace {

constexpr std::size_t character_bytes_max = 4;

struct Lead {
  unsigned char first, last;  // of the first byte
  std::size_t size;           // of the character
  unsigned char second_min, second_max;
};

// The Unicode Standard, table 3-7: neither overlong forms nor surrogates are characters.
constexpr Lead leads[] = {
    {0x00, 0x7f, 1, 0, 0},       {0xc2, 0xdf, 2, 0x80, 0xbf}, {0xe0, 0xe0, 3, 0xa0, 0xbf},
    {0xe1, 0xec, 3, 0x80, 0xbf}, {0xed, 0xed, 3, 0x80, 0x9f}, {0xee, 0xef, 3, 0x80, 0xbf},
    {0xf0, 0xf0, 4, 0x90, 0xbf}, {0xf1, 0xf3, 4, 0x80, 0xbf}, {0xf4, 0xf4, 4, 0x80, 0x8f}};

bool is_continuation(char byte) { return (static_cast<unsigned char>(byte) & 0xc0) == 0x80; }

}  // namespace

std::size_t utf8_character(std::string_view text) {
  if (text.empty()) return 0;
  const auto first = static_cast<unsigned char>(text[0]);
  for (const Lead& lead : leads) {
    if (first < lead.first || first > lead.last) continue;
    if (lead.size == 1) return 1;
    if (text.size() < lead.size) return 0;
    const auto second = static_cast<unsigned char>(text[1]);
    if (second < lead.second_min || second > lead.second_max) return 0;
    for (std::size_t i = 2; i < lead.size; ++i) {
      if (!is_continuation(text[i])) return 0;
    }
    return lead.size;
  }
  return 0;
}

std::string_view cut_utf8(std::string_view text, std::size_t bytes_max) {
  if (text.size() <= bytes_max) return text;
  for (std::size_t back = 0; back < character_bytes_max && back <= bytes_max; ++back) {
    if (!is_continuation(text[bytes_max - back])) return text.substr(0, bytes_max - back);
  }
  return text.substr(0, bytes_max);
}

std::string_view cut_words(std::string_view text, std::size_t bytes_max) {
  const std::string_view fits = cut_utf8(text, bytes_max);
  if (fits.size() == text.size() || text[fits.size()] == ' ') return fits;
  return fits.substr(0, fits.rfind(' '));
}

}  // namespace etcm::port
