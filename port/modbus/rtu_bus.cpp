#include "modbus/rtu_bus.h"

#include <algorithm>
#include <utility>

namespace etcm::port {

RtuBus::RtuBus(EventLoop& loop, Log& log, const RtuBusOptions& options)
    : log_(log),
      options_(options),
      character_(character_time(options.line)),
      silence_(frame_silence(options.line)),
      line_(loop, options.line) {}

RtuBus::~RtuBus() { set_send_enable(false); }

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

// The PDU stands in the frame, behind the place of the unit.
void RtuBus::send(const Request& request, std::span<std::uint8_t> frame, std::size_t pdu_bytes,
                  std::size_t answer_bytes, Duration timeout, Instant now) {
  line_.discard();
  heard_wrong_ = false;
  request_ = request;
  const std::size_t size = rtu_unit_bytes + pdu_bytes + rtu_checksum_bytes;
  phase_ = Phase::waiting;
  sent_at_ = now + static_cast<std::int64_t>(size) * character_;
  deadline_ = sent_at_ + timeout + silence_ + static_cast<std::int64_t>(answer_bytes) * character_;
  set_send_enable(true);
  std::string why;
  if (!line_.send(frame, request.unit, pdu_bytes, why)) close(why);
}

void RtuBus::advance(Instant now) {
  if (line_.is_gone()) close("the port is gone");
  if (phase_ == Phase::closed) {
    if (next_attempt_ <= now) open(now);
    return;
  }
  if (is_sending_ && sent_at_ <= now) stop_sending(now);
  if (line_.take_news()) listen(now);
  if (phase_ == Phase::waiting && deadline_ <= now) give_up(now);
  if (phase_ == Phase::silent && silent_until_ <= now) {
    phase_ = Phase::idle;
    line_.forget();
  }
}

bool RtuBus::take_answer(BusAnswer& answer) {
  if (!has_answer_) return false;
  has_answer_ = false;
  answer = answer_;
  return true;
}

Instant RtuBus::next_deadline() const {
  if (line_.is_gone()) return Instant{};
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

// Looks through what has arrived since the last time.
void RtuBus::listen(Instant now) {
  while (const auto found = line_.next_answer()) {
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
    line_.drop(*found);
  }
  if (phase_ == Phase::waiting) return;
  // Somebody speaks: nothing is sent into that, but no babbler keeps the line for ever.
  if (phase_ == Phase::idle) {
    be_silent(now + silence_, now + babble_max());
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
  unit.lateness = std::max(unit.lateness, now - unit.asked_at);
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
  complete(heard_wrong_ || line_.has_heard() ? BusResult::bad_answer : BusResult::timeout);
  const Instant until = std::max(now + options_.quiet,
                                 std::min(now + late_silence_max, unit.asked_at + unit.lateness));
  // Half of it the next time, unless a late answer comes again.
  unit.lateness = (until - unit.asked_at) / 2;
  answer_.silence = until - now;
  be_silent(until, until + babble_max());
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
  if (line_.is_sent()) {
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
  if (!line_.open(why)) return close(why);
  reported_closed_ = false;
  log_.write(Level::info, "bus " + options_.name + ": opened " + options_.line.path);
  be_silent(now + silence_, now + silence_);
}

void RtuBus::close(const std::string& why) {
  line_.close();
  set_send_enable(false);
  if (phase_ == Phase::waiting) complete(BusResult::link_lost);
  phase_ = Phase::closed;
  if (std::exchange(reported_closed_, true)) return;
  log_.write(Level::warning,
             "bus " + options_.name + ": " + options_.line.path + ": " + why + "; trying again");
}

}  // namespace etcm::port
