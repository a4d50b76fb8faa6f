#include "etcm/files/text_sink.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace etcm::files {

namespace {

// 0, or errno.
int write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

}  // namespace

TextSink& TextSink::operator<<(std::string_view text) {
  if (text_ != nullptr) {
    *text_ += text;
    return *this;
  }
  while (!text.empty()) {
    if (used_ == buffer_.size()) finish();
    const std::size_t count = std::min(text.size(), buffer_.size() - used_);
    std::copy_n(text.begin(), count, buffer_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ += count;
    text.remove_prefix(count);
  }
  return *this;
}

TextSink& TextSink::operator<<(double number) {
  char digits[32];
  return *this << std::string_view(digits, std::to_chars(digits, digits + 32, number).ptr);
}

int TextSink::finish() {
  if (error_ == 0 && text_ == nullptr) error_ = write_all(descriptor_, {buffer_.data(), used_});
  used_ = 0;
  return error_;
}

}  // namespace etcm::files
