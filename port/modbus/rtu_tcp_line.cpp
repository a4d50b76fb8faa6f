#include "modbus/rtu_tcp_line.h"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "posix/tcp_socket.h"

namespace etcm::port {

bool RtuTcpLine::open(std::string& why) {
  close();
  socket_ = connect_tcp(address_);
  if (!socket_.is_open()) {
    why = std::strerror(errno);
    return false;
  }
  loop_.add(socket_.get(), *this, false, true);
  return true;
}

void RtuTcpLine::close() {
  if (socket_.is_open()) {
    // What the server has not passed on must not reach the line after all.
    reset_on_close(socket_.get());
    if (why_gone_ == nullptr) loop_.remove(socket_.get());
  }
  socket_.close();
  is_connected_ = false;
  why_gone_ = nullptr;
  forget_all();
}

void RtuTcpLine::discard() {
  if (is_connected_) receive();
  forget_all();
}

bool RtuTcpLine::write(std::span<const std::uint8_t> frame, std::string& why) {
  const ssize_t sent = ::send(socket_.get(), frame.data(), frame.size(), MSG_NOSIGNAL);
  if (sent == static_cast<ssize_t>(frame.size())) return true;
  why = sent < 0 ? std::strerror(errno) : "the other side does not read";
  return false;
}

void RtuTcpLine::on_ready(bool, bool) {
  if (is_connected_) return receive();
  const int error = connect_error(socket_.get());
  if (error != 0) return lose(std::strerror(error));
  is_connected_ = true;
  loop_.change(socket_.get(), true, false);
}

void RtuTcpLine::receive() {
  std::array<std::uint8_t, heard_bytes_max> bytes;
  while (why_gone_ == nullptr) {
    const ssize_t count = ::recv(socket_.get(), bytes.data(), bytes.size(), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) return;
    if (count < 0) return lose(std::strerror(errno));
    if (count == 0) return lose("connection closed by the other side");
    hear(std::span(bytes).first(static_cast<std::size_t>(count)));
  }
}

void RtuTcpLine::lose(const char* why) {
  // Its user closes it; until then the loop would call for it all the time.
  is_connected_ = false;
  why_gone_ = why;
  loop_.remove(socket_.get());
}

}  // namespace etcm::port
