// Text on its way into a string or into a file; numbers are the same text everywhere.
#pragma once

#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace etcm::files {

class TextSink {
 public:
  // Appends to `text`.
  explicit TextSink(std::string& text) : text_(&text) {}
  // Writes to the descriptor whenever `buffer` is full, and at finish(): no text needs more memory.
  // What waits for that descriptor waits here.
  TextSink(int descriptor, std::span<char> buffer) : descriptor_(descriptor), buffer_(buffer) {}
  TextSink(const TextSink&) = delete;
  TextSink& operator=(const TextSink&) = delete;

  TextSink& operator<<(std::string_view text);
  TextSink& operator<<(char letter) { return *this << std::string_view(&letter, 1); }
  template <std::integral Number>
  requires(!std::same_as<Number, bool> && !std::same_as<Number, char>) TextSink& operator<<(
      Number number) {
    char digits[24];
    return *this << std::string_view(digits, std::to_chars(digits, digits + 24, number).ptr);
  }
  // The shortest text that reads back as the same double.
  TextSink& operator<<(double number);

  // Writes what is left. Returns errno of the first write that failed, 0 where none did; nothing
  // was written behind that one.
  int finish();

 private:
  std::string* text_ = nullptr;
  int descriptor_ = -1;
  std::span<char> buffer_;
  std::size_t used_ = 0;
  int error_ = 0;
};

// What a function that takes a sink and these arguments writes.
template <class Write, class... Arguments>
std::string text_of(const Write& write, const Arguments&... arguments) {
  std::string text;
  TextSink out(text);
  write(out, arguments...);
  return text;
}

}  // namespace etcm::files
