// A checksum of bytes: the same wherever they are, on every machine.
#pragma once

#include <cstddef>
#include <cstdint>

namespace etcm::internal {

// Each word of 8 bytes is taken in by a step that can be undone: so whatever is changed within one
// word shows for certain, and anything else with all but 2^-64.
class Checksum {
 public:
  // Several calls are not the same as one of them all: each ends its last word.
  void add(const std::byte* bytes, std::size_t count) noexcept {
    for (; count >= 8; count -= 8, bytes += 8) step(word(bytes, 8));
    if (count != 0) step(word(bytes, count));
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return sum_; }

 private:
  static std::uint64_t word(const std::byte* bytes, std::size_t count) noexcept {
    std::uint64_t w = 0;
    for (std::size_t i = 0; i < count; ++i) {
      w |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
    }
    return w;
  }
  void step(std::uint64_t w) noexcept {
    sum_ = (sum_ ^ w) * 0x9e37'79b9'7f4a'7c15u;
    sum_ ^= sum_ >> 32;
  }

  std::uint64_t sum_ = 0x6574'636d;
};

}  // namespace etcm::internal
