#include "serial_units.h"

#include <unistd.h>

#include <algorithm>
#include <array>

namespace etcm::nodes {

SerialUnits::SerialUnits(port::EventLoop& loop, Fleet& fleet, int descriptor,
                         const port::SerialLine& line)
    : loop_(loop),
      fleet_(fleet),
      descriptor_(descriptor),
      character_(character_time(line)),
      silence_(frame_silence(line)) {
  loop_.add(descriptor_, *this, true, false);
}

SerialUnits::~SerialUnits() { loop_.remove(descriptor_); }

void SerialUnits::on_ready(bool, bool) {
  std::array<std::uint8_t, 512> bytes;
  const ssize_t count = ::read(descriptor_, bytes.data(), bytes.size());
  if (count > 0) heard_.insert(heard_.end(), bytes.begin(), bytes.begin() + count);
}

void SerialUnits::advance(port::Instant now) {
  if (timed_ < heard_.size()) {
    line_busy_until_ = std::max(line_busy_until_, now) +
                       static_cast<std::int64_t>(heard_.size() - timed_) * character_;
    timed_ = heard_.size();
    if (is_sending() && answer_begin_ <= now) {
      ++collisions_;
      for (std::size_t i = sent_; i < answer_.size(); ++i) answer_[i] ^= 0x5a;
    }
  }
  if (is_sending()) send(now);
  const port::Instant heard_at = line_busy_until_ + silence_;
  if (!heard_.empty() && heard_at <= now) {
    if (!is_sending()) answer(heard_at);
    heard_.clear();
    timed_ = 0;
  }
}

port::Instant SerialUnits::next_deadline() const {
  port::Instant deadline = heard_.empty() ? port::never : line_busy_until_ + silence_;
  if (is_sending()) {
    deadline =
        std::min(deadline, answer_begin_ + static_cast<std::int64_t>(sent_ + 1) * character_);
  }
  return deadline;
}

// Makes the answer to what was heard, if it is a request for a unit of ours.
void SerialUnits::answer(port::Instant heard_at) {
  answer_.clear();
  sent_ = 0;
  if (!port::is_rtu_frame(heard_)) return;
  const std::uint8_t unit = heard_[0];
  const auto request = std::span<const std::uint8_t>(heard_).subspan(
      port::rtu_unit_bytes, heard_.size() - port::rtu_unit_bytes - port::rtu_checksum_bytes);
  answer_.resize(port::rtu_frame_bytes_max);
  const std::size_t pdu =
      fleet_.answer(0, unit, request, std::span(answer_).subspan(port::rtu_unit_bytes));
  if (pdu == 0) return answer_.clear();
  const Fault fault = fleet_.fault(0, unit);
  const auto speaker =
      static_cast<std::uint8_t>(fault.action == Action::wrong_unit ? unit % 247 + 1 : unit);
  answer_.resize(port::wrap_rtu(answer_, speaker, pdu));
  answer_begin_ = heard_at;
  misbehave(fault);
}

void SerialUnits::misbehave(const Fault& fault) {
  switch (fault.action) {
    case Action::late:
      answer_begin_ += std::chrono::milliseconds(fault.value);
      break;
    case Action::garbled:
      answer_[answer_.size() / 2] ^= 0x10;
      break;
    case Action::truncated:
      answer_.resize(answer_.size() / 2);
      break;
    case Action::noise:
      answer_.insert(answer_.begin(), {0x00, 0xff, 0x55, 0xaa, 0x04, 0x03});
      break;
    default:
      break;
  }
}

void SerialUnits::send(port::Instant now) {
  const std::int64_t due = now < answer_begin_ ? 0 : (now - answer_begin_) / character_;
  const std::size_t end = std::min(answer_.size(), static_cast<std::size_t>(due));
  if (end <= sent_) return;
  // What is not read is lost, as on a cable.
  [[maybe_unused]] const ssize_t written =
      ::write(descriptor_, answer_.data() + sent_, end - sent_);
  sent_ = end;
}

}  // namespace etcm::nodes
