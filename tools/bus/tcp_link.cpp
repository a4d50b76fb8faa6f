// Modbus TCP: each question has a number, so an answer is never taken for another's.
#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "link.h"
#include "modbus/tcp_connection.h"

namespace etcm::bus {

namespace {

class TcpLink final : public Link, private port::FrameConnection::Listener {
 public:
  TcpLink(const port::Endpoint& end, Frames frames) : display_(frames), name_(to_string(end)) {
    // The first answer of a converter that sleeps, or whose address nobody knows yet, takes longer.
    connection_.connect(end, waiter_.now(), port::TcpConnector::connect_time_max);
    while (connection_.state() != State::up) {
      connection_.advance(waiter_.now());
      if (lost_) fail();
      waiter_.wait_until(connection_.next_deadline());
    }
  }

  Reply ask(std::uint8_t unit, std::span<const std::uint8_t> request,
            port::Duration timeout) override {
    answer_bytes_ = 0;
    is_answered_ = false;
    connection_.discard();
    throw_if_lost();
    std::array<std::uint8_t, port::frame_bytes_max> frame;
    std::copy(request.begin(), request.end(), frame.begin() + port::mbap_header_bytes);
    connection_.send(frame, ++transaction_, unit, request.size());
    display_.sent(std::span(frame).first(port::mbap_header_bytes + request.size()));
    const port::Instant sent_at = waiter_.now();
    while (!is_answered_) {
      throw_if_lost();
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
      throw_if_lost();
    }
  }

 private:
  using State = port::FrameConnection::State;

  [[noreturn]] void fail() const {
    const bool has_cure = lost_->find(';') != std::string::npos;
    throw LinkError(
        name_ + ": " + *lost_ +
        (has_cure ? ""
                  : "; check address and port (-p), and that the device takes one more master"));
  }

  void throw_if_lost() const {
    if (!lost_) return;
    throw LinkError(name_ + ": " + *lost_ +
                    "; most devices take few masters at a time: end the others, and try again");
  }

  void on_connected() override {}
  void on_lost(const char* why) override { lost_ = why; }
  void on_frame(const port::Frame& frame) override {
    std::array<std::uint8_t, port::frame_bytes_max> whole;
    std::copy(frame.pdu.begin(), frame.pdu.end(), whole.begin() + port::mbap_header_bytes);
    display_.heard(std::span(whole).first(
        port::write_header(whole, frame.transaction, frame.address, frame.pdu.size())));
    if (frame.transaction != transaction_ || is_answered_) return;
    is_answered_ = true;
    answer_unit_ = frame.address;
    answer_bytes_ = frame.pdu.size();
    std::copy(frame.pdu.begin(), frame.pdu.end(), answer_.begin());
  }

  FrameDisplay display_;
  std::string name_;
  Waiter waiter_;
  port::TcpConnection connection_{waiter_.loop(), *this};
  std::optional<std::string> lost_;  // why, where it is
  std::uint16_t transaction_ = 0;
  bool is_answered_ = false;
  std::uint8_t answer_unit_ = 0;
  std::array<std::uint8_t, port::pdu_bytes_max> answer_;
  std::size_t answer_bytes_ = 0;
};

}  // namespace

std::unique_ptr<Link> open_tcp_link(const port::Endpoint& end, Frames frames) {
  return std::make_unique<TcpLink>(end, frames);
}

}  // namespace etcm::bus
