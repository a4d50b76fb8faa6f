// How the poller spends the time of a serial line. Poller, adapter and terminal are real; time is
// the test's and what is on the line is counted byte by byte, so the figures are the same on every
// machine. (line_bench measures the same in real time.)
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <vector>

#include "fakes.h"
#include "firmware/polling/poller.h"
#include "firmware/protocol/node_registers.h"
#include "modbus/replies.h"
#include "modbus/rtu_bus.h"
#include "posix/event_loop.h"
#include "pseudo_terminal.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

// Passes everything on, and notes whom the poller asks.
class ObservedBus final : public port::NodeBus {
 public:
  explicit ObservedBus(port::NodeBus& bus) : bus_(bus) {}
  bool ready() const override { return bus_.ready(); }
  void start_read(const port::RegisterRead& read, port::Instant now) override {
    asked = read.address;
    bus_.start_read(read, now);
  }
  void start_write(const port::RegisterWrite& write, port::Instant now) override {
    bus_.start_write(write, now);
  }
  void start_request(const port::UnitRequest& request, port::Instant now) override {
    bus_.start_request(request, now);
  }
  void advance(port::Instant now) override { bus_.advance(now); }
  bool take_answer(port::BusAnswer& answer) override { return bus_.take_answer(answer); }
  port::Instant next_deadline() const override { return bus_.next_deadline(); }

  std::uint8_t asked = 0;  // for the test to set to 0 again

 private:
  port::NodeBus& bus_;
};

struct LineCase {
  std::uint32_t baud;
  std::uint32_t units;
  std::uint32_t dead_every = 0;    // 0: none is dead
  bool asks_the_dead = true;       // else they are left out
  port::Duration interval = 10ms;  // shorter than a sweep: the line is never idle
};

class SimulatedLine final : public ReadingListener {
 public:
  explicit SimulatedLine(const LineCase& line_case)
      : case_(line_case),
        line_{.path = terminal_.path(), .baud = line_case.baud},
        read_at_(line_case.units + 1) {}

  // Until the healthy units were read so often, on average.
  void run(std::uint32_t sweeps, bool counts) {
    counts_ = counts;
    gaps_.clear();
    began_at_ = now_;
    const std::uint32_t end = readings_ + sweeps * healthy_units();
    while (readings_ < end && !testing::Test::HasFailure()) {
      poller_.step(now_);
      if (observed_.asked != 0) hear_request();
      const port::Instant next = poller_.next_deadline();
      if (answer_at_ <= next) {
        now_ = answer_at_;
        say_answer();
      } else {
        now_ = std::max(now_, next);
      }
    }
  }

  bool on_reading(UnitIndex, const NodeReading& reading, std::span<const Measurement>,
                  port::Instant now) override {
    port::Instant& read_at = read_at_[reading.serial.value];
    if (counts_) gaps_.push_back(now - read_at);
    read_at = now;
    ++readings_;
    return true;
  }

  // The least time that the bytes and the silences of the readings need, over what they took.
  double efficiency() const {
    const port::Duration least =
        (request_bytes + answer_bytes) * character_ + 2 * frame_silence(line_);
    return static_cast<double>((least * static_cast<std::int64_t>(gaps_.size())).count()) /
           static_cast<double>((now_ - began_at_).count());
  }

  // The age that positions keep below for all but one part in a hundred of the time. Between two
  // readings an age grows evenly.
  port::Duration age_p99() const {
    port::Duration all{}, low{}, high{};
    for (const port::Duration gap : gaps_) {
      all += gap;
      high = std::max(high, gap);
    }
    while (high - low > 1us) {
      const port::Duration middle = (low + high) / 2;
      port::Duration older{};
      for (const port::Duration gap : gaps_) older += std::max(gap - middle, port::Duration{});
      (older > all / 100 ? low : high) = middle;
    }
    return high;
  }

  std::uint32_t questions_to_the_dead() const { return questions_to_the_dead_; }

 private:
  static constexpr std::int64_t request_bytes = port::rtu_read_request_bytes;
  static constexpr std::int64_t answer_bytes = port::rtu_read_answer_bytes(node_register_count);

  bool is_dead(std::uint32_t unit) const {
    return case_.dead_every != 0 && unit % case_.dead_every == 0;
  }

  std::uint32_t healthy_units() const {
    return case_.units - (case_.dead_every == 0 ? 0 : case_.units / case_.dead_every);
  }

  std::vector<UnitRange> asked_units() const {
    std::vector<UnitRange> asked;
    for (std::uint32_t unit = 1; unit <= case_.units; ++unit) {
      const auto address = static_cast<std::uint8_t>(unit);
      if (!is_dead(unit) || case_.asks_the_dead) asked.push_back({address, address});
    }
    return asked;
  }

  // Takes the request from the line; a living unit answers after the silence that ends it.
  void hear_request() {
    std::array<std::uint8_t, request_bytes> bytes{};
    for (std::size_t count = 0; count < bytes.size();) {
      pollfd readable{.fd = terminal_.descriptor(), .events = POLLIN, .revents = 0};
      ASSERT_EQ(::poll(&readable, 1, patience_ms), 1) << "no request";
      const ssize_t got =
          ::read(terminal_.descriptor(), bytes.data() + count, bytes.size() - count);
      ASSERT_GT(got, 0);
      count += static_cast<std::size_t>(got);
    }
    ASSERT_EQ(bytes[0], observed_.asked);
    observed_.asked = 0;
    if (is_dead(bytes[0])) {
      ++questions_to_the_dead_;
      return;
    }
    function_ = bytes[1];
    speaker_ = bytes[0];
    answer_at_ = now_ + (request_bytes + answer_bytes) * character_ + frame_silence(line_);
  }

  void say_answer() {
    std::array<std::uint8_t, port::rtu_frame_bytes_max> frame;
    const NodeRegisters registers = encode_node(
        {.serial = Serial{speaker_}, .position = {}, .status = node_status::fix_valid}, 1);
    const std::array<std::uint8_t, 5> request{function_, 0, 0, 0, node_register_count};
    const std::size_t pdu = replies_.to_read(request, node_register_first, registers,
                                             std::span(frame).subspan(port::rtu_unit_bytes));
    const std::size_t size = port::wrap_rtu(frame, speaker_, pdu);
    ASSERT_EQ(size, static_cast<std::size_t>(answer_bytes));
    answer_at_ = port::never;
    const port::Instant deadline = bus_.next_deadline();
    ASSERT_EQ(::write(terminal_.descriptor(), frame.data(), size), static_cast<ssize_t>(size));
    // The terminal hands it over when the kernel finds the time; then the wait for it is over.
    for (int turn = 0; bus_.next_deadline() == deadline; ++turn) {
      ASSERT_LT(turn, patience_ms) << "the answer is not heard";
      loop_.wait(1ms);
      bus_.advance(now_);
    }
  }

  static constexpr int patience_ms = 20000;

  LineCase case_;
  port::Replies replies_;
  nodes::PseudoTerminal terminal_;
  port::SerialLine line_;
  port::Duration character_ = character_time(line_);
  port::EventLoop loop_;
  RecordingLog log_;
  port::RtuBus bus_{loop_,
                    log_,
                    {.name = "yard",
                     .serial_line = line_,
                     .quiet = 20ms,
                     .reopen_interval = 1s,
                     .send_enable = {}}};
  ObservedBus observed_{bus_};
  PollSettings poll_{.interval = case_.interval, .absent_interval = 10s};
  BusSettings settings_{.name = "yard",
                        .link = line_,
                        .units = asked_units(),
                        .timeout = 50ms,
                        .quiet = 20ms,
                        .outstanding_max = 1,
                        .send_enable = {}};
  std::vector<PolledBus> polled_{{.bus = &observed_, .settings = &settings_}};
  Poller poller_{poll_, polled_, *this, log_};

  port::Instant now_{1h};
  port::Instant began_at_{};
  port::Instant answer_at_ = port::never;
  std::uint8_t speaker_ = 0;
  std::uint8_t function_ = 0;
  bool counts_ = false;
  std::uint32_t readings_ = 0;
  std::uint32_t questions_to_the_dead_ = 0;
  std::vector<port::Instant> read_at_;  // by serial
  std::vector<port::Duration> gaps_;    // from one reading of a unit to its next
};

class BusyLine : public testing::TestWithParam<std::uint32_t> {
 protected:
  // The first sweeps find out who is dead.
  static SimulatedLine* measured(SimulatedLine& line) {
    line.run(2, false);
    line.run(3, true);
    return &line;
  }
};

TEST_P(BusyLine, IsNeverIdleBetweenTwoQuestions) {
  SimulatedLine line({.baud = GetParam(), .units = 247});
  EXPECT_GE(measured(line)->efficiency(), 0.99);
}

TEST_P(BusyLine, ADeadTenthAgesTheOthersPositionsByATenthAtTheMost) {
  SimulatedLine with({.baud = GetParam(), .units = 247, .dead_every = 10});
  SimulatedLine without(
      {.baud = GetParam(), .units = 247, .dead_every = 10, .asks_the_dead = false});
  const double grown = static_cast<double>(measured(with)->age_p99().count()) /
                       static_cast<double>(measured(without)->age_p99().count());
  EXPECT_GE(grown, 1.0);
  EXPECT_LE(grown, 1.1);
  EXPECT_GT(with.questions_to_the_dead(), 24u) << "they may come back";
}

// Where a wait in vain is longer than a sweep, one of them ages all positions by more than a tenth;
// but it is as rare, also while units that may only have lost a frame are asked once more.
TEST_P(BusyLine, ADeadHalfCostsTheOthersATenthOfTheirPollsAtTheMost) {
  SimulatedLine with({.baud = GetParam(), .units = 60, .dead_every = 2});
  SimulatedLine without({.baud = GetParam(), .units = 60, .dead_every = 2, .asks_the_dead = false});
  for (SimulatedLine* const line : {&with, &without}) line->run(2, false);
  for (int sweeps = 0; sweeps < 200; sweeps += 50) {
    for (SimulatedLine* const line : {&with, &without}) line->run(50, true);
    EXPECT_GE(with.efficiency(), 0.9 * without.efficiency()) << "after " << sweeps << " sweeps";
  }
  EXPECT_GT(with.questions_to_the_dead(), 2u * 30u) << "each was asked again";
}

INSTANTIATE_TEST_SUITE_P(Baud, BusyLine, testing::Values(9600u, 19200u, 115200u),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace etcm::firmware
