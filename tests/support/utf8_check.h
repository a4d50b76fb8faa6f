// Whether a text is UTF-8, as the C library sees it.
#pragma once

#include <iconv.h>

#include <array>
#include <cerrno>
#include <string>
#include <string_view>

namespace etcm::test {

inline bool is_utf8(std::string_view text) {
  const iconv_t converter = ::iconv_open("UTF-32", "UTF-8");
  std::string input(text);
  char* in = input.data();
  std::size_t in_left = input.size();
  std::array<char, 4096> room;
  std::size_t result = 0;
  do {
    char* out = room.data();
    std::size_t out_left = room.size();
    result = ::iconv(converter, &in, &in_left, &out, &out_left);
  } while (result == static_cast<std::size_t>(-1) && in_left > 0 && errno == E2BIG);
  ::iconv_close(converter);
  return result != static_cast<std::size_t>(-1);
}

}  // namespace etcm::test
