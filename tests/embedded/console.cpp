#include "console.h"

namespace etcm::test {

void put_number(std::uint64_t value) {
  char text[21];
  char* at = text + sizeof text - 1;
  *at = 0;
  do {
    *--at = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value != 0);
  put(at);
}

void put_hex(std::uint64_t value) {
  char text[17];
  for (int i = 15; i >= 0; --i, value >>= 4) text[i] = "0123456789abcdef"[value & 15u];
  text[16] = 0;
  put(text);
}

}  // namespace etcm::test
