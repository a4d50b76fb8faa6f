// Numbers and texts as bytes that outlive a program: numbers are little-endian, and everything
// follows the one before without gaps.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <string_view>
#include <vector>

namespace etcm::port {

template <std::integral Number>
void put_number(std::vector<std::byte>& bytes, Number number) {
  for (std::size_t i = 0; i < sizeof number; ++i) {
    bytes.push_back(static_cast<std::byte>(static_cast<std::uint64_t>(number) >> (8 * i)));
  }
}

inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline void put_text(std::vector<std::byte>& bytes, std::string_view text) {
  std::transform(text.begin(), text.end(), std::back_inserter(bytes),
                 [](char c) { return static_cast<std::byte>(c); });
}

// Takes them off the front. Past the end a number is 0 and a text empty, and is_cut_off() says so.
class ByteReader {
 public:
  ByteReader() = default;
  // The bytes must outlive this, and the texts that are taken.
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <std::integral Number>
  Number take() {
    std::uint64_t bits = 0;
    const std::span<const std::byte> taken = take_bytes(sizeof(Number));
    for (std::size_t i = taken.size(); i-- > 0;) {
      bits = bits << 8 | std::to_integer<std::uint64_t>(taken[i]);
    }
    return static_cast<Number>(bits);
  }
  std::string_view take_text(std::size_t size) { return text_of(take_bytes(size)); }
  // All of them, or none.
  std::span<const std::byte> take_bytes(std::size_t size) {
    if (size > rest_.size()) {
      is_cut_off_ = true;
      rest_ = {};
      return {};
    }
    const std::span<const std::byte> taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }

  // Whether so many records may still come: asked before memory is taken for them.
  bool has(std::uint64_t count, std::size_t size_each) const {
    return count <= rest_.size() / size_each;
  }
  std::size_t left() const { return rest_.size(); }
  bool is_cut_off() const { return is_cut_off_; }

 private:
  std::span<const std::byte> rest_;
  bool is_cut_off_ = false;
};

}  // namespace etcm::port
