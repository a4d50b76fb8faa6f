// The RTU bus and the other end of its line. Time is the test's; the terminal is real.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "modbus/rtu_bus.h"
#include "peer.h"
#include "pseudo_terminal.h"

namespace etcm::port {

using namespace std::chrono_literals;

inline Bytes rtu_of(std::uint8_t unit, const Bytes& pdu) {
  Bytes bytes(rtu_frame_bytes_max);
  std::copy(pdu.begin(), pdu.end(), bytes.begin() + rtu_unit_bytes);
  bytes.resize(wrap_rtu(bytes, unit, pdu.size()));
  return bytes;
}

// The answer to reading two registers.
inline Bytes two_registers(std::uint8_t unit, std::uint8_t value,
                           std::uint8_t function = read_input_registers) {
  return rtu_of(unit, {function, 4, 0, value, 0, value});
}

// What stands on the line in place of an answer.
struct Misbehaviour {
  const char* name;
  Bytes bytes;
};

class SerialBus : public testing::Test {
 public:
  static constexpr Duration answer_timeout = std::chrono::milliseconds(50);
  static constexpr Duration quiet = std::chrono::milliseconds(20);

  class RecordingLines final : public DigitalIo {
   public:
    bool is_active(DigitalLine) const override { return active; }
    void set_active(DigitalLine, bool value) override {
      active = value;
      ++changes;
    }
    void advance(Instant) override {}
    Instant next_deadline() const override { return never; }
    bool active = false;
    int changes = 0;
  };

 protected:
  SerialBus()
      : path_(std::filesystem::path(testing::TempDir()) /
              ("etcm_line_" + std::to_string(::getpid()))) {
    plug_in();
  }

  void plug_in() { cable_.emplace(path_); }
  void unplug() { cable_.reset(); }

  RtuBus& bus() {
    if (!bus_) {
      bus_ = std::make_unique<RtuBus>(loop_, log_,
                                      RtuBusOptions{.name = "yard",
                                                    .serial_line = {.path = path_, .baud = 9600},
                                                    .clearing = clearing_,
                                                    .quiet = quiet,
                                                    .reopen_interval = 100ms,
                                                    .lines = &lines_,
                                                    .send_enable = send_enable_});
    }
    return *bus_;
  }

  void pass(Duration time) {
    now_ += time;
    bus().advance(now_);
  }

  // Lets time pass until a request may be sent.
  void become_ready() {
    bus().advance(now_);
    for (int turn = 0; turn < 100 && !bus().ready(); ++turn) pass(5ms);
    ASSERT_TRUE(bus().ready());
  }

  // Sends a request and takes it at the other end; it must be for this function.
  void request(std::uint8_t unit, std::uint8_t function = read_input_registers) {
    become_ready();
    bus().start_read({.address = unit, .first = 0, .count = 2, .timeout = answer_timeout}, now_);
    EXPECT_EQ(take(rtu_read_request_bytes), rtu_of(unit, {function, 0, 0, 0, 2}));
  }

  // Sends a write of two registers and takes it at the other end.
  void write(std::uint8_t unit, std::uint16_t first = 200) {
    become_ready();
    const std::array<std::uint16_t, 2> values{7, 8};
    bus().start_write({.address = unit,
                       .first = first,
                       .values = values,
                       .timeout = answer_timeout,
                       .ticket = 99},
                      now_);
    EXPECT_EQ(take(rtu_write_request_bytes(2)),
              rtu_of(unit, {16, 0, static_cast<std::uint8_t>(first), 0, 2, 4, 0, 7, 0, 8}));
  }

  // What came out at the other end, when it is so many bytes.
  Bytes take(std::size_t count) {
    Bytes bytes;
    EXPECT_TRUE(turn_until(loop_, [&] {
      std::uint8_t chunk[64];
      const ssize_t got = ::read(cable_->descriptor(), chunk, sizeof chunk);
      if (got > 0) bytes.insert(bytes.end(), chunk, chunk + got);
      return bytes.size() >= count;
    }));
    return bytes;
  }

  // Puts bytes on the line and lets the bus hear them: the terminal hands them over when the kernel
  // finds the time, so it waits until nothing has come for as long as a busy machine may take.
  void say(const Bytes& bytes) {
    ASSERT_EQ(::write(cable_->descriptor(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
    // For the first of them, which nearly always is all.
    if (!bytes.empty()) loop_.wait(patience);
    const SteadyClock clock;
    for (bool heard = true; heard;) {
      const Instant before = clock.now();
      loop_.wait(30ms);
      heard = clock.now() - before < 25ms;
    }
    bus().advance(now_);
  }

  std::optional<BusResult> result() {
    BusAnswer found;
    if (!bus().take_answer(found)) return std::nullopt;
    value_ = found.registers.empty() ? -1 : found.registers.back();
    exception_ = found.exception;
    ticket_ = found.ticket;
    return found.result;
  }

  // The wait is over without an answer.
  BusResult wait_in_vain() {
    EXPECT_EQ(result(), std::nullopt);
    pass(200ms);
    return result().value_or(BusResult::ok);
  }

  // Unit 7 answers long after its time, and then is asked the other way and does not answer.
  void miss_after_a_slow_answer() {
    request(7);
    EXPECT_EQ(wait_in_vain(), BusResult::timeout);
    pass(quiet + 300ms);
    say(two_registers(7, 1));
    request(7, read_holding_registers);
    EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  }

  // The next question to a healthy unit gets its own answer.
  void expect_health(std::uint8_t unit = 9) {
    request(unit);
    say(two_registers(unit, 77));
    ASSERT_EQ(result(), BusResult::ok);
    EXPECT_EQ(value_, 77);
  }

  EventLoop loop_;
  KeptLog log_;
  RecordingLines lines_;
  std::optional<DigitalLine> send_enable_;
  Duration clearing_{};
  std::string path_;
  std::optional<nodes::PseudoTerminal> cable_;
  std::unique_ptr<RtuBus> bus_;
  Instant now_{1h};
  int value_ = -1;
  int exception_ = 0;
  std::uint32_t ticket_ = 0;
};

}  // namespace etcm::port
