// Modbus TCP: each question has a number, so an answer is never taken for another's.
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "link.h"
#include "modbus/frame.h"
#include "posix/tcp_socket.h"

namespace etcm::bus {

namespace {

class TcpLink final : public Link, private port::EventHandler {
 public:
  TcpLink(const port::SocketAddress& address, port::Duration patience)
      : name_(to_string(address)), socket_(port::connect_tcp(address)) {
    if (!socket_.is_open()) fail(std::strerror(errno));
    waiter_.loop().add(socket_.get(), *this, false, true);
    const port::Instant end = waiter_.now() + patience;
    while (!is_connected_) {
      if (end <= waiter_.now()) fail("no answer to the attempt to connect");
      waiter_.wait_until(end);
    }
    if (const int error = port::connect_error(socket_.get())) fail(std::strerror(error));
    waiter_.loop().change(socket_.get(), true, false);
  }
  ~TcpLink() override {
    if (!is_closed_) waiter_.loop().remove(socket_.get());
  }
  TcpLink(const TcpLink&) = delete;
  TcpLink& operator=(const TcpLink&) = delete;

  Reply ask(std::uint8_t unit, std::span<const std::uint8_t> request,
            port::Duration timeout) override {
    answer_bytes_ = 0;
    is_answered_ = false;
    ++transaction_;
    std::array<std::uint8_t, port::frame_bytes_max> frame;
    std::copy(request.begin(), request.end(), frame.begin() + port::mbap_header_bytes);
    const std::size_t size = port::write_header(frame, transaction_, unit, request.size());
    if (is_closed_ ||
        ::send(socket_.get(), frame.data(), size, MSG_NOSIGNAL) != static_cast<ssize_t>(size)) {
      throw_closed();
    }
    const port::Instant sent_at = waiter_.now();
    while (!is_answered_) {
      if (is_closed_) throw_closed();
      if (sent_at + timeout <= waiter_.now()) return {};
      waiter_.wait_until(sent_at + timeout);
    }
    const auto pdu = std::span<const std::uint8_t>(answer_).first(answer_bytes_);
    const bool is_of_it = answer_unit_ == unit && !pdu.empty() && (pdu[0] & 0x7f) == request[0];
    return {.outcome = is_of_it ? Outcome::answer : Outcome::garbled,
            .pdu = pdu,
            .took = waiter_.now() - sent_at};
  }

  const std::string& name() const override { return name_; }

  const char* advice() const override {
    return "look at the serial side of the converter: A and B exchanged, speed, parity, supply of "
           "the units";
  }

  void pause(port::Duration duration) override {
    const port::Instant end = waiter_.now() + duration;
    while (waiter_.now() < end) {
      waiter_.wait_until(end);
      if (is_closed_) throw_closed();
    }
  }

 private:
  [[noreturn]] void fail(const char* why) const {
    throw LinkError(name_ + ": " + why +
                    "; check address and port (-p), and that the device takes one more master");
  }

  [[noreturn]] void throw_closed() const {
    throw LinkError(name_ + ": " + why_closed_ +
                    "; most devices take few masters at a time: end the others, and try again");
  }

  void on_ready(bool can_read, bool can_write) override {
    if (!is_connected_) {
      is_connected_ = can_read || can_write;
      return;
    }
    const std::span<std::uint8_t> space = reader_.free_space();
    const ssize_t count = ::recv(socket_.get(), space.data(), space.size(), 0);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (count <= 0) return close("the other side closed the connection");
    reader_.received(static_cast<std::size_t>(count));
    port::Frame frame;
    auto next = reader_.next(frame);
    for (; next == port::FrameReader::Next::frame; next = reader_.next(frame)) {
      if (frame.transaction != transaction_ || is_answered_) continue;
      is_answered_ = true;
      answer_unit_ = frame.unit;
      answer_bytes_ = frame.pdu.size();
      std::copy(frame.pdu.begin(), frame.pdu.end(), answer_.begin());
    }
    if (next == port::FrameReader::Next::broken) close("what it sends is no Modbus TCP");
  }

  void close(const char* why) {
    waiter_.loop().remove(socket_.get());
    is_closed_ = true;
    why_closed_ = why;
  }

  std::string name_;
  Waiter waiter_;
  port::FileDescriptor socket_;
  bool is_connected_ = false;
  bool is_closed_ = false;
  const char* why_closed_ = "the other side does not read";
  std::uint16_t transaction_ = 0;
  port::FrameReader reader_;
  bool is_answered_ = false;
  std::uint8_t answer_unit_ = 0;
  std::array<std::uint8_t, port::pdu_bytes_max> answer_;
  std::size_t answer_bytes_ = 0;
};

}  // namespace

std::unique_ptr<Link> open_tcp_link(const port::SocketAddress& address, port::Duration patience) {
  return std::make_unique<TcpLink>(address, patience);
}

}  // namespace etcm::bus
