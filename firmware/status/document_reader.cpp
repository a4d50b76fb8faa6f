#include "firmware/status/document_reader.h"

#include <algorithm>
#include <cstring>

namespace etcm::firmware {

void DocumentReader::begin(port::Instant asked_at) {
  document_ = nullptr;
  cursor_ = {};
  asked_at_ = asked_at;
  rest_ = {};
}

std::size_t DocumentReader::read(std::span<char> out) {
  std::size_t size = 0;
  while (size < out.size()) {
    if (rest_.empty()) {
      if (document_ == nullptr) break;
      TextWriter piece(piece_);
      if (!document_->write_next(cursor_, asked_at_, piece)) break;
      rest_ = piece.text();
    }
    const std::size_t count = std::min(rest_.size(), out.size() - size);
    std::memcpy(out.data() + size, rest_.data(), count);
    rest_.remove_prefix(count);
    size += count;
  }
  return size;
}

}  // namespace etcm::firmware
