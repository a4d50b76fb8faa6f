#include "modbus/tcp_bus.h"

#include <algorithm>
#include <utility>

namespace etcm::port {

namespace {

constexpr std::int64_t timeouts_of_silence = 3;

}  // namespace

TcpBus::TcpBus(EventLoop& loop, Log& log, const TcpBusOptions& options)
    : log_(log), options_(options), connection_(loop, *this), completed_(options.outstanding_max) {
  requests_.reserve(options.outstanding_max);
}

bool TcpBus::ready() const {
  return connection_.state() == TcpConnection::State::up && !is_silent_ &&
         requests_.size() + completed_count_ < options_.outstanding_max;
}

void TcpBus::start_read(const RegisterRead& read, Instant now) {
  std::array<std::uint8_t, frame_bytes_max> frame;
  const RegisterRange range{.first = read.first, .count = read.count};
  const std::size_t pdu =
      write_read_request(std::span(frame).subspan(mbap_header_bytes), read_input_registers, range);
  send({.unit = read.unit, .function = read_input_registers, .range = range, .ticket = read.ticket},
       read.timeout, frame, pdu, now);
}

void TcpBus::start_write(const RegisterWrite& write, Instant now) {
  std::array<std::uint8_t, frame_bytes_max> frame;
  const std::size_t pdu =
      write_write_request(std::span(frame).subspan(mbap_header_bytes), write.first, write.values);
  send({.unit = write.unit,
        .function = write_holding_registers,
        .range = {.first = write.first, .count = static_cast<std::uint16_t>(write.values.size())},
        .ticket = write.ticket},
       write.timeout, frame, pdu, now);
}

// The PDU stands in the frame, behind the place of its header.
void TcpBus::send(Request request, Duration timeout, std::span<std::uint8_t> frame,
                  std::size_t pdu_bytes, Instant now) {
  if (requests_.empty()) connection_.discard();
  request.transaction = ++last_transaction_;
  request.deadline = now + timeout;
  if (!unheard_since_) unheard_since_ = now;
  slowest_timeout_ = std::max(slowest_timeout_, timeout);
  requests_.push_back(request);
  if (connection_.state() != TcpConnection::State::up) {
    return on_lost("connection closed by the other side");
  }
  connection_.send(frame, request.transaction, request.unit, pdu_bytes);
}

void TcpBus::advance(Instant now) {
  for (std::size_t i = requests_.size(); i-- > 0;) {
    if (requests_[i].deadline <= now) complete(i, BusResult::timeout);
  }
  give_up_silent(now);
  if (connection_.state() != TcpConnection::State::up && next_attempt() <= now) connect(now);
}

void TcpBus::give_up_silent(Instant now) {
  const Duration silence_max = std::max(silence_max_, timeouts_of_silence * slowest_timeout_);
  is_silent_ = unheard_since_ && *unheard_since_ + silence_max <= now;
  // Those under way have their time.
  if (!is_silent_ || !requests_.empty()) return;
  silence_max_ = std::min(2 * silence_max_, tcp_silence_longest);
  connection_.abort();
  on_lost("connected, but nothing answers");
}

bool TcpBus::take_answer(BusAnswer& answer) {
  if (completed_count_ == 0) return false;
  const Completed& oldest = completed_[completed_begin_];
  answer = {.unit = oldest.unit,
            .ticket = oldest.ticket,
            .result = oldest.result,
            .exception = oldest.exception,
            .registers = std::span(oldest.registers).first(oldest.count)};
  completed_begin_ = (completed_begin_ + 1) % completed_.size();
  --completed_count_;
  return true;
}

Instant TcpBus::next_attempt() const {
  return connection_.state() == TcpConnection::State::connecting ? attempt_ends_ : next_attempt_;
}

Instant TcpBus::next_deadline() const {
  Instant deadline = connection_.state() == TcpConnection::State::up ? never : next_attempt();
  for (const Request& request : requests_) deadline = std::min(deadline, request.deadline);
  return deadline;
}

void TcpBus::on_connected() {
  // One that follows a silent one is no news before something has come.
  if (silence_max_ == tcp_silence_max) note_up();
}

void TcpBus::note_up() {
  reported_down_ = false;
  log_.write(Level::info, "bus " + options_.name + ": connected to " + to_string(options_.address));
}

void TcpBus::on_frame(const Frame& frame) {
  unheard_since_.reset();
  slowest_timeout_ = Duration{};
  is_silent_ = false;
  if (std::exchange(silence_max_, tcp_silence_max) != tcp_silence_max) note_up();
  const auto found = std::find_if(requests_.begin(), requests_.end(), [&](const Request& request) {
    return request.transaction == frame.transaction;
  });
  if (found == requests_.end()) return;
  const auto index = static_cast<std::size_t>(found - requests_.begin());
  if (frame.unit != found->unit) return complete(index, BusResult::bad_answer);
  Completed& place = completed_[(completed_begin_ + completed_count_) % completed_.size()];
  if (found->function == write_holding_registers) {
    switch (parse_write_answer(frame.pdu, found->range, place.exception)) {
      case WriteAnswer::written:
        return complete(index, BusResult::ok);
      case WriteAnswer::exception:
        return complete(index, BusResult::exception);
      case WriteAnswer::malformed:
        return complete(index, BusResult::bad_answer);
    }
  }
  switch (parse_read_answer(frame.pdu, found->function,
                            std::span(place.registers).first(found->range.count),
                            place.exception)) {
    case ReadAnswer::registers:
      return complete(index, BusResult::ok);
    case ReadAnswer::exception:
      return complete(index, BusResult::exception);
    case ReadAnswer::malformed:
      return complete(index, BusResult::bad_answer);
  }
}

void TcpBus::complete(std::size_t request, BusResult result) {
  Completed& place = completed_[(completed_begin_ + completed_count_) % completed_.size()];
  const Request& done = requests_[request];
  place.unit = done.unit;
  place.ticket = done.ticket;
  place.result = result;
  const bool has_registers = result == BusResult::ok && done.function == read_input_registers;
  place.count = has_registers ? done.range.count : std::uint16_t{0};
  if (result != BusResult::exception) place.exception = 0;
  ++completed_count_;
  requests_.erase(requests_.begin() + static_cast<std::ptrdiff_t>(request));
}

void TcpBus::connect(Instant now) {
  if (connection_.state() == TcpConnection::State::connecting) {
    connection_.close();
    on_lost("no answer to the attempt to connect");
  }
  next_attempt_ = now + options_.reconnect_interval;
  attempt_ends_ = now + std::max(options_.reconnect_interval, tcp_connect_max);
  connection_.connect(options_.address);
}

void TcpBus::on_lost(const char* why) {
  while (!requests_.empty()) complete(0, BusResult::link_lost);
  unheard_since_.reset();
  is_silent_ = false;
  if (reported_down_) return;
  reported_down_ = true;
  log_.write(Level::warning, "bus " + options_.name + ": " + to_string(options_.address) + ": " +
                                 why + "; trying again");
}

}  // namespace etcm::port
