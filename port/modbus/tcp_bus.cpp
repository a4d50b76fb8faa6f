#include "modbus/tcp_bus.h"

#include <algorithm>
#include <utility>

#include "modbus/question.h"

namespace etcm::port {

namespace {

constexpr std::int64_t timeouts_of_silence = 3;
// The first number is that of the time, so it differs with each start.
constexpr Duration transaction_step = std::chrono::milliseconds(1);

}  // namespace

TcpBus::TcpBus(EventLoop& loop, Log& log, const TcpBusOptions& options)
    : log_(log),
      options_(options),
      tcp_connection_(std::in_place, loop),
      connection_(*tcp_connection_),
      queue_(options.outstanding_max),
      completed_(options.outstanding_max) {
  connection_.report_to(*this);
}

TcpBus::TcpBus(FrameConnection& connection, Log& log, const TcpBusOptions& options)
    : log_(log),
      options_(options),
      connection_(connection),
      queue_(options.outstanding_max),
      completed_(options.outstanding_max) {
  connection_.report_to(*this);
}

bool TcpBus::ready() const {
  return connection_.state() == FrameConnection::State::up && !is_silent_ && queue_.has_room() &&
         queue_.waiting_count() + completed_count_ < options_.outstanding_max;
}

void TcpBus::start_read(const RegisterRead& read, Instant now) {
  std::array<std::uint8_t, frame_bytes_max> frame;
  const RegisterRange range{.first = read.first, .count = read.count};
  const std::uint8_t function =
      read.kind == RegisterKind::holding ? read_holding_registers : read_input_registers;
  const std::size_t pdu =
      write_read_request(std::span(frame).subspan(mbap_header_bytes), function, range);
  send({.address = read.address,
        .function = function,
        .range = range,
        .ticket = read.ticket,
        .timeout = read.timeout},
       frame, pdu, now);
}

void TcpBus::start_write(const RegisterWrite& write, Instant now) {
  std::array<std::uint8_t, frame_bytes_max> frame;
  const std::size_t pdu =
      write_write_request(std::span(frame).subspan(mbap_header_bytes), write.first, write.values);
  send({.address = write.address,
        .function = write_holding_registers,
        .range = {.first = write.first, .count = static_cast<std::uint16_t>(write.values.size())},
        .ticket = write.ticket,
        .timeout = write.timeout},
       frame, pdu, now);
}

void TcpBus::start_request(const UnitRequest& request, Instant now) {
  std::array<std::uint8_t, frame_bytes_max> frame;
  std::copy(request.pdu.begin(), request.pdu.end(), frame.begin() + mbap_header_bytes);
  const RtuQuestion question = question_of(request.pdu);
  send({.address = request.address,
        .function = question.function,
        .range = question.range,
        .ticket = request.ticket,
        .timeout = request.timeout,
        .is_of_client = true},
       frame, request.pdu.size(), now);
}

// The PDU stands in the frame, behind the place of its header.
void TcpBus::send(TcpRequest request, std::span<std::uint8_t> frame, std::size_t pdu_bytes,
                  Instant now) {
  if (queue_.is_empty()) connection_.discard();
  // Numbers come again after 65536 requests; some that nobody answered are remembered for longer.
  do {
    ++last_transaction_;
  } while (queue_.is_owed(last_transaction_));
  request.transaction = last_transaction_;
  request.sent_at = now;
  if (!unheard_since_) unheard_since_ = now;
  // Units that nobody has ever heard say nothing about the connection, until all had their turn.
  is_answer_due_ |= heard_[request.address] || asked_in_silence_[request.address];
  asked_in_silence_.set(request.address);
  slowest_timeout_ = std::max(slowest_timeout_, request.timeout);
  queue_.add(request, now);
  // Lost while what had come was taken: why, it has told.
  if (connection_.state() != FrameConnection::State::up) return abandon_all();
  connection_.send(frame, request.transaction, request.address, pdu_bytes);
}

void TcpBus::advance(Instant now) {
  queue_.advance(now);
  if (const auto late = queue_.take_late()) report_late(*late, now);
  give_up_silent(now);
  connection_.advance(now);
  if (connection_.state() == FrameConnection::State::down && next_attempt_ <= now) connect(now);
}

void TcpBus::give_up_silent(Instant now) {
  const Duration silence_max = std::max(silence_max_, timeouts_of_silence * slowest_timeout_);
  is_silent_ = is_answer_due_ && *unheard_since_ + silence_max <= now;
  while (const auto request = queue_.give_up(now, is_silent_)) {
    complete(*request, BusResult::timeout);
  }
  // Those under way have their time.
  if (!is_silent_ || queue_.waiting_count() > 0) return;
  silence_max_ = std::min(2 * silence_max_, tcp_silence_longest);
  connection_.abort();
  on_lost(
      "connected, but nothing answers; check the line behind it, and the power and addresses of "
      "its "
      "units");
}

bool TcpBus::take_answer(BusAnswer& answer) {
  if (completed_count_ == 0) return false;
  const Completed& oldest = completed_[completed_begin_];
  answer = {.address = oldest.address,
            .ticket = oldest.ticket,
            .result = oldest.result,
            .exception = oldest.exception,
            .silence = oldest.silence,
            .registers = std::span(oldest.registers).first(oldest.count),
            .pdu = std::span(oldest.pdu).first(oldest.pdu_bytes)};
  completed_begin_ = (completed_begin_ + 1) % completed_.size();
  --completed_count_;
  return true;
}

Instant TcpBus::next_deadline() const {
  const bool is_down = connection_.state() == FrameConnection::State::down;
  return std::min(
      {is_down ? next_attempt_ : never, connection_.next_deadline(), queue_.next_deadline()});
}

void TcpBus::on_connected() {
  // One that follows a silent one is no news before something has come.
  if (silence_max_ == tcp_silence_max) note_up();
}

void TcpBus::note_up() {
  reported_down_ = false;
  why_down_.clear();
  log_.write(Level::info, "bus " + options_.name + ": connected to " + to_string(options_.end));
}

void TcpBus::on_frame(const Frame& frame) {
  start_listening();
  heard_.set(frame.address);
  if (std::exchange(silence_max_, tcp_silence_max) != tcp_silence_max) note_up();
  const bool is_exception = frame.pdu.empty() || (frame.pdu[0] & exception_bit) != 0;
  if (const auto request = queue_.answer(frame.transaction, !is_exception)) {
    settle(*request, frame);
  }
}

void TcpBus::start_listening() {
  unheard_since_.reset();
  asked_in_silence_.reset();
  is_answer_due_ = false;
  slowest_timeout_ = Duration{};
  is_silent_ = false;
}

void TcpBus::settle(const TcpRequest& request, const Frame& frame) {
  if (frame.address != request.address) return complete(request, BusResult::bad_answer);
  Completed& answer = place();
  if (request.is_of_client) {
    const bool is_exception =
        frame.pdu.size() == 2 && frame.pdu[0] == (request.function | exception_bit);
    if (!is_exception &&
        !answers(frame.pdu, {.function = request.function, .range = request.range})) {
      return complete(request, BusResult::bad_answer);
    }
    if (is_exception) answer.exception = frame.pdu[1];
    std::copy(frame.pdu.begin(), frame.pdu.end(), answer.pdu.begin());
    complete(request, is_exception ? BusResult::exception : BusResult::ok);
    answer.pdu_bytes = frame.pdu.size();
    return;
  }
  if (request.function == write_holding_registers) {
    switch (parse_write_answer(frame.pdu, request.range, answer.exception)) {
      case WriteAnswer::written:
        return complete(request, BusResult::ok);
      case WriteAnswer::exception:
        return complete(request, BusResult::exception);
      case WriteAnswer::malformed:
        return complete(request, BusResult::bad_answer);
    }
  }
  switch (parse_read_answer(frame.pdu, request.function,
                            std::span(answer.registers).first(request.range.count),
                            answer.exception)) {
    case ReadAnswer::registers:
      return complete(request, BusResult::ok);
    case ReadAnswer::exception:
      return complete(request, BusResult::exception);
    case ReadAnswer::malformed:
      return complete(request, BusResult::bad_answer);
  }
}

TcpBus::Completed& TcpBus::place() {
  return completed_[(completed_begin_ + completed_count_) % completed_.size()];
}

void TcpBus::complete(const TcpRequest& request, BusResult result) {
  Completed& answer = place();
  answer.address = request.address;
  answer.ticket = request.ticket;
  answer.result = result;
  const bool has_registers = result == BusResult::ok && !request.is_of_client &&
                             request.function != write_holding_registers;
  answer.count = has_registers ? request.range.count : std::uint16_t{0};
  answer.pdu_bytes = 0;
  if (result != BusResult::exception) answer.exception = 0;
  if (is_of_converter(result, answer.exception)) queue_.note_converter();
  answer.silence = result == BusResult::timeout ? queue_.hold() : Duration{};
  ++completed_count_;
}

void TcpBus::report_late(const LateTransaction& late, Instant now) {
  const std::optional<Duration> timeout = advice_[late.address].advise(late.latency, now);
  if (!timeout) return;
  const auto in_ms = [](Duration time) {
    return std::to_string(std::chrono::ceil<std::chrono::milliseconds>(time).count());
  };
  const std::string address = std::to_string(late.address);
  const std::string what =
      late.has_come
          ? " was answered for too late, after " + in_ms(late.latency) + " ms"
          : " was not answered for, and held up the others for " + in_ms(late.latency) + " ms";
  const std::string slow = late.has_come ? ", and [[bus.device]] with units = \"" + address +
                                               "\" and timeout = \"" + in_ms(*timeout) + "ms\""
                                         : "";
  log_.write(Level::warning, "bus " + options_.name + ": unit " + address + what +
                                 "; patience grows, " + std::to_string(queue_.window()) +
                                 " under way: where a converter has one line, set outstanding = 1" +
                                 slow);
}

void TcpBus::connect(Instant now) {
  next_attempt_ = now + options_.reconnect_interval;
  if (last_transaction_ == 0) {
    last_transaction_ = static_cast<std::uint16_t>(now.time_since_epoch() / transaction_step);
  }
  connection_.connect(options_.end, now,
                      std::max(options_.reconnect_interval, TcpConnector::connect_time_max));
}

void TcpBus::abandon_all() {
  while (const auto request = queue_.abandon()) complete(*request, BusResult::link_lost);
  start_listening();
}

void TcpBus::on_lost(const char* why) {
  abandon_all();
  why_down_ = to_string(options_.end) + ": " + why;
  if (std::exchange(reported_down_, true)) return;
  log_.write(Level::warning, "bus " + options_.name + ": " + why_down_ + "; trying again");
}

}  // namespace etcm::port
