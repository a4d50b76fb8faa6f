// Modbus RTU. What is said in rtu_bus.h about late answers holds here too: where possible it asks
// in another way (may_ask), else it is waited until the earlier answer can come no more.
#include <algorithm>
#include <array>

#include "link.h"
#include "modbus/owed_answers.h"
#include "modbus/rtu_serial_line.h"

namespace etcm::bus {

namespace {

using namespace std::chrono_literals;

// Adapters on USB hand over what they received in pieces, up to 16 ms apart.
constexpr port::Duration pieces_apart = 20ms;
// After a wait in vain: a late answer has begun by then, or is far too late.
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

bool is_read(const port::RtuQuestion& question) {
  return question.function >= port::read_coils && question.function <= port::read_input_registers;
}

// Of reads an answer of another length is another's.
bool may_answer(std::span<const std::uint8_t> pdu, const port::RtuQuestion& question) {
  return (pdu[0] & 0x7f) == question.function &&
         (!is_read(question) || (pdu[0] & port::exception_bit) != 0 ||
          pdu.size() == port::answer_bytes(question));
}

class SerialLink final : public Link {
 public:
  SerialLink(const port::SerialLine& line, Frames frames)
      : display_(frames),
        path_(line.path),
        name_(line.path + " at " + std::to_string(line.baud) + " baud, " + to_string(line.parity) +
              " parity"),
        character_(character_time(line)),
        silence_(frame_silence(line)),
        line_(waiter_.loop(), line) {
    std::string why;
    if (!line_.open(waiter_.now(), why)) throw LinkError(line.path + ": " + why);
  }

  bool may_ask(std::uint8_t unit, std::span<const std::uint8_t> request) const override {
    return owed_[unit].free_at(port::question_of(request)) <= waiter_.now();
  }

  Reply ask(std::uint8_t unit, std::span<const std::uint8_t> request,
            port::Duration timeout) override {
    const port::RtuQuestion question = port::question_of(request);
    port::OwedAnswers& owed = owed_[unit];
    while (!may_ask(unit, request)) {
      listen(owed.free_at(question));
      take_late();
    }
    wait_for_silence();
    take_late();
    line_.discard();
    owed.forget(question);
    const port::Instant sent_at = send(unit, request);
    const port::Instant unanswered_at = sent_at + timeout;
    const port::Instant at_latest =
        unanswered_at + static_cast<std::int64_t>(port::rtu_frame_bytes_max) * character_;
    bool has_heard = false;
    while (true) {
      while (const auto found = line_.next_answer()) {
        display_.heard(line_.heard().first(found->end));
        if (found->address == unit && may_answer(found->pdu, question)) {
          silent_until_ = last_heard_ + silence_;
          const bool is_exception = (found->pdu[0] & port::exception_bit) != 0;
          if (is_exception && owed.owed_until(question.function) > waiter_.now()) {
            // It may be for the earlier question.
            owed.add(question, sent_at, waiter_.now() + port::late_answer_max);
          }
          return {.outcome = Outcome::answer,
                  .pdu = found->pdu,
                  .took = std::max(last_heard_ - sent_at, port::Duration{})};
        }
        static_cast<void>(owed_[found->address].take(found->pdu, waiter_.now()));
        line_.drop(*found);
      }
      const port::Instant until =
          has_heard ? std::clamp(last_heard_ + silence_ + pieces_apart, unanswered_at, at_latest)
                    : unanswered_at;
      if (until <= waiter_.now()) break;
      has_heard = listen(until) || has_heard;
    }
    display_.heard(line_.heard());
    silent_until_ = waiter_.now() + quiet;
    // A broadcast is not answered.
    if (unit != 0) owed.add(question, sent_at, waiter_.now() + port::late_answer_max);
    return {.outcome = has_heard ? Outcome::garbled : Outcome::silence, .pdu = {}};
  }

  const std::string& name() const override { return name_; }

  const char* advice() const override {
    return "try A and B exchanged, another speed (-b 9600), another parity (-P none), and look at "
           "the units' supply";
  }

  void pause(port::Duration duration) override {
    const port::Instant end = waiter_.now() + duration;
    while (waiter_.now() < end) listen(end);
  }

 private:
  // Notes what comes that was not waited for.
  void take_late() {
    while (const auto found = line_.next_answer()) {
      static_cast<void>(owed_[found->address].take(found->pdu, waiter_.now()));
      line_.drop(*found);
    }
  }

  // A line that is never quiet is used nevertheless, after a while.
  void wait_for_silence() {
    const port::Instant at_latest = waiter_.now() + 10 * quiet;
    while (true) {
      const port::Instant until =
          std::min(at_latest, std::max(silent_until_, last_heard_ + silence_));
      if (until <= waiter_.now()) return;
      listen(until);
    }
  }

  port::Instant send(std::uint8_t unit, std::span<const std::uint8_t> request) {
    std::array<std::uint8_t, port::rtu_frame_bytes_max> frame;
    std::copy(request.begin(), request.end(), frame.begin() + port::rtu_unit_bytes);
    std::string why;
    if (!line_.send(frame, unit, request.size(), why)) {
      throw LinkError(path_ + ": " + why + "; plug the adapter in again");
    }
    const std::size_t size = port::rtu_unit_bytes + request.size() + port::rtu_checksum_bytes;
    display_.sent(std::span(frame).first(size));
    return waiter_.now() + static_cast<std::int64_t>(size) * character_;
  }

  // At most until then; whether something came.
  bool listen(port::Instant until) {
    waiter_.wait_until(until);
    if (line_.why_gone() != nullptr)
      throw LinkError(path_ + ": the port is gone; plug the adapter in again");
    if (!line_.take_news()) return false;
    last_heard_ = waiter_.now();
    return true;
  }

  FrameDisplay display_;
  std::string path_;
  std::string name_;
  port::Duration character_;
  port::Duration silence_;
  Waiter waiter_;
  port::RtuSerialLine line_;
  port::Instant silent_until_{};
  port::Instant last_heard_{};
  std::array<port::OwedAnswers, 256> owed_{};
};

}  // namespace

std::unique_ptr<Link> open_serial_link(const port::SerialLine& line, Frames frames) {
  return std::make_unique<SerialLink>(line, frames);
}

}  // namespace etcm::bus
