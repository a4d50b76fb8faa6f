#include "modbus/rtu_line.h"

#include <algorithm>
#include <utility>

namespace etcm::port {

bool RtuLine::send(std::span<std::uint8_t> frame, std::uint8_t address, std::size_t pdu_bytes,
                   std::string& why) {
  return write(frame.first(wrap_rtu(frame, address, pdu_bytes)), why);
}

bool RtuLine::take_news() { return std::exchange(has_news_, false); }

std::optional<RtuAnswer> RtuLine::next_answer() const {
  return find_rtu_answer(std::span(heard_).first(heard_count_));
}

void RtuLine::drop(const RtuAnswer& answer) {
  std::copy(heard_.begin() + static_cast<std::ptrdiff_t>(answer.end),
            heard_.begin() + static_cast<std::ptrdiff_t>(heard_count_), heard_.begin());
  heard_count_ -= answer.end;
}

void RtuLine::hear(std::span<const std::uint8_t> bytes) {
  has_news_ = has_news_ || !bytes.empty();
  while (!bytes.empty()) {
    if (heard_count_ == heard_.size()) {
      // Longer than any frame, so its older half belongs to none that is still coming.
      std::copy(heard_.begin() + rtu_frame_bytes_max, heard_.end(), heard_.begin());
      heard_count_ -= rtu_frame_bytes_max;
    }
    const std::size_t count = std::min(bytes.size(), heard_.size() - heard_count_);
    std::copy_n(bytes.begin(), count, heard_.begin() + static_cast<std::ptrdiff_t>(heard_count_));
    heard_count_ += count;
    bytes = bytes.subspan(count);
  }
}

void RtuLine::forget_all() {
  heard_count_ = 0;
  has_news_ = false;
}

}  // namespace etcm::port
