// Modbus RTU. What is said in rtu_bus.h about late answers holds here too; with one question at a
// time and a person who waits, a longer silence after a wait in vain is cheap.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "link.h"
#include "modbus/rtu_frame.h"
#include "posix/serial_port.h"

namespace etcm::bus {

namespace {

using namespace std::chrono_literals;

// Adapters on USB hand over what they received in pieces, up to 16 ms apart.
constexpr port::Duration pieces_apart = 20ms;
// After a wait in vain: whoever answers late has begun by then, or is far too late.
constexpr port::Duration quiet = 50ms;

const char* to_string(port::Parity parity) {
  switch (parity) {
    case port::Parity::none:
      return "no";
    case port::Parity::even:
      return "even";
    case port::Parity::odd:
      return "odd";
  }
  return "";
}

class SerialLink final : public Link, private port::EventHandler {
 public:
  explicit SerialLink(const port::SerialLine& line)
      : path_(line.path),
        name_(line.path + " at " + std::to_string(line.baud) + " baud, " + to_string(line.parity) +
              " parity"),
        character_(character_time(line)),
        silence_(frame_silence(line)) {
    std::string why;
    port_ = port::open_serial(line, why);
    if (!port_.is_open()) throw LinkError(line.path + ": " + why);
    waiter_.loop().add(port_.get(), *this, true, false);
  }
  ~SerialLink() override {
    if (!is_gone_) waiter_.loop().remove(port_.get());
  }
  SerialLink(const SerialLink&) = delete;
  SerialLink& operator=(const SerialLink&) = delete;

  Reply ask(std::uint8_t unit, std::span<const std::uint8_t> request,
            port::Duration timeout) override {
    wait_for_silence();
    heard_count_ = 0;
    port::discard_input(port_.get());
    const port::Instant sent_at = send(unit, request);
    const port::Instant unanswered_at = sent_at + timeout;
    const port::Instant at_latest =
        unanswered_at + static_cast<std::int64_t>(port::rtu_frame_bytes_max) * character_;
    while (true) {
      if (const auto found = answer_of(unit, request[0])) {
        silent_until_ = last_heard_ + silence_;
        return {.outcome = Outcome::answer, .pdu = *found, .took = last_heard_ - sent_at};
      }
      const port::Instant until =
          heard_count_ == 0
              ? unanswered_at
              : std::clamp(last_heard_ + silence_ + pieces_apart, unanswered_at, at_latest);
      if (until <= waiter_.now()) break;
      waiter_.wait_until(until);
      throw_if_gone();
    }
    silent_until_ = waiter_.now() + quiet;
    return {.outcome = heard_count_ == 0 ? Outcome::silence : Outcome::garbled, .pdu = {}};
  }

  const std::string& name() const override { return name_; }

  const char* advice() const override {
    return "try A and B exchanged, another speed (-b 9600), another parity (-P none), and look at "
           "the units' supply";
  }

  void pause(port::Duration duration) override {
    const port::Instant end = waiter_.now() + duration;
    while (waiter_.now() < end) {
      waiter_.wait_until(end);
      throw_if_gone();
    }
  }

 private:
  // A line on which somebody always speaks is asked nevertheless, after a while.
  void wait_for_silence() {
    const port::Instant at_latest = waiter_.now() + 10 * quiet;
    while (true) {
      throw_if_gone();
      const port::Instant until =
          std::min(at_latest, std::max(silent_until_, last_heard_ + silence_));
      if (until <= waiter_.now()) return;
      waiter_.wait_until(until);
    }
  }

  port::Instant send(std::uint8_t unit, std::span<const std::uint8_t> request) {
    std::array<std::uint8_t, port::rtu_frame_bytes_max> frame;
    std::copy(request.begin(), request.end(), frame.begin() + port::rtu_unit_bytes);
    const std::size_t size = port::wrap_rtu(frame, unit, request.size());
    const ssize_t sent = ::write(port_.get(), frame.data(), size);
    if (sent != static_cast<ssize_t>(size)) {
      throw LinkError(path_ + ": " + (sent < 0 ? std::strerror(errno) : "takes no bytes") +
                      "; plug the adapter in again");
    }
    return waiter_.now() + static_cast<std::int64_t>(size) * character_;
  }

  // The first whole answer of this unit to this function in what was heard.
  std::optional<std::span<const std::uint8_t>> answer_of(std::uint8_t unit,
                                                         std::uint8_t function) const {
    const auto heard = std::span(heard_).first(heard_count_);
    for (auto found = port::find_rtu_answer(heard); found;
         found = port::find_rtu_answer(heard, found->end)) {
      if (found->unit == unit && (found->pdu[0] & 0x7f) == function) return found->pdu;
    }
    return std::nullopt;
  }

  void on_ready(bool, bool) override {
    const auto space = std::span(heard_).subspan(heard_count_);
    // When it is full of noise, what comes more is of no use.
    std::array<std::uint8_t, 64> spilled;
    const ssize_t count = space.empty() ? ::read(port_.get(), spilled.data(), spilled.size())
                                        : ::read(port_.get(), space.data(), space.size());
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (count <= 0) {
      is_gone_ = true;
      waiter_.loop().remove(port_.get());
      return;
    }
    last_heard_ = waiter_.now();
    if (!space.empty()) heard_count_ += static_cast<std::size_t>(count);
  }

  void throw_if_gone() const {
    if (is_gone_) throw LinkError(path_ + ": the port is gone; plug the adapter in again");
  }

  std::string path_;
  std::string name_;
  port::Duration character_;
  port::Duration silence_;
  Waiter waiter_;
  port::FileDescriptor port_;
  bool is_gone_ = false;
  port::Instant silent_until_{};
  port::Instant last_heard_{};
  std::array<std::uint8_t, 2 * port::rtu_frame_bytes_max> heard_;
  std::size_t heard_count_ = 0;
};

}  // namespace

std::unique_ptr<Link> open_serial_link(const port::SerialLine& line) {
  return std::make_unique<SerialLink>(line);
}

}  // namespace etcm::bus
