#include "modbus/rtu_line.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "modbus/serial_port.h"

namespace etcm::port {

bool RtuLine::open(std::string& why) {
  close();
  port_ = open_serial(line_, why);
  if (!port_.is_open()) return false;
  loop_.add(port_.get(), *this, true, false);
  return true;
}

void RtuLine::close() {
  if (port_.is_open()) discard_waiting(port_.get());
  if (port_.is_open() && !is_gone_) loop_.remove(port_.get());
  port_.close();
  is_gone_ = has_news_ = false;
  heard_count_ = 0;
}

void RtuLine::discard() {
  receive();
  heard_count_ = 0;
  has_news_ = false;
  discard_waiting(port_.get());
}

bool RtuLine::send(std::span<std::uint8_t> frame, std::uint8_t unit, std::size_t pdu_bytes,
                   std::string& why) {
  const std::size_t size = wrap_rtu(frame, unit, pdu_bytes);
  const ssize_t sent = ::write(port_.get(), frame.data(), size);
  if (sent == static_cast<ssize_t>(size)) return true;
  why = sent < 0 ? std::strerror(errno) : "it takes no bytes";
  return false;
}

bool RtuLine::is_sent() const { return port::is_sent(port_.get()); }

bool RtuLine::take_news() { return std::exchange(has_news_, false); }

std::optional<RtuAnswer> RtuLine::next_answer() const {
  return find_rtu_answer(std::span(heard_).first(heard_count_));
}

void RtuLine::drop(const RtuAnswer& answer) {
  std::copy(heard_.begin() + static_cast<std::ptrdiff_t>(answer.end),
            heard_.begin() + static_cast<std::ptrdiff_t>(heard_count_), heard_.begin());
  heard_count_ -= answer.end;
}

void RtuLine::on_ready(bool, bool) {
  if (receive()) return;
  // Nobody could wait for a port that is gone: it is ready all the time.
  is_gone_ = true;
  loop_.remove(port_.get());
}

// Takes what has arrived; false when the port is gone.
bool RtuLine::receive() {
  while (true) {
    if (heard_count_ == heard_.size()) {
      // Longer than any frame, so its older half belongs to none that is still coming.
      std::copy(heard_.begin() + rtu_frame_bytes_max, heard_.end(), heard_.begin());
      heard_count_ -= rtu_frame_bytes_max;
    }
    const auto space = std::span(heard_).subspan(heard_count_);
    const ssize_t count = ::read(port_.get(), space.data(), space.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno == EAGAIN;
    if (count == 0) return false;
    heard_count_ += static_cast<std::size_t>(count);
    has_news_ = true;
    if (static_cast<std::size_t>(count) < space.size()) return true;
  }
}

}  // namespace etcm::port
