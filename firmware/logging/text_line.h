// A line of text in UTF-8 that is put together without a heap: from the first character on that
// does not fit all is cut off.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <string_view>

#include "etcm/port/utf8.h"

namespace etcm::firmware {

class TextLine {
 public:
  TextLine& operator<<(std::string_view text) {
    if (is_cut_) return *this;
    const std::string_view fits = port::cut_utf8(text, text_.size() - size_);
    std::copy(fits.begin(), fits.end(), text_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += fits.size();
    is_cut_ = fits.size() < text.size();
    return *this;
  }

  template <std::integral Number>
  TextLine& operator<<(Number value) {
    std::array<char, 24> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return *this << std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data()));
  }

  std::string_view view() const { return {text_.data(), size_}; }
  operator std::string_view() const { return view(); }

 private:
  std::array<char, 480> text_;
  std::size_t size_ = 0;
  bool is_cut_ = false;
};

}  // namespace etcm::firmware
