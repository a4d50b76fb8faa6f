#include "modbus/rtu_bus.h"

#include <algorithm>
#include <utility>

namespace etcm::port {

RtuBus::RtuBus(EventLoop& loop, Log& log, const RtuBusOptions& options)
    : log_(log),
      options_(options),
      character_(character_time(options.serial_line)),
      silence_(frame_silence(options.serial_line)),
      serial_line_(std::in_place, loop, options.serial_line),
      line_(*serial_line_) {}

RtuBus::RtuBus(RtuLine& line, Log& log, const RtuBusOptions& options)
    : log_(log),
      options_(options),
      character_(options.address.empty() ? character_time(options.serial_line) : Duration{}),
      silence_(options.address.empty() ? frame_silence(options.serial_line) : Duration{}),
      line_(line) {}

RtuBus::~RtuBus() { set_send_enable(false); }

RtuBus::Ways RtuBus::ways_of(const RegisterRead& read) const {
  const auto may_ask = [&](std::uint8_t function) {
    const bool is_holding = function == read_holding_registers;
    switch (read.kind) {
      case RegisterKind::input_or_holding:
        return !is_holding || !units_[read.address].has_no_holding;
      case RegisterKind::input:
        return !is_holding;
      case RegisterKind::holding:
        return is_holding;
    }
    return false;
  };
  Ways found;
  for (std::uint16_t left_out = 0; left_out <= read.spare && left_out < read.count; ++left_out) {
    const RegisterRange range{.first = static_cast<std::uint16_t>(read.first + left_out),
                              .count = static_cast<std::uint16_t>(read.count - left_out)};
    for (const std::uint8_t function : {read_input_registers, read_holding_registers}) {
      if (!may_ask(function)) continue;
      if (found.count == Ways::count_max) return found;
      found.ways[found.count++] = {.function = function, .range = range};
    }
  }
  return found;
}

// Whole ones first; of these one that no answer could come to, however late, or the one asked
// longest ago.
std::optional<RtuQuestion> RtuBus::best_way(const RegisterRead& read, Instant now) const {
  const OwedAnswers& owed = units_[read.address].owed;
  const Ways all = ways_of(read);
  std::optional<RtuQuestion> best;
  const auto rank = [&](const RtuQuestion& way) {
    return std::pair(way.range.count != read.count, owed.asked_at(way).value_or(Instant{}));
  };
  for (const RtuQuestion& way : std::span(all.ways).first(all.count)) {
    if (owed.free_at(way) > now) continue;
    if (!best || rank(way) < rank(*best)) best = way;
  }
  return best;
}

Instant RtuBus::read_free_at(const RegisterRead& read, Instant now) const {
  const OwedAnswers& owed = units_[read.address].owed;
  const Ways all = ways_of(read);
  const Duration apart = latest_of(units_[read.address]) / static_cast<std::int64_t>(all.count);
  std::size_t owed_count = 0;
  Instant asked_last{}, free_first = never;
  for (const RtuQuestion& way : std::span(all.ways).first(all.count)) {
    const Instant free_at = owed.free_at(way);
    free_first = std::min(free_first, free_at);
    if (free_at <= now) continue;
    ++owed_count;
    asked_last = std::max(asked_last, owed.asked_at(way).value_or(Instant{}));
  }
  if (2 * owed_count < all.count) return {};
  // The others in turn until those are free again.
  return std::max(free_first, asked_last + apart);
}

void RtuBus::start_read(const RegisterRead& read, Instant now) {
  Request request{.address = read.address, .question = {}, .ticket = read.ticket};
  const std::optional<RtuQuestion> way = best_way(read, now);
  if (!way) return refuse(request);
  request.question = *way;
  request.left_out = static_cast<std::uint16_t>(read.count - way->range.count);
  std::array<std::uint8_t, rtu_frame_bytes_max> frame;
  const std::size_t pdu =
      write_read_request(std::span(frame).subspan(rtu_unit_bytes), way->function, way->range);
  send(request, frame, pdu, rtu_read_answer_bytes(way->range.count), read.timeout, now);
}

void RtuBus::start_write(const RegisterWrite& write, Instant now) {
  const auto count = static_cast<std::uint16_t>(write.values.size());
  const Request request{.address = write.address,
                        .question = {.function = write_holding_registers,
                                     .range = {.first = write.first, .count = count}},
                        .ticket = write.ticket};
  if (units_[write.address].owed.free_at(request.question) > now) return refuse(request);
  std::array<std::uint8_t, rtu_frame_bytes_max> frame;
  const std::size_t pdu =
      write_write_request(std::span(frame).subspan(rtu_unit_bytes), write.first, write.values);
  send(request, frame, pdu, rtu_write_answer_bytes, write.timeout, now);
}

Instant RtuBus::request_free_at(const UnitRequest& request, Instant now) const {
  const UnitState& unit = units_[request.address];
  const RtuQuestion question = question_of(request.pdu);
  Instant room_at = never;
  Instant again_at{};
  for (const ClientMiss& miss : unit.client_misses) {
    room_at = std::min(room_at, miss.owed_until);
    if (now < miss.again_at && are_answered_alike(miss.question, question)) {
      again_at = std::max(again_at, miss.again_at);
    }
  }
  return std::max({unit.owed.free_at(question), room_at, again_at});
}

void RtuBus::start_request(const UnitRequest& wanted, Instant now) {
  const Request request{.address = wanted.address,
                        .question = question_of(wanted.pdu),
                        .ticket = wanted.ticket,
                        .is_of_client = true};
  if (request_free_at(wanted, now) > now) return refuse(request);
  std::array<std::uint8_t, rtu_frame_bytes_max> frame;
  std::copy(wanted.pdu.begin(), wanted.pdu.end(), frame.begin() + rtu_unit_bytes);
  send(request, frame, wanted.pdu.size(),
       rtu_unit_bytes + answer_bytes(request.question) + rtu_checksum_bytes, wanted.timeout, now);
}

// What would be answered like something that is still owed is not sent.
void RtuBus::refuse(const Request& request) {
  request_ = request;
  complete(BusResult::timeout);
}

// The PDU stands in the frame, behind the place of the unit.
void RtuBus::send(const Request& request, std::span<std::uint8_t> frame, std::size_t pdu_bytes,
                  std::size_t answer_bytes, Duration timeout, Instant now) {
  line_.discard();
  heard_wrong_ = false;
  request_ = request;
  units_[request.address].owed.forget(request.question);
  const std::size_t size = rtu_unit_bytes + pdu_bytes + rtu_checksum_bytes;
  phase_ = Phase::waiting;
  sent_at_ = now + static_cast<std::int64_t>(size) * character_;
  deadline_ = sent_at_ + timeout + silence_ + static_cast<std::int64_t>(answer_bytes) * character_;
  set_send_enable(true);
  std::string why;
  if (!line_.send(frame, request.address, pdu_bytes, why)) close(why, now);
}

void RtuBus::advance(Instant now) {
  if (phase_ == Phase::opening) line_.advance(now);
  if (const char* const why = line_.why_gone()) close(why, now);
  if (phase_ == Phase::closed) {
    if (next_attempt_ <= now) open(now);
    return;
  }
  if (phase_ == Phase::opening) {
    if (line_.is_ready()) become_open(now);
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
  if (line_.why_gone() != nullptr) return Instant{};
  switch (phase_) {
    case Phase::closed:
      return next_attempt_;
    case Phase::opening:
      return line_.is_ready() ? Instant{} : line_.next_deadline();
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
    if (phase_ == Phase::waiting && found->address == request_.address &&
        (found->pdu[0] & 0x7f) == request_.question.function) {
      settle(*found, now);
      if (phase_ != Phase::waiting) {
        line_.drop(*found);
        continue;
      }
      if ((found->pdu[0] & exception_bit) != 0) {
        // An earlier question's or this one's: neither is settled by it.
        heard_wrong_ = true;
        line_.drop(*found);
        continue;
      }
    }
    if (phase_ == Phase::waiting && is_within_answer(*found)) return;
    const bool is_late = note_late(*found, now);
    if (!is_late) note_unasked(*found, now);
    if (is_late && phase_ == Phase::silent && found->address == request_.address) {
      // What the silence was for has passed.
      silent_until_ = silent_at_latest_ = now + silence_;
    }
    heard_wrong_ = heard_wrong_ || !is_late;
    line_.drop(*found);
  }
  if (phase_ == Phase::waiting) return;
  // The line is busy: nothing is sent into that, but a jabbering unit does not keep it for ever.
  // The rest of an answer is waited for, or it would not be known of.
  const Instant until = now + (line_.has_heard() ? std::max(silence_, piece_gap_max) : silence_);
  if (phase_ == Phase::idle) {
    be_silent(until, now + babble_max());
  } else {
    silent_until_ = std::clamp(until, silent_until_, silent_at_latest_);
  }
}

// Whether the answer to the question has begun before this frame and is still to come: what it
// tells may look like a whole frame, and stands there alone while the bytes come piece by piece.
// Taken out it would spoil that answer, and each one for as long as the unit tells the same.
bool RtuBus::is_within_answer(const RtuAnswer& found) const {
  const std::size_t pdu_bytes = answer_bytes(request_.question);
  const std::size_t size = rtu_unit_bytes + pdu_bytes + rtu_checksum_bytes;
  const std::span<const std::uint8_t> heard = line_.heard();
  const std::size_t begin_of_frame =
      found.end - (rtu_unit_bytes + found.pdu.size() + rtu_checksum_bytes);
  for (std::size_t begin = 0; begin < begin_of_frame; ++begin) {
    const std::span<const std::uint8_t> rest = heard.subspan(begin);
    const bool is_begun = rest[0] == request_.address && rest[1] == request_.question.function &&
                          rest[2] + 2u == pdu_bytes;
    if (is_begun && rest.size() < size) return true;
  }
  return false;
}

// Takes the answer of the unit that was asked, if it is one to what was asked.
void RtuBus::settle(const RtuAnswer& found, Instant now) {
  if (request_.is_of_client) return settle_for_client(found, now);
  const bool is_write = request_.question.function == write_holding_registers;
  const std::size_t count = is_write ? 0 : request_.question.range.count;
  std::uint8_t exception = 0;
  if (is_write) {
    const WriteAnswer said = parse_write_answer(found.pdu, request_.question.range, exception);
    if (said == WriteAnswer::malformed) return;
    if (said == WriteAnswer::exception) return settle_exception(exception, now);
  } else {
    const ReadAnswer said = parse_read_answer(found.pdu, request_.question.function,
                                              std::span(registers_).first(count), exception);
    if (said == ReadAnswer::malformed) return;
    if (said == ReadAnswer::exception) return settle_exception(exception, now);
  }
  note_answered(now);
  complete(BusResult::ok);
  answer_.left_out = request_.left_out;
  answer_.registers = std::span(registers_).first(count);
}

void RtuBus::settle_for_client(const RtuAnswer& found, Instant now) {
  const bool is_exception = (found.pdu[0] & exception_bit) != 0;
  const OwedAnswers& owed = units_[request_.address].owed;
  if (is_exception ? owed.owed_until(request_.question.function) > now
                   : !answers(found.pdu, request_.question)) {
    return;
  }
  if (!is_exception) note_answered(now);
  complete(is_exception ? BusResult::exception : BusResult::ok);
  if (is_exception) answer_.exception = found.pdu[1];
  std::copy(found.pdu.begin(), found.pdu.end(), pdu_.begin());
  answer_.pdu = std::span(pdu_).first(found.pdu.size());
}

// It may be for an earlier question with this function: then the answer to this one is to come.
void RtuBus::settle_exception(std::uint8_t exception, Instant now) {
  UnitState& unit = units_[request_.address];
  const bool is_refusal = exception == illegal_function || exception == illegal_data_address;
  if (unit.owed.owed_until(request_.question.function) > now) {
    owe(now);
  } else if (is_refusal && request_.question.function == read_holding_registers) {
    unit.has_no_holding = true;
  }
  complete(BusResult::exception);
  answer_.exception = exception;
}

// Whether this is what a unit still owed. It tells how slow that unit can be.
bool RtuBus::note_late(const RtuAnswer& found, Instant now) {
  UnitState& unit = units_[found.address];
  const std::optional<Instant> asked_at = unit.owed.take(found.pdu, now);
  if (!asked_at) return false;
  const Duration lateness = now - *asked_at;
  unit.latest = std::max(unit.latest, lateness);
  unit.lateness = std::max(unit.lateness, lateness);
  report_late(found.address, lateness, now);
  return true;
}

// The other answer to it, where two answer at the unit, must not become the next question's.
void RtuBus::note_answered(Instant now) {
  const std::uint8_t function = request_.question.function;
  if (function != read_holding_registers && function != read_input_registers) return;
  UnitState& unit = units_[request_.address];
  unit.owed.note_answered(request_.question, sent_at_, now, latest_of(unit));
}

// Two answer at this unit, or somebody else asks it: a question was answered, and its other answer
// is still to come, which must not become the next question's.
void RtuBus::note_unasked(const RtuAnswer& found, Instant now) {
  const std::uint8_t function = found.pdu[0];
  if (now < clear_at_) return;
  if (function != read_holding_registers && function != read_input_registers) return;
  UnitState& unit = units_[found.address];
  const auto count = static_cast<std::uint16_t>(found.pdu[1] / 2);
  const RtuQuestion question{.function = function, .range = {.first = 0, .count = count}};
  const bool is_under_way = phase_ == Phase::waiting && found.address == request_.address &&
                            are_answered_alike(question, request_.question);
  if (!is_under_way) unit.owed.add_unasked(question, now, latest_of(unit));
}

void RtuBus::report_late(std::uint8_t number, Duration lateness, Instant now) {
  const std::optional<Duration> timeout = units_[number].advice.advise(lateness, now);
  if (!timeout) return;
  const auto late = std::chrono::ceil<std::chrono::milliseconds>(lateness).count();
  const auto advised = std::chrono::ceil<std::chrono::milliseconds>(*timeout).count();
  const std::string address = std::to_string(number);
  log_.write(Level::warning,
             "bus " + options_.name + ": unit " + address + " answered too late, after " +
                 std::to_string(late) +
                 " ms, and was not believed; give it a longer timeout: [[bus.device]] with units = "
                 "\"" +
                 address + "\" and timeout = \"" + std::to_string(advised) + "ms\"");
}

// The answer to the request may come after the wait for it.
void RtuBus::owe(Instant now) {
  UnitState& unit = units_[request_.address];
  const Instant until = now + latest_of(unit);
  unit.owed.add(request_.question, sent_at_, until);
  if (!request_.is_of_client) return;
  *std::min_element(
      unit.client_misses.begin(), unit.client_misses.end(),
      [](const ClientMiss& a, const ClientMiss& b) { return a.owed_until < b.owed_until; }) = {
      .question = request_.question, .owed_until = until, .again_at = until + (until - now)};
}

void RtuBus::give_up(Instant now) {
  owe(now);
  complete(heard_wrong_ || line_.has_heard() ? BusResult::bad_answer : BusResult::timeout);
  UnitState& unit = units_[request_.address];
  const Instant until =
      std::max(now + options_.quiet, std::min(now + late_silence_max, sent_at_ + unit.lateness));
  // Half of it the next time, unless a late answer comes again.
  unit.lateness = (until - sent_at_) / 2;
  answer_.silence = until - now;
  be_silent(until, until + babble_max());
}

void RtuBus::complete(BusResult result) {
  has_answer_ = true;
  answer_ = {
      .address = request_.address, .ticket = request_.ticket, .result = result, .registers = {}};
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
  if (!line_.open(now, why)) return close(why, now);
  if (line_.is_ready()) return become_open(now);
  phase_ = Phase::opening;
}

void RtuBus::become_open(Instant now) {
  reported_closed_ = false;
  why_down_.clear();
  std::string line = "bus " + options_.name + ": opened " + place();
  if (clear_at_ == never) {
    const Duration clearing = options_.clearing + delay_max();
    clear_at_ = options_.clearing > Duration{} ? now + clearing : now;
    if (clear_at_ > now) {
      line += "; asks nothing for " +
              std::to_string(std::chrono::ceil<std::chrono::seconds>(clearing).count()) +
              " s, in which answers to an earlier run may come";
    }
  }
  log_.write(Level::info, line);
  const Instant until = std::max(clear_at_, now + silence_);
  be_silent(until, until);
}

void RtuBus::close(const std::string& why, Instant now) {
  line_.close();
  set_send_enable(false);
  if (phase_ == Phase::waiting) {
    owe(now);
    complete(BusResult::link_lost);
  }
  phase_ = Phase::closed;
  why_down_ = place() + ": " + why;
  if (std::exchange(reported_closed_, true)) return;
  log_.write(Level::warning, "bus " + options_.name + ": " + why_down_ + "; trying again");
}

}  // namespace etcm::port
