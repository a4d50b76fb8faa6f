#include "modbus/tcp_connection.h"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "posix/tcp_socket.h"

namespace etcm::port {

void TcpConnection::connect(const Endpoint& end, Instant now, Duration time_max) {
  state_ = State::connecting;
  reader_.clear();
  connector_.start(end, now, time_max);
}

void TcpConnection::on_socket(FileDescriptor socket) {
  socket_ = std::move(socket);
  state_ = State::up;
  loop_.add(socket_.get(), *this, true, false);
  listener().on_connected();
}

void TcpConnection::on_failure(const char* why) {
  state_ = State::down;
  listener().on_lost(why);
}

void TcpConnection::send(std::span<std::uint8_t> frame, std::uint16_t transaction,
                         std::uint8_t address, std::size_t pdu_bytes) {
  const std::size_t size = write_header(frame, transaction, address, pdu_bytes);
  // A few requests always fit the socket's buffer, unless the peer has stopped reading altogether;
  // then the connection is as good as gone.
  const ssize_t sent = ::send(socket_.get(), frame.data(), size, MSG_NOSIGNAL);
  if (sent != static_cast<ssize_t>(size)) {
    lose(sent < 0 ? std::strerror(errno) : "the other side does not read");
  }
}

void TcpConnection::discard() {
  if (reader_.empty()) return;
  receive();
  reader_.clear();
}

void TcpConnection::close() {
  connector_.stop();
  if (socket_.is_open()) loop_.remove(socket_.get());
  socket_.close();
  state_ = State::down;
}

void TcpConnection::abort() {
  if (socket_.is_open()) reset_on_close(socket_.get());
  close();
}

void TcpConnection::on_ready(bool can_read, bool can_write) {
  if (can_read || can_write) receive();
}

void TcpConnection::receive() {
  while (state_ == State::up) {
    const std::span<std::uint8_t> space = reader_.free_space();
    const ssize_t count = ::recv(socket_.get(), space.data(), space.size(), 0);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (count < 0) return lose(std::strerror(errno));
    if (count == 0) return lose("connection closed by the other side");
    reader_.received(static_cast<std::size_t>(count));
    Frame frame;
    FrameReader::Next next = reader_.next(frame);
    for (; next == FrameReader::Next::frame; next = reader_.next(frame)) listener().on_frame(frame);
    if (next == FrameReader::Next::broken) return lose("what it sends is no Modbus TCP");
  }
}

void TcpConnection::lose(const char* why) {
  abort();
  listener().on_lost(why);
}

}  // namespace etcm::port
