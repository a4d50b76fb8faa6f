// A fuzz target: one function that takes any bytes. libFuzzer calls it (libfuzzer.cpp), or a
// program that reads files (replay.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace etcm::fuzz {

// Each target defines it. It may refuse any bytes and keeps nothing from one call to the next.
void run(std::span<const std::uint8_t> bytes);

// Ends the program where that does not hold, so that the bytes are kept.
void require(bool holds, const char* what);

// Takes bytes from the front; where none are left, zeros.
class Input {
 public:
  explicit Input(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool is_empty() const { return bytes_.empty(); }
  std::uint8_t byte();
  std::uint16_t word();
  std::uint32_t number();
  // Below `end`, which is at least 1 and at most 65536.
  std::uint32_t below(std::uint32_t end);
  // At most so many bytes, in memory that ends where they do.
  std::span<const std::uint8_t> take(std::size_t most);
  std::span<const std::uint8_t> rest() { return take(bytes_.size()); }

 private:
  std::span<const std::uint8_t> bytes_;
};

inline std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace etcm::fuzz
