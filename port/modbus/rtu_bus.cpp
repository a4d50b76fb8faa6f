#include "modbus/rtu_bus.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "posix/serial_port.h"

namespace etcm::port {

RtuBus::RtuBus(EventLoop& loop, Log& log, const RtuBusOptions& options)
    : loop_(loop),
      log_(log),
      options_(options),
      character_(character_time(options.line)),
      silence_(frame_silence(options.line)) {}

RtuBus::~RtuBus() {
  if (port_.is_open()) loop_.remove(port_.get());
  set_send_enable(false);
}

void RtuBus::start_read(const RegisterRead& read, Instant now) {
  std::array<std::uint8_t, rtu_frame_bytes_max> frame;
  const Request request{.unit = read.unit,
                        .function = units_[read.unit].function,
                        .range = {.first = read.first, .count = read.count},
                        .ticket = read.ticket};
  const std::size_t pdu =
      write_read_request(std::span(frame).subspan(rtu_unit_bytes), request.function, request.range);
  send(request, frame, pdu, rtu_read_answer_bytes(read.count), read.timeout, now);
}

void RtuBus::start_write(const RegisterWrite& write, Instant now) {
  std::array<std::uint8_t, rtu_frame_bytes_max> frame;
  const auto count = static_cast<std::uint16_t>(write.values.size());
  const std::size_t pdu =
      write_write_request(std::span(frame).subspan(rtu_unit_bytes), write.first, write.values);
  send({.unit = write.unit,
        .function = write_holding_registers,
        .range = {.first = write.first, .count = count},
        .ticket = write.ticket},
       frame, pdu, rtu_write_answer_bytes, write.timeout, now);
}

void RtuBus::discard_received() {
  receive();
  heard_count_ = 0;
  is_new_ = heard_wrong_ = false;
  discard_input(port_.get());
}

// The PDU stands in the frame, behind the place of the unit.
void RtuBus::send(const Request& request, std::span<std::uint8_t> frame, std::size_t pdu_bytes,
                  std::size_t answer_bytes, Duration timeout, Instant now) {
  discard_received();
  request_ = request;
  const std::size_t size = wrap_rtu(frame, request.unit, pdu_bytes);
  phase_ = Phase::waiting;
  sent_at_ = now + static_cast<std::int64_t>(size) * character_;
  deadline_ = sent_at_ + timeout + silence_ + static_cast<std::int64_t>(answer_bytes) * character_;
  set_send_enable(true);
  const ssize_t sent = ::write(port_.get(), frame.data(), size);
  if (sent != static_cast<ssize_t>(size)) {
    close(sent < 0 ? std::strerror(errno) : "it takes no bytes");
  }
}

void RtuBus::advance(Instant now) {
  if (hung_up_) close("the port is gone");
  if (phase_ == Phase::closed) {
    if (next_attempt_ <= now) open(now);
    return;
  }
  if (is_sending_ && sent_at_ <= now) stop_sending(now);
  if (std::exchange(is_new_, false)) listen(now);
  if (phase_ == Phase::waiting && deadline_ <= now) give_up(now);
  if (phase_ == Phase::silent && silent_until_ <= now) {
    phase_ = Phase::idle;
    heard_count_ = 0;
  }
}

bool RtuBus::take_answer(BusAnswer& answer) {
  if (!has_answer_) return false;
  has_answer_ = false;
  answer = answer_;
  return true;
}

Instant RtuBus::next_deadline() const {
  if (hung_up_) return Instant{};
  switch (phase_) {
    case Phase::closed:
      return next_attempt_;
    case Phase::idle:
      return never;
    case Phase::waiting:
      return is_sending_ ? std::min(sent_at_, deadline_) : deadline_;
    case Phase::silent:
      return silent_until_;
  }
  return never;
}

void RtuBus::on_ready(bool, bool) {
  if (receive()) return;
  // Nobody could wait for a port that is gone: it is ready all the time.
  hung_up_ = true;
  loop_.remove(port_.get());
}

// Takes what has arrived; false when the port is gone.
bool RtuBus::receive() {
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
    is_new_ = true;
    if (static_cast<std::size_t>(count) < space.size()) return true;
  }
}

// Looks through what has arrived since the last time.
void RtuBus::listen(Instant now) {
  while (const auto found = find_rtu_answer(std::span(heard_).first(heard_count_))) {
    if (phase_ == Phase::waiting && found->unit == request_.unit &&
        (found->pdu[0] & 0x7f) == request_.function) {
      settle(*found);
      if (phase_ != Phase::waiting) return be_silent(now + silence_, now + silence_);
    }
    const bool is_late = note_late(*found, now);
    if (is_late && phase_ == Phase::silent && found->unit == request_.unit) {
      // What the silence was for has passed.
      silent_until_ = silent_at_latest_ = now + silence_;
    }
    heard_wrong_ = heard_wrong_ || !is_late;
    std::copy(heard_.begin() + static_cast<std::ptrdiff_t>(found->end),
              heard_.begin() + static_cast<std::ptrdiff_t>(heard_count_), heard_.begin());
    heard_count_ -= found->end;
  }
  if (phase_ == Phase::waiting) return;
  // Somebody speaks: nothing is sent into that, but no babbler keeps the line for ever.
  if (phase_ == Phase::idle) {
    be_silent(now + silence_, now + static_cast<std::int64_t>(heard_.size()) * character_);
  } else {
    silent_until_ = std::clamp(now + silence_, silent_until_, silent_at_latest_);
  }
}

// Takes the answer of the unit that was asked, if it is one to what was asked.
void RtuBus::settle(const RtuAnswer& found) {
  request_.function == write_holding_registers ? settle_write(found) : settle_read(found);
}

void RtuBus::settle_read(const RtuAnswer& found) {
  std::uint8_t exception = 0;
  switch (parse_read_answer(found.pdu, request_.function,
                            std::span(registers_).first(request_.range.count), exception)) {
    case ReadAnswer::registers:
      complete(BusResult::ok);
      answer_.registers = std::span(registers_).first(request_.range.count);
      return;
    case ReadAnswer::exception:
      complete(BusResult::exception);
      answer_.exception = exception;
      // A unit that does not know the other function is asked with this one again.
      units_[request_.unit].function = read_input_registers;
      return;
    case ReadAnswer::malformed:
      return;
  }
}

void RtuBus::settle_write(const RtuAnswer& found) {
  std::uint8_t exception = 0;
  switch (parse_write_answer(found.pdu, request_.range, exception)) {
    case WriteAnswer::written:
      return complete(BusResult::ok);
    case WriteAnswer::exception:
      complete(BusResult::exception);
      answer_.exception = exception;
      return;
    case WriteAnswer::malformed:
      return;
  }
}

// Whether this is what a unit still owed. It tells how slow that unit can be.
bool RtuBus::note_late(const RtuAnswer& found, Instant now) {
  Unit& unit = units_[found.unit];
  if (!unit.owes_answer) return false;
  unit.owes_answer = false;
  unit.slowest_late = std::max(unit.slowest_late, now - unit.asked_at);
  if (!std::exchange(unit.is_reported_late, true)) {
    const auto late = std::chrono::ceil<std::chrono::milliseconds>(now - unit.asked_at).count();
    log_.write(Level::warning, "bus " + options_.name + ": unit " + std::to_string(found.unit) +
                                   " answered too late, after " + std::to_string(late) +
                                   " ms, and was not believed; give a longer `timeout`");
  }
  return true;
}

void RtuBus::give_up(Instant now) {
  Unit& unit = units_[request_.unit];
  unit.owes_answer = true;
  unit.asked_at = sent_at_;
  if (request_.function != write_holding_registers) {
    unit.function =
        request_.function == read_input_registers ? read_holding_registers : read_input_registers;
  }
  complete(heard_wrong_ || heard_count_ > 0 ? BusResult::bad_answer : BusResult::timeout);
  const Instant until = std::max(now + options_.quiet, unit.asked_at + unit.slowest_late);
  be_silent(until, until + static_cast<std::int64_t>(heard_.size()) * character_);
}

void RtuBus::complete(BusResult result) {
  has_answer_ = true;
  answer_ = {.unit = request_.unit, .ticket = request_.ticket, .result = result, .registers = {}};
  if (result == BusResult::ok) units_[request_.unit].owes_answer = false;
  phase_ = Phase::idle;
}

void RtuBus::be_silent(Instant until, Instant at_latest) {
  phase_ = Phase::silent;
  silent_until_ = until;
  silent_at_latest_ = std::max(until, at_latest);
}

// The transceiver must listen before the unit answers, and not before the request is out.
void RtuBus::stop_sending(Instant now) {
  if (is_sent(port_.get())) {
    set_send_enable(false);
  } else {
    sent_at_ = now + character_;
  }
}

void RtuBus::set_send_enable(bool active) {
  if (!options_.send_enable) return;
  options_.lines->set_active(*options_.send_enable, active);
  is_sending_ = active;
}

void RtuBus::open(Instant now) {
  next_attempt_ = now + options_.reopen_interval;
  std::string why;
  port_ = open_serial(options_.line, why);
  if (!port_.is_open()) return close(why);
  loop_.add(port_.get(), *this, true, false);
  reported_closed_ = false;
  heard_count_ = 0;
  log_.write(Level::info, "bus " + options_.name + ": opened " + options_.line.path);
  be_silent(now + silence_, now + silence_);
}

void RtuBus::close(const std::string& why) {
  if (port_.is_open() && !hung_up_) loop_.remove(port_.get());
  port_.close();
  hung_up_ = false;
  set_send_enable(false);
  if (phase_ == Phase::waiting) complete(BusResult::link_lost);
  phase_ = Phase::closed;
  if (std::exchange(reported_closed_, true)) return;
  log_.write(Level::warning,
             "bus " + options_.name + ": " + options_.line.path + ": " + why + "; trying again");
}

}  // namespace etcm::port
