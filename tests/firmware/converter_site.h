// A converter from Modbus TCP to a serial line, or units beside each other, with time in the test's
// hand; poller and bus are real.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "fakes.h"
#include "firmware/polling/poller.h"
#include "firmware/protocol/node_registers.h"
#include "modbus/replies.h"
#include "modbus/tcp_bus.h"

namespace etcm::firmware {

using namespace std::chrono_literals;

// How a device behind the connection behaves.
struct Behind {
  std::uint8_t units = 20;
  std::vector<std::uint8_t> dead{};
  port::Duration exchange = 30ms;  // of a unit that answers
  port::Duration hold = 1s;        // of one that does not
  std::uint8_t exception = 0x0b;   // then; 0: it says nothing
  bool is_one_line = true;         // else all units answer beside each other
  // Asked for these it ends the connection.
  std::vector<std::uint8_t> ends_for{};
};

class SimulatedConverter final : public port::FrameConnection {
 public:
  explicit SimulatedConverter(const Behind& behind) : behind_(behind) {}

  State state() const override { return state_; }
  void connect(const port::Endpoint&, port::Instant, port::Duration) override {
    state_ = State::up;
    listener().on_connected();
  }
  void advance(port::Instant) override {}
  port::Instant next_deadline() const override { return port::never; }
  void send(std::span<std::uint8_t> frame, std::uint16_t transaction, std::uint8_t unit,
            std::size_t pdu_bytes) override {
    const auto pdu = frame.subspan(port::mbap_header_bytes, pdu_bytes);
    waiting_.push_back(
        {.transaction = transaction, .address = unit, .pdu = {pdu.begin(), pdu.end()}});
    requests[unit] += 1;
    if (!behind_.is_one_line || waiting_.size() == 1) begin(waiting_.back(), now_);
    longest_queue = std::max(longest_queue, waiting_.size());
  }
  void discard() override {}
  void close() override {
    state_ = State::down;
    waiting_.clear();
  }
  void abort() override { close(); }

  void pass_to(port::Instant now) {
    for (port::Instant due = next(); due <= now; due = next()) {
      const auto done = std::min_element(
          waiting_.begin(), waiting_.end(),
          [](const Request& a, const Request& b) { return a.done_at < b.done_at; });
      const Request request = *done;
      waiting_.erase(done);
      now_ = due;
      if (behind_.is_one_line && !waiting_.empty()) begin(waiting_.front(), due);
      if (is_among(behind_.ends_for, request.address)) {
        end();
        break;
      }
      answer(request);
    }
    now_ = now;
  }
  port::Instant next() const {
    port::Instant next = port::never;
    for (const Request& request : waiting_) next = std::min(next, request.done_at);
    return next;
  }
  void end() {
    state_ = State::down;
    waiting_.clear();
    ++ends;
    listener().on_lost("connection closed by the other side");
  }
  void fall_silent(bool is_silent) { is_silent_ = is_silent; }

  std::size_t longest_queue = 0;
  std::uint32_t ends = 0;  // of connections
  // When units that do not answer held the line.
  std::vector<std::pair<port::Instant, port::Instant>> holds;
  std::array<std::uint32_t, 256> requests{};

 private:
  struct Request {
    std::uint16_t transaction = 0;
    std::uint8_t address = 0;
    std::vector<std::uint8_t> pdu;
    port::Instant done_at = port::never;
  };

  static bool is_among(const std::vector<std::uint8_t>& units, std::uint8_t unit) {
    return std::find(units.begin(), units.end(), unit) != units.end();
  }
  bool is_dead(std::uint8_t unit) const {
    return is_silent_ || unit > behind_.units || is_among(behind_.dead, unit);
  }
  void begin(Request& request, port::Instant now) {
    request.done_at = now + (is_dead(request.address) ? behind_.hold : behind_.exchange);
    if (is_dead(request.address)) holds.emplace_back(now, request.done_at);
  }
  void answer(const Request& request) {
    std::array<std::uint8_t, port::pdu_bytes_max> pdu;
    std::size_t size = 0;
    if (is_dead(request.address)) {
      if (behind_.exception == 0) return;
      size = port::write_exception(pdu, request.pdu[0], behind_.exception);
    } else {
      const NodeRegisters registers = encode_node(
          {.serial = Serial{request.address}, .position = {}, .status = node_status::fix_valid}, 1);
      size = replies_.to_read(request.pdu, node_register_first, registers, pdu);
    }
    listener().on_frame({.transaction = request.transaction,
                         .address = request.address,
                         .pdu = std::span(pdu).first(size)});
  }

  Behind behind_;
  State state_ = State::down;
  bool is_silent_ = false;
  port::Instant now_{1h};
  std::deque<Request> waiting_;
  port::Replies replies_;
};

class ConverterSite final : public ReadingListener {
 public:
  explicit ConverterSite(const Behind& behind, std::vector<UnitRange> units = {})
      : device(behind),
        readings(256),
        settings_{.name = "yard",
                  .link = port::Endpoint{},
                  .units = units.empty() ? std::vector<UnitRange>{{1, behind.units}} : units,
                  .timeout = 200ms,
                  .outstanding_max = 4,
                  .send_enable = {}} {}

  void run_for(port::Duration time) {
    for (const port::Instant end = now_ + time; now_ < end;) {
      poller_.step(now_);
      now_ = std::max(now_ + 1us, std::min({poller_.next_deadline(), device.next(), end}));
      device.pass_to(now_);
    }
  }

  bool on_reading(UnitIndex unit, const NodeReading&, std::span<const Measurement>,
                  port::Instant now) override {
    ++readings[poller_.address_of(unit).value];
    read_at[poller_.address_of(unit).value].push_back(now);
    return true;
  }
  std::uint32_t all_readings() const {
    std::uint32_t sum = 0;
    for (const std::uint32_t count : readings) sum += count;
    return sum;
  }
  std::uint64_t timeouts_of_healthy(const Behind& behind) const {
    std::uint64_t sum = 0;
    for (UnitIndex unit{0}; unit.value < poller_.unit_count(); ++unit.value) {
      const std::uint8_t address = poller_.address_of(unit).value;
      if (std::find(behind.dead.begin(), behind.dead.end(), address) == behind.dead.end()) {
        sum += poller_.counters(unit).count(port::BusResult::timeout);
      }
    }
    return sum;
  }

  std::uint32_t dead_requests(const Behind& behind) const {
    std::uint32_t sum = 0;
    for (const std::uint8_t unit : behind.dead) sum += device.requests[unit];
    return sum;
  }
  std::string logged() const { return testing::PrintToString(log.lines); }

  SimulatedConverter device;
  RecordingLog log;
  std::vector<std::uint32_t> readings;  // by unit
  std::array<std::vector<port::Instant>, 256> read_at;

 private:
  port::Instant now_{1h};
  PollSettings poll_{.interval = 1s, .absent_interval = 10s};
  BusSettings settings_;
  port::TcpBus bus_{
      device, log, {.name = "yard", .end = {}, .outstanding_max = 4, .reconnect_interval = 1s}};
  std::vector<PolledBus> polled_{{.bus = &bus_, .settings = &settings_}};
  Poller poller_{poll_, polled_, *this, log};
};

}  // namespace etcm::firmware
