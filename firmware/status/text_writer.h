// Text into memory that is there: numbers, and texts as JSON and Prometheus want them.
//
// What does not fit is left out, so the room must be sized for the longest text; is_full() tells.
#pragma once

#include <algorithm>
#include <charconv>
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>

#include "etcm/port/clock.h"

namespace etcm::firmware {

class TextWriter {
 public:
  explicit TextWriter(std::span<char> room) : room_(room) {}

  std::string_view text() const { return {room_.data(), size_}; }
  bool is_full() const { return is_full_; }
  void clear() { size_ = 0; }

  TextWriter& operator<<(std::string_view text) {
    if (text.size() > room_.size() - size_) {
      is_full_ = true;
      text = text.substr(0, room_.size() - size_);
    }
    std::copy(text.begin(), text.end(), room_.data() + size_);
    size_ += text.size();
    return *this;
  }
  template <std::integral Number>
  requires(!std::same_as<Number, bool> && !std::same_as<Number, char>) TextWriter& operator<<(
      Number number) {
    return take(std::to_chars(room_.data() + size_, room_.data() + room_.size(), number));
  }

  // With so many digits behind the point, as far as they are not zeros at the end.
  TextWriter& decimal(double value, int digits);
  TextWriter& seconds(port::Duration duration);
  TextWriter& hex(std::uint64_t value) {
    return take(std::to_chars(room_.data() + size_, room_.data() + room_.size(), value, 16));
  }
  TextWriter& yes_or_no(bool value) { return *this << (value ? "true" : "false"); }
  // In quotation marks.
  TextWriter& json(std::string_view text);
  TextWriter& label(std::string_view text);  // of a metric

 private:
  TextWriter& take(std::to_chars_result written) {
    if (written.ec == std::errc{}) {
      size_ = static_cast<std::size_t>(written.ptr - room_.data());
    } else {
      is_full_ = true;
    }
    return *this;
  }

  std::span<char> room_;
  std::size_t size_ = 0;
  bool is_full_ = false;
};

}  // namespace etcm::firmware
