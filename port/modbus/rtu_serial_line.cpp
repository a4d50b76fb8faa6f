#include "modbus/rtu_serial_line.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "modbus/serial_port.h"

namespace etcm::port {

bool RtuSerialLine::open(Instant, std::string& why) {
  close();
  port_ = open_serial(settings_, why);
  if (!port_.is_open()) return false;
  loop_.add(port_.get(), *this, true, false);
  return true;
}

void RtuSerialLine::close() {
  if (port_.is_open()) discard_waiting(port_.get());
  if (port_.is_open() && !is_gone_) loop_.remove(port_.get());
  port_.close();
  is_gone_ = false;
  forget_all();
}

void RtuSerialLine::discard() {
  receive();
  forget_all();
  discard_waiting(port_.get());
}

bool RtuSerialLine::write(std::span<const std::uint8_t> frame, std::string& why) {
  const ssize_t sent = ::write(port_.get(), frame.data(), frame.size());
  if (sent == static_cast<ssize_t>(frame.size())) return true;
  why = sent < 0 ? std::strerror(errno) : "it takes no bytes";
  return false;
}

bool RtuSerialLine::is_sent() const { return port::is_sent(port_.get()); }

void RtuSerialLine::on_ready(bool, bool) {
  if (receive()) return;
  // Waiting for a port that is gone is impossible: it is ready all the time.
  is_gone_ = true;
  loop_.remove(port_.get());
}

// Takes what has arrived; false when the port is gone.
bool RtuSerialLine::receive() {
  std::array<std::uint8_t, heard_bytes_max> bytes;
  while (true) {
    const ssize_t count = ::read(port_.get(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno == EAGAIN;
    if (count == 0) return false;
    hear(std::span(bytes).first(static_cast<std::size_t>(count)));
    if (static_cast<std::size_t>(count) < bytes.size()) return true;
  }
}

}  // namespace etcm::port
