// Text into memory that is there: numbers, and texts as JSON and Prometheus want them.
//
// From the first character on that does not fit all is left out, so the room must be sized for the
// longest text; is_full() tells.
#pragma once

#include <algorithm>
#include <charconv>
#include <concepts>
#include <cstdint>
#include <span>
#include <string_view>

#include "etcm/port/clock.h"
#include "etcm/port/utf8.h"

namespace etcm::firmware {

class TextWriter {
 public:
  explicit TextWriter(std::span<char> room) : room_(room) {}

  std::string_view text() const { return {room_.data(), size_}; }
  bool is_full() const { return is_full_; }
  void clear() {
    size_ = 0;
    is_full_ = false;
  }

  TextWriter& operator<<(std::string_view text) {
    if (is_full_) return *this;
    is_full_ = text.size() > room_.size() - size_;
    text = port::cut_utf8(text, room_.size() - size_);
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
  // What is in 10^-9, exactly: 1234000000 is 1.234. REQUIRES: not the least of its type.
  TextWriter& nano(std::int64_t value);
  TextWriter& seconds(port::Duration duration);
  // "2026-11-23T15:08:24Z" of milliseconds since 1970; nothing for 0, a time that is not known.
  TextWriter& utc(std::int64_t unix_ms);
  TextWriter& hex(std::uint64_t value) {
    return take(std::to_chars(room_.data() + size_, room_.data() + room_.size(), value, 16));
  }
  // All 16 digits.
  TextWriter& hash(std::uint64_t value);
  TextWriter& yes_or_no(bool value) { return *this << (value ? "true" : "false"); }
  // In quotation marks; what is no UTF-8 becomes "?".
  TextWriter& json(std::string_view text);
  TextWriter& label(std::string_view text);  // of a metric
  // As a field of RFC 4180: in quotation marks, which are doubled within; on one line.
  TextWriter& csv(std::string_view text);

 private:
  // As JSON and labels have it where nothing needs an escape. Returns its bytes in `text`.
  std::size_t character(std::string_view text);
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
