#include "modbus/rtu_tcp_line.h"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "posix/tcp_socket.h"

namespace etcm::port {

bool RtuTcpLine::open(Instant now, std::string&) {
  close();
  connector_.start(end_, now);
  return true;
}

void RtuTcpLine::on_socket(FileDescriptor socket) {
  socket_ = std::move(socket);
  loop_.add(socket_.get(), *this, true, false);
}

void RtuTcpLine::close() {
  connector_.stop();
  if (socket_.is_open()) {
    // What the server has not passed on must not reach the line after all.
    reset_on_close(socket_.get());
    if (why_gone_.empty()) loop_.remove(socket_.get());
  }
  socket_.close();
  why_gone_.clear();
  forget_all();
}

void RtuTcpLine::discard() {
  if (is_ready()) receive();
  forget_all();
}

bool RtuTcpLine::write(std::span<const std::uint8_t> frame, std::string& why) {
  const ssize_t sent = ::send(socket_.get(), frame.data(), frame.size(), MSG_NOSIGNAL);
  if (sent == static_cast<ssize_t>(frame.size())) return true;
  why = sent < 0 ? std::strerror(errno) : "the other side does not read";
  return false;
}

void RtuTcpLine::on_ready(bool, bool) { receive(); }

void RtuTcpLine::receive() {
  std::array<std::uint8_t, heard_bytes_max> bytes;
  while (is_ready()) {
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
  why_gone_ = why;
  loop_.remove(socket_.get());
}

}  // namespace etcm::port
