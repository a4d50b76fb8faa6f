// The RTU bus against units that answer late, wrongly, or not at all. Time is the test's; the
// terminal is real.
#include "modbus/rtu_bus.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include "peer.h"
#include "pseudo_terminal.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

constexpr Duration answer_timeout = 50ms;
constexpr Duration quiet = 20ms;

Bytes rtu_of(std::uint8_t unit, const Bytes& pdu) {
  Bytes bytes(rtu_frame_bytes_max);
  std::copy(pdu.begin(), pdu.end(), bytes.begin() + rtu_unit_bytes);
  bytes.resize(wrap_rtu(bytes, unit, pdu.size()));
  return bytes;
}

// The answer to reading two registers.
Bytes two_registers(std::uint8_t unit, std::uint8_t value,
                    std::uint8_t function = read_input_registers) {
  return rtu_of(unit, {function, 4, 0, value, 0, value});
}

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

class SerialBus : public testing::Test {
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
    value_ = found.registers.empty() ? -1 : found.registers[1];
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

TEST_F(SerialBus, ReadsRegisters) {
  request(7);
  say(two_registers(7, 42));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 42);
}

TEST_F(SerialBus, AsksForTheRegistersThatAreMeant) {
  for (int turn = 0; turn < 3; ++turn) {
    become_ready();
    bus().start_read({.address = 7,
                      .kind = RegisterKind::holding,
                      .first = 0,
                      .count = 2,
                      .timeout = answer_timeout},
                     now_);
    EXPECT_EQ(take(rtu_read_request_bytes), rtu_of(7, {read_holding_registers, 0, 0, 0, 2}));
    say(two_registers(7, 42, read_holding_registers));
    EXPECT_EQ(result(), BusResult::ok);
    EXPECT_EQ(value_, 42);
  }
}

// It has no other way to tell the answer to the next question from this one's.
TEST_F(SerialBus, AsksOneWayOnceUntilItsLateAnswerCanComeNoMore) {
  const RegisterRead read{.address = 7,
                          .kind = RegisterKind::holding,
                          .first = 0,
                          .count = 2,
                          .timeout = answer_timeout};
  become_ready();
  bus().start_read(read, now_);
  take(rtu_read_request_bytes);
  const Instant asked = now_;
  while (!result() && now_ < asked + 1s) pass(1ms);
  EXPECT_GE(bus().read_free_at(read, now_), asked + 5s);
}

TEST_F(SerialBus, AsksNothingBeforeAnswersToAnEarlierRunCanComeNoMore) {
  clearing_ = 5s;
  bus().advance(now_);
  const Instant opened = now_;
  EXPECT_EQ(log_.lines.back(), "bus yard: opened " + path_ +
                                   "; asks nothing for 6 s, in which answers to an earlier run may "
                                   "come");
  EXPECT_TRUE(bus().is_clearing(now_));
  EXPECT_EQ(bus().next_deadline(), opened + 5s + bus().delay_max());
  say(two_registers(7, 1));
  while (now_ < opened + 5s) {
    EXPECT_FALSE(bus().ready());
    pass(100ms);
    say({0});
  }
  pass(bus().delay_max());
  EXPECT_FALSE(bus().is_clearing(now_));
  request(7);
  EXPECT_EQ(result(), std::nullopt);
  say(two_registers(7, 2));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 2);
}

TEST_F(SerialBus, APortThatComesBackInTheSameRunIsAskedAtOnce) {
  clearing_ = 5s;
  bus().advance(now_);
  pass(4s);
  unplug();
  EXPECT_TRUE(turn_until(loop_, [&] {
    pass(1ms);
    return !bus().is_up();
  }));
  EXPECT_FALSE(bus().is_clearing(now_));
  plug_in();
  pass(100ms);
  EXPECT_TRUE(bus().is_clearing(now_)) << "the rest of the time is waited for";
  pass(3s);
  become_ready();
  unplug();
  EXPECT_TRUE(turn_until(loop_, [&] {
    pass(1ms);
    return !bus().is_up();
  }));
  plug_in();
  pass(100ms);
  pass(5ms);
  EXPECT_TRUE(bus().ready());
}

TEST_F(SerialBus, AnAnswerMayComeByteByByte) {
  request(7);
  for (const std::uint8_t byte : two_registers(7, 42)) {
    EXPECT_EQ(result(), std::nullopt);
    say({byte});
    pass(1ms);
  }
  EXPECT_EQ(result(), BusResult::ok);
}

TEST_F(SerialBus, FramesAreApartByTheirSilence) {
  request(7);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), BusResult::ok);
  const Duration silence = frame_silence({.path = {}, .baud = 9600});
  EXPECT_EQ(bus().next_deadline(), now_ + silence);
  pass(silence - 1us);
  EXPECT_FALSE(bus().ready());
  pass(1us);
  EXPECT_TRUE(bus().ready());
}

TEST_F(SerialBus, TimeOnTheLineIsNotTheUnits) {
  request(7);
  const Duration bytes = 17 * character_time({.path = {}, .baud = 9600});
  pass(bytes + answer_timeout);
  EXPECT_EQ(result(), std::nullopt);
  pass(5ms);
  EXPECT_EQ(result(), BusResult::timeout);
}

TEST_F(SerialBus, ALateAnswerNeverBecomesTheNextRequestsData) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), std::nullopt);
  // Asked in another way, so that what comes even later does not match either.
  request(7, read_holding_registers);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), std::nullopt);
  say(two_registers(7, 2, read_holding_registers));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 2);
}

TEST_F(SerialBus, ALateAnswerIsNotTakenForAnotherUnits) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  request(8);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), std::nullopt);
  say(two_registers(8, 2));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 2);
}

// It takes 1.35 s for each.
TEST_F(SerialBus, TheAnswerToTheFirstQuestionIsNotTakenForTheThirds) {
  become_ready();
  const Instant begin = now_;
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  request(7, read_holding_registers);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  pass(begin + 1300ms - now_);
  // Both ways to ask for these registers may still be answered: this is not sent.
  const RegisterRead third{
      .address = 7, .first = 0, .count = 2, .timeout = answer_timeout, .spare = 0};
  EXPECT_GT(bus().read_free_at(third, now_), now_);
  bus().start_read(third, now_);
  EXPECT_EQ(result(), BusResult::timeout);
  EXPECT_TRUE(bus().ready()) << "for others";
  pass(begin + 1350ms - now_);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), std::nullopt);
  EXPECT_NE(log_.lines.back().find("after 13"), std::string::npos) << log_.lines.back();
  request(7);  // that answer is not owed any more
  say(two_registers(7, 2));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 2);
}

// Two units have one address, and one of them answers late; then the other one is taken away.
TEST_F(SerialBus, ALateAnswerToWhatAnotherOneHasAnsweredIsNotTakenForTheNext) {
  request(7);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), BusResult::ok);
  pass(300ms);
  say(two_registers(7, 2));
  EXPECT_EQ(result(), std::nullopt);
  pass(100ms);
  request(7, read_holding_registers);
  say(two_registers(7, 3));
  EXPECT_EQ(result(), std::nullopt) << "it is for a question of before";
  say(two_registers(7, 4, read_holding_registers));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 4);
}

// The second answer to the question in the other way has not come when the other one is taken away.
TEST_F(SerialBus, WhereTwoAnswerAllThatWasAnsweredMayBeAnsweredOnceMore) {
  const RegisterRead read{.address = 7, .first = 0, .count = 2, .timeout = answer_timeout};
  request(7);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_LE(bus().read_free_at(read, now_), now_) << "nothing is known of another one";
  pass(300ms);
  say(two_registers(7, 2));
  EXPECT_EQ(result(), std::nullopt);
  request(7, read_holding_registers);
  say(two_registers(7, 3, read_holding_registers));
  EXPECT_EQ(result(), BusResult::ok);
  const Instant answered_at = now_;
  EXPECT_GE(bus().read_free_at(read, now_), answered_at - 300ms + late_answer_max);
  become_ready();
  say(two_registers(7, 4, read_holding_registers));
  EXPECT_EQ(result(), std::nullopt);
  // One that answers at once and alone is asked as before.
  pass(doubled_for);
  for (std::uint8_t value = 5; value < 8; ++value) {
    request(7);
    say(two_registers(7, value));
    EXPECT_EQ(result(), BusResult::ok);
    EXPECT_EQ(value_, value);
    pass(20ms);
  }
}

TEST_F(SerialBus, WhatWasAnsweredBeforeTwoWereKnownOfMayBeAnsweredOnceMore) {
  const RegisterRead other{
      .address = 7, .kind = RegisterKind::input, .first = 0, .count = 1, .timeout = answer_timeout};
  become_ready();
  bus().start_read(other, now_);
  take(rtu_read_request_bytes);
  say(rtu_of(7, {4, 2, 0, 1}));
  EXPECT_EQ(result(), BusResult::ok);
  request(7);
  say(two_registers(7, 2));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_LE(bus().read_free_at(other, now_), now_);
  pass(300ms);
  say(two_registers(7, 3));
  EXPECT_GE(bus().read_free_at(other, now_), now_ + late_answer_max);
}

// As an adapter or a server hands it on.
TEST_F(SerialBus, WhatNobodyAskedForIsKnownOfThoughItComesInPieces) {
  const RegisterRead read{
      .address = 7, .kind = RegisterKind::input, .first = 0, .count = 2, .timeout = answer_timeout};
  request(7);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), BusResult::ok);
  pass(300ms);
  const Bytes second = two_registers(7, 2);
  say(Bytes(second.begin(), second.begin() + 3));
  pass(20ms);
  say(Bytes(second.begin() + 3, second.end()));
  EXPECT_GE(bus().read_free_at(read, now_), now_ + late_answer_max - 50ms);
}

// What stood in the line's memory was taken for an answer of somebody else.
TEST_F(SerialBus, AnAnswerIsNotHeardTwiceWhereAnotherUnitTalksNext) {
  const RegisterRead read{
      .address = 7, .kind = RegisterKind::input, .first = 0, .count = 2, .timeout = answer_timeout};
  request(7);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), BusResult::ok);
  pass(1ms);
  say({9, 4});
  pass(5ms);
  EXPECT_LE(bus().read_free_at(read, now_), now_);
}

// It looks like the answer to what another unit is asked at that time, which is still to come.
TEST_F(SerialBus, AnAnswerThatNobodyWaitsForMayComeWhileAnotherUnitIsAskedTheSame) {
  const RegisterRead read{
      .address = 7, .kind = RegisterKind::input, .first = 0, .count = 2, .timeout = answer_timeout};
  request(8);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), std::nullopt);
  EXPECT_GE(bus().read_free_at(read, now_), now_ + late_answer_max);
  say(two_registers(8, 2));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 2);
}

TEST_F(SerialBus, WhatMayBeLeftOutIsAnotherWayToAsk) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  request(7, read_holding_registers);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  become_ready();
  bus().start_read({.address = 7, .first = 0, .count = 2, .timeout = answer_timeout, .spare = 1},
                   now_);
  EXPECT_EQ(take(rtu_read_request_bytes), rtu_of(7, {4, 0, 1, 0, 1}));
  say(two_registers(7, 1));
  EXPECT_EQ(result(), std::nullopt);
  say(rtu_of(7, {4, 2, 0, 5}));
  BusAnswer answer;
  ASSERT_TRUE(bus().take_answer(answer));
  EXPECT_EQ(answer.result, BusResult::ok);
  EXPECT_EQ(answer.left_out, 1);
  ASSERT_EQ(answer.registers.size(), 1u);
  EXPECT_EQ(answer.registers[0], 5);
}

// An exception does not tell which question it is for: the answer to the other may come still.
TEST_F(SerialBus, AnExceptionThatMayBeForAnEarlierQuestionSettlesNothing) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  request(7, read_holding_registers);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  become_ready();
  const RegisterRead read{
      .address = 7, .first = 0, .count = 2, .timeout = answer_timeout, .spare = 1};
  bus().start_read(read, now_);
  take(rtu_read_request_bytes);
  say(rtu_of(7, {0x84, 2}));
  EXPECT_EQ(result(), BusResult::exception);
  become_ready();
  bus().start_read(read, now_);
  EXPECT_EQ(take(rtu_read_request_bytes), rtu_of(7, {3, 0, 1, 0, 1}));
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  // So neither does a late one.
  say(rtu_of(7, {0x84, 2}));
  become_ready();
  EXPECT_GT(bus().read_free_at(read, now_), now_);
}

TEST_F(SerialBus, AUnitThatTakesLongerThanFiveSecondsOwesItsAnswersForLonger) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  pass(8s);
  say(two_registers(7, 1));
  const RegisterRead read{
      .address = 7, .first = 0, .count = 2, .timeout = answer_timeout, .spare = 0};
  request(7, read_holding_registers);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  pass(late_silence_max);
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  pass(8s);
  EXPECT_GT(bus().read_free_at(read, now_), now_);
  pass(5s);
  EXPECT_LE(bus().read_free_at(read, now_), now_);
}

TEST_F(SerialBus, HalfAnAnswerThatCameTooLateDoesNotSpoilTheNext) {
  request(7);
  Bytes half = two_registers(7, 1);
  half.resize(5);
  say(half);
  EXPECT_EQ(wait_in_vain(), BusResult::bad_answer);
  expect_health();
}

TEST_F(SerialBus, WhatWasWrongBeforeIsNotSaidOfTheNextRequest) {
  request(9);
  say(two_registers(5, 1));
  EXPECT_EQ(wait_in_vain(), BusResult::bad_answer);
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
}

TEST_F(SerialBus, WithHalfOfItsWaysOwedTheOthersAreAskedInTurn) {
  const RegisterRead read{.address = 9, .first = 0, .count = 2, .timeout = answer_timeout};
  become_ready();
  EXPECT_LE(bus().read_free_at(read, now_), now_);
  request(9);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  // Two ways: the second is asked half the time later in which an answer may come.
  const Instant free_at = bus().read_free_at(read, now_);
  EXPECT_GT(free_at, now_ + late_answer_max / 2 - 500ms);
  EXPECT_LE(free_at, now_ + late_answer_max / 2);
}

TEST_F(SerialBus, WhatLiesThereBeforeARequestIsThrownAway) {
  become_ready();
  const Bytes stale = two_registers(7, 1);
  ASSERT_GT(::write(cable_->descriptor(), stale.data(), stale.size()), 0);
  request(7);
  say(two_registers(7, 2));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 2);
}

TEST_F(SerialBus, AfterAWaitInVainTheLineIsQuiet) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  EXPECT_FALSE(bus().ready());
  EXPECT_EQ(bus().next_deadline(), now_ + quiet);
  pass(quiet);
  EXPECT_TRUE(bus().ready());
}

TEST_F(SerialBus, TheQuietEndsWithTheLateAnswer) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  pass(1ms);
  say(two_registers(7, 1));
  pass(5ms);
  EXPECT_TRUE(bus().ready());
  EXPECT_EQ(log_.lines.back().find("bus yard: unit 7 answered too late, after 1"), 0u)
      << log_.lines.back();
}

TEST_F(SerialBus, AUnitThatOnceWasSlowGetsALongerQuiet) {
  miss_after_a_slow_answer();
  pass(quiet + 200ms);
  EXPECT_FALSE(bus().ready()) << "it may still answer";
  pass(200ms);
  EXPECT_TRUE(bus().ready());
}

TEST_F(SerialBus, TheQuietIsNotEndedByWhatIsNotOwed) {
  miss_after_a_slow_answer();
  say(rtu_of(7, {read_input_registers, 2, 0, 1}));
  pass(quiet + 100ms);
  EXPECT_FALSE(bus().ready()) << "it may still answer";
}

TEST_F(SerialBus, AUnitThatWasOnceVeryLateCostsTheOthersLittle) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  pass(9s);
  say(two_registers(7, 1));
  // It misses again and again, without a late answer.
  Duration silences{};
  become_ready();
  for (int miss = 0; miss < 20; ++miss) {
    const RegisterRead read{.address = 7, .first = 0, .count = 2, .timeout = answer_timeout};
    pass(std::max(bus().read_free_at(read, now_) - now_, Duration{}));
    bus().start_read(read, now_);
    take(rtu_read_request_bytes);
    now_ = bus().next_deadline();
    bus().advance(now_);
    BusAnswer missed;
    ASSERT_TRUE(bus().take_answer(missed));
    EXPECT_EQ(missed.result, BusResult::timeout);
    EXPECT_EQ(now_ + missed.silence, bus().next_deadline()) << "what it costs is told";
    EXPECT_LE(missed.silence, late_silence_max);
    silences += missed.silence;
    pass(missed.silence);
    ASSERT_TRUE(bus().ready());
  }
  EXPECT_LE(silences, 20 * quiet + 2 * late_silence_max) << "it is forgotten";
}

// A terminal keeps 4 KiB for its reader; what is beyond waits at the sender's side, as in the
// driver of an adapter that hangs.
TEST_F(SerialBus, WhatNeverWentOutIsThrownAway) {
  const std::array<std::uint16_t, write_registers_max> values{};
  std::size_t sent = 0;
  for (; sent < 16384; sent += rtu_write_request_bytes(write_registers_max)) {
    become_ready();
    bus().start_write({.address = 7, .first = 200, .values = values, .timeout = answer_timeout},
                      now_);
    pass(1s);
    EXPECT_EQ(result(), BusResult::timeout);
  }
  bus_.reset();  // and its port is closed
  std::size_t arrived = 0;
  pollfd readable{.fd = cable_->descriptor(), .events = POLLIN, .revents = 0};
  while (::poll(&readable, 1, 100) == 1) {
    std::uint8_t chunk[4096];
    const ssize_t count = ::read(cable_->descriptor(), chunk, sizeof chunk);
    if (count <= 0) break;
    arrived += static_cast<std::size_t>(count);
  }
  EXPECT_LE(arrived, 8192u) << "of " << sent;
}

struct Misbehaviour {
  const char* name;
  Bytes bytes;
};
class SerialBusSurvives : public SerialBus, public testing::WithParamInterface<Misbehaviour> {};

TEST_P(SerialBusSurvives, ItsOwnTimeOnly) {
  expect_health();
  request(7);
  const Instant asked = now_;
  say(GetParam().bytes);
  std::optional<BusResult> found;
  while (!(found = result()) && now_ < asked + 1s) pass(1ms);
  EXPECT_EQ(found, GetParam().bytes.empty() ? BusResult::timeout : BusResult::bad_answer);
  const Duration on_the_line =
      17 * character_time({.path = {}, .baud = 9600}) + frame_silence({.path = {}, .baud = 9600});
  EXPECT_LE(now_ - asked, on_the_line + answer_timeout + 1ms) << "waited for once";
  const Instant over = now_;
  become_ready();
  EXPECT_LE(now_ - over, quiet + 5ms);
  expect_health();
}

Bytes garbled() {
  Bytes bytes = two_registers(7, 1);
  bytes[4] ^= 0x10;
  return bytes;
}
Bytes truncated() {
  Bytes bytes = two_registers(7, 1);
  bytes.pop_back();
  return bytes;
}
INSTANTIATE_TEST_SUITE_P(
    Rows, SerialBusSurvives,
    testing::Values(Misbehaviour{"dead", {}}, Misbehaviour{"garbled", garbled()},
                    Misbehaviour{"truncated", truncated()},
                    Misbehaviour{"wrong_unit", two_registers(8, 1)},
                    Misbehaviour{"wrong_length", rtu_of(7, {4, 2, 0, 1})},
                    Misbehaviour{"wrong_function", two_registers(7, 1, read_holding_registers)},
                    Misbehaviour{"noise", Bytes(300, 0x55)},
                    Misbehaviour{"identity", rtu_of(7, {43, 14, 1, 1, 0, 0, 1, 0, 2, 'A', 'B'})},
                    Misbehaviour{"diagnostics", rtu_of(7, {8, 0, 0, 1, 2})},
                    Misbehaviour{"all_zero", Bytes(40, 0)}),
    [](const auto& row) { return std::string(row.param.name); });

TEST_F(SerialBus, AnExceptionComesWithItsCodeAtOnce) {
  request(7);
  say(rtu_of(7, {0x84, 11}));
  EXPECT_EQ(result(), BusResult::exception);
  EXPECT_EQ(exception_, 11);
  expect_health();
}

TEST_F(SerialBus, AUnitWithoutTheOtherFunctionIsAskedWithTheFirstAgain) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  request(7, read_holding_registers);
  say(rtu_of(7, {0x83, 1}));
  EXPECT_EQ(result(), BusResult::exception);
  pass(late_answer_max);
  for (int question = 0; question < 2; ++question) {
    request(7, read_input_registers);
    EXPECT_EQ(wait_in_vain(), BusResult::timeout);
    pass(late_answer_max);
  }
}

TEST_F(SerialBus, AUnitThatIsBusyIsAskedInBothWaysStill) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  request(7, read_holding_registers);
  say(rtu_of(7, {0x83, 6}));
  EXPECT_EQ(result(), BusResult::exception);
  pass(late_answer_max);
  request(7, read_holding_registers);
  say(two_registers(7, 3, read_holding_registers));
  EXPECT_EQ(result(), BusResult::ok);
}

TEST_F(SerialBus, NoiseBeforeAnAnswerAndAnEchoOfTheRequestAreSkipped) {
  request(7);
  say({0xff, 0, 7, 4, 4});
  say(rtu_of(7, {read_input_registers, 0, 0, 0, 2}));
  say(two_registers(7, 3));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 3);
}

// The answer stands where the room for what is heard ends.
TEST_F(SerialBus, MoreNoiseThanThereIsRoomForDoesNotHideAnAnswer) {
  request(7);
  Bytes bytes(RtuLine::heard_bytes_max - 4, 0);
  const Bytes answer = two_registers(7, 5);
  bytes.insert(bytes.end(), answer.begin(), answer.end());
  say(bytes);
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 5);
}

TEST_F(SerialBus, ABabblerDoesNotKeepTheLineForEver) {
  become_ready();
  int turns = 0;
  do {
    const Bytes babble(3, 0x55);
    ASSERT_EQ(::write(cable_->descriptor(), babble.data(), babble.size()), 3);
    loop_.wait(patience);  // until something is heard
    pass(1ms);
  } while (!bus().ready() && ++turns < 2000);
  EXPECT_LT(turns, 2000);
}

TEST_F(SerialBus, AnUnpluggedPortComesBack) {
  expect_health();
  request(7);
  unplug();
  EXPECT_TRUE(turn_until(loop_, [&] {
    bus().advance(now_);
    return result() == BusResult::link_lost;
  }));
  pass(100ms);
  EXPECT_FALSE(bus().ready());
  plug_in();
  pass(100ms);
  expect_health();
  EXPECT_EQ(log_.lines.size(), 3u) << "opened, gone, opened";
}

TEST_F(SerialBus, WhatWasAskedWhenAPortWentMayBeAnsweredWhenItIsBack) {
  request(7);
  unplug();
  EXPECT_TRUE(turn_until(loop_, [&] {
    bus().advance(now_);
    return result() == BusResult::link_lost;
  }));
  plug_in();
  pass(100ms);
  become_ready();
  bus().start_read({.address = 7, .first = 0, .count = 2, .timeout = answer_timeout}, now_);
  EXPECT_EQ(take(rtu_read_request_bytes), rtu_of(7, {read_holding_registers, 0, 0, 0, 2}))
      << "the other way is free";
}

TEST_F(SerialBus, ATransceiverIsLeftListeningWhereAPortGoes) {
  send_enable_ = DigitalLine{0};
  become_ready();
  bus().start_read({.address = 7, .first = 0, .count = 2, .timeout = answer_timeout}, now_);
  EXPECT_TRUE(lines_.active);
  unplug();
  EXPECT_TRUE(turn_until(loop_, [&] {
    bus().advance(now_);
    return result() == BusResult::link_lost;
  }));
  EXPECT_FALSE(lines_.active);
}

TEST_F(SerialBus, APortThatIsNotThereIsTriedAgainAndSaidOnce) {
  unplug();
  for (int attempt = 0; attempt < 4; ++attempt) {
    pass(100ms);
    EXPECT_FALSE(bus().ready());
  }
  ASSERT_EQ(log_.lines.size(), 1u);
  EXPECT_NE(log_.lines[0].find(path_), std::string::npos) << log_.lines[0];
  plug_in();
  pass(100ms);
  expect_health();
}

TEST_F(SerialBus, ADriverThatCannotSwitchIsSaidWithTheCure) {
  RtuBus bus(loop_, log_,
             {.name = "yard",
              .serial_line = {.path = path_, .rs485 = {.mode = Rs485Mode::on}},
              .reopen_interval = 1s,
              .send_enable = {}});
  bus.advance(now_);
  EXPECT_FALSE(bus.ready());
  EXPECT_NE(log_.lines.back().find("TIOCGRS485"), std::string::npos) << log_.lines.back();
  EXPECT_NE(log_.lines.back().find("take `rs485` out"), std::string::npos) << log_.lines.back();
}

TEST_F(SerialBus, ALineSwitchesTheTransceiverWhileBytesGoOut) {
  send_enable_ = DigitalLine{0};
  request(7);
  EXPECT_TRUE(lines_.active);
  const Duration sending = 8 * character_time({.path = {}, .baud = 9600});
  EXPECT_EQ(bus().next_deadline(), now_ + sending);
  pass(sending);
  EXPECT_FALSE(lines_.active);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_FALSE(lines_.active);
}

Bytes written(std::uint8_t unit, std::uint8_t first = 200, std::uint8_t count = 2) {
  return rtu_of(unit, {16, 0, first, 0, count});
}

TEST_F(SerialBus, WritesRegisters) {
  write(7);
  say(written(7));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, -1);
  EXPECT_EQ(ticket_, 99u);
  expect_health(7);
  EXPECT_EQ(ticket_, 0u);
}

TEST_F(SerialBus, TimeOfTheBytesOfAWriteIsNotTheUnits) {
  write(7);
  const Duration bytes = (rtu_write_request_bytes(2) + rtu_write_answer_bytes) *
                         character_time({.path = {}, .baud = 9600});
  pass(bytes + answer_timeout);
  EXPECT_EQ(result(), std::nullopt);
  pass(5ms);
  EXPECT_EQ(result(), BusResult::timeout);
  EXPECT_EQ(bus().next_deadline(), now_ + quiet);
}

TEST_F(SerialBus, ALateAnswerToAWriteIsNoAnswerToAReadOrToAnotherWrite) {
  write(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  request(7);  // with the same function as ever: a write says nothing about reading
  say(written(7));
  EXPECT_EQ(result(), std::nullopt);
  say(two_registers(7, 5));
  EXPECT_EQ(result(), BusResult::ok);
  write(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  write(7, 210);
  say(written(7, 200));
  EXPECT_EQ(result(), std::nullopt);
  say(written(7, 210));
  EXPECT_EQ(result(), BusResult::ok);
}

TEST_F(SerialBus, TheSameWriteWaitsUntilTheLastOneCannotBeAnsweredAnyMore) {
  write(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  EXPECT_GT(bus().write_free_at(7), now_);
  EXPECT_LE(bus().write_free_at(8), now_);
  become_ready();
  const std::array<std::uint16_t, 2> values{7, 9};
  bus().start_write({.address = 7, .first = 200, .values = values, .timeout = answer_timeout},
                    now_);
  EXPECT_EQ(result(), BusResult::timeout) << "at once: it is not sent";
  pass(late_answer_max);
  EXPECT_LE(bus().write_free_at(7), now_);
  write(7);
  say(written(7));
  EXPECT_EQ(result(), BusResult::ok);
}

TEST_F(SerialBus, ALateAnswerToAReadIsNoAnswerToAWrite) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  write(7);
  say(two_registers(7, 5));
  EXPECT_EQ(result(), std::nullopt);
  say(written(7));
  EXPECT_EQ(result(), BusResult::ok);
}

TEST_F(SerialBus, AnExceptionToAWriteSaysNothingAboutReading) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  write(7);
  say(rtu_of(7, {0x90, 2}));
  EXPECT_EQ(result(), BusResult::exception);
  EXPECT_EQ(exception_, 2);
  request(7, read_holding_registers);
  say(two_registers(7, 5, read_holding_registers));
  EXPECT_EQ(result(), BusResult::ok);
}

class SerialBusSurvivesToAWrite : public SerialBus,
                                  public testing::WithParamInterface<Misbehaviour> {};

TEST_P(SerialBusSurvivesToAWrite, ItsOwnTimeOnly) {
  expect_health();
  write(7);
  say(GetParam().bytes);
  EXPECT_EQ(wait_in_vain(), BusResult::bad_answer);
  expect_health();
  write(7, 210);
  say(written(7, 210));
  EXPECT_EQ(result(), BusResult::ok);
}

Bytes garbled_answer() {
  Bytes bytes = written(7);
  bytes[3] ^= 0x10;
  return bytes;
}
INSTANTIATE_TEST_SUITE_P(Rows, SerialBusSurvivesToAWrite,
                         testing::Values(Misbehaviour{"garbled", garbled_answer()},
                                         Misbehaviour{"truncated", {7, 16, 0, 200, 0}},
                                         Misbehaviour{"wrong_unit", written(8)},
                                         Misbehaviour{"wrong_first", written(7, 201)},
                                         Misbehaviour{"wrong_count", written(7, 200, 1)},
                                         Misbehaviour{"a_read", two_registers(7, 1)},
                                         Misbehaviour{"single_write", rtu_of(7, {6, 0, 200, 0, 7})},
                                         Misbehaviour{
                                             "echo", rtu_of(7, {16, 0, 200, 0, 2, 4, 0, 7, 0, 8})}),
                         [](const auto& row) { return std::string(row.param.name); });

TEST_F(SerialBus, ALineSwitchesTheTransceiverForAllBytesOfAWrite) {
  send_enable_ = DigitalLine{0};
  write(7);
  EXPECT_TRUE(lines_.active);
  const Duration sending = rtu_write_request_bytes(2) * character_time({.path = {}, .baud = 9600});
  pass(sending - 1us);
  EXPECT_TRUE(lines_.active);
  pass(1us);
  EXPECT_FALSE(lines_.active);
  say(written(7));
  EXPECT_EQ(result(), BusResult::ok);
}

TEST_F(SerialBus, TheMostRegistersGoOutInOneFrame) {
  become_ready();
  std::array<std::uint16_t, write_registers_max> values{};
  bus().start_write({.address = 7, .first = 200, .values = values, .timeout = answer_timeout},
                    now_);
  const Bytes bytes = take(rtu_write_request_bytes(write_registers_max));
  EXPECT_EQ(bytes.size(), 255u);
  EXPECT_TRUE(is_rtu_frame(bytes));
  say(written(7, 200, write_registers_max));
  EXPECT_EQ(result(), BusResult::ok);
}

TEST_F(SerialBus, AnUnpluggedPortEndsAWrite) {
  write(7);
  unplug();
  EXPECT_TRUE(turn_until(loop_, [&] {
    bus().advance(now_);
    return result() == BusResult::link_lost;
  }));
}

// ---- Requests of those who share the line.

class SharedSerialBus : public SerialBus {
 protected:
  static UnitRequest of_client(std::uint8_t unit, const Bytes& pdu) {
    return {.address = unit, .pdu = pdu, .timeout = answer_timeout, .ticket = 5};
  }
  bool may_ask(std::uint8_t unit, const Bytes& pdu) {
    return bus().request_free_at(of_client(unit, pdu), now_) <= now_;
  }
  void ask(std::uint8_t unit, const Bytes& pdu) {
    become_ready();
    ASSERT_TRUE(may_ask(unit, pdu));
    bus().start_request(of_client(unit, pdu), now_);
    const Bytes frame = rtu_of(unit, pdu);
    EXPECT_EQ(take(frame.size()), frame);
  }
  void ask_in_vain(std::uint8_t unit, const Bytes& pdu) {
    ask(unit, pdu);
    pass(1s);
    EXPECT_EQ(result(), BusResult::timeout);
  }
  // The PDU of its answer; empty where there is none.
  Bytes answer() {
    BusAnswer found;
    if (!bus().take_answer(found)) return {};
    result_ = found.result;
    exception_ = found.exception;
    EXPECT_EQ(found.ticket, 5u);
    return {found.pdu.begin(), found.pdu.end()};
  }

  const Bytes two_{4, 0, 0, 0, 2};  // as request() asks
  BusResult result_ = BusResult::timeout;
};

TEST_F(SharedSerialBus, HasItsAnswerAsTheUnitGaveIt) {
  const std::pair<Bytes, Bytes> rows[] = {
      {{1, 0, 0, 0, 9}, {1, 2, 0x55, 1}},
      {{4, 0, 0, 0, 2}, {4, 4, 0, 1, 0, 2}},
      {{6, 0, 1, 0, 7}, {6, 0, 1, 0, 7}},
      {{22, 0, 4, 0, 0xf2, 0, 0x25}, {22, 0, 4, 0, 0xf2, 0, 0x25}},
      {{23, 0, 3, 0, 1, 0, 14, 0, 1, 2, 0, 255}, {23, 2, 0, 7}},
      {{17}, {17, 3, 'E', 0xff, '!'}},
      {{43, 14, 1, 0}, {43, 14, 1, 0x81, 0, 0, 1, 0, 1, 'A'}},
      {{3, 0, 0, 0, 1}, {0x83, 2}},
  };
  for (const auto& [pdu, answered] : rows) {
    ask(7, pdu);
    say(rtu_of(7, answered));
    EXPECT_EQ(answer(), answered);
    const bool is_exception = (answered[0] & 0x80) != 0;
    EXPECT_EQ(result_, is_exception ? BusResult::exception : BusResult::ok);
    EXPECT_EQ(exception_, is_exception ? answered[1] : 0);
  }
}

// The gateway asks in either way afterwards: an exception to a client says nothing of its own
// registers.
TEST_F(SharedSerialBus, AnExceptionToAClientSaysNothingAboutReading) {
  ask(7, {3, 0x40, 0, 0, 1});
  say(rtu_of(7, {0x83, 2}));
  EXPECT_EQ(answer(), (Bytes{0x83, 2}));
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  request(7, read_holding_registers);
}

TEST_F(SharedSerialBus, ALateAnswerToAClientNeverBecomesData) {
  ask_in_vain(7, two_);
  // The gateway asks in its other way.
  request(7, read_holding_registers);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), std::nullopt);
  say(two_registers(7, 2, read_holding_registers));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 2);
}

TEST_F(SharedSerialBus, AReadWithOneWayWaitsForTheLateAnswerToAClient) {
  ask_in_vain(7, two_);
  const RegisterRead read{.address = 7, .kind = RegisterKind::input, .first = 0, .count = 2};
  EXPECT_GT(bus().read_free_at(read, now_), now_ + 3s);
  say(two_registers(7, 1));
  EXPECT_LE(bus().read_free_at(read, now_), now_) << "it has come";
}

TEST_F(SharedSerialBus, ALateAnswerToTheGatewayNeverGoesToAClient) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  EXPECT_FALSE(may_ask(7, two_));
  EXPECT_TRUE(may_ask(7, {4, 0, 0, 0, 3})) << "another length";
  EXPECT_TRUE(may_ask(8, two_)) << "another unit";
  become_ready();
  bus().start_request(of_client(7, two_), now_);
  EXPECT_EQ(result(), BusResult::timeout) << "it is not sent";
  ask(7, {4, 0, 0, 0, 1});
  say(two_registers(7, 1));
  EXPECT_EQ(answer(), Bytes{});
  say(rtu_of(7, {4, 2, 0, 9}));
  EXPECT_EQ(answer(), (Bytes{4, 2, 0, 9}));
}

TEST_F(SharedSerialBus, ALateAnswerToAClientNeverGoesToTheNext) {
  ask_in_vain(7, {6, 0, 1, 0, 7});
  EXPECT_FALSE(may_ask(7, {6, 0, 1, 0, 7}));
  ask(7, {6, 0, 1, 0, 8});
  say(rtu_of(7, {6, 0, 1, 0, 7}));
  EXPECT_EQ(answer(), Bytes{});
  say(rtu_of(7, {6, 0, 1, 0, 8}));
  EXPECT_EQ(answer(), (Bytes{6, 0, 1, 0, 8}));
}

TEST_F(SharedSerialBus, WhereTwoAnswerAllThatClientsWereAnsweredMayBeAnsweredOnceMore) {
  const Bytes one{4, 0, 0, 0, 1}, three{4, 0, 0, 0, 3};
  ask(7, one);
  say(rtu_of(7, {4, 2, 0, 9}));
  EXPECT_EQ(answer(), (Bytes{4, 2, 0, 9}));
  ask(7, three);
  say(rtu_of(7, {0x84, 2}));
  EXPECT_EQ(answer(), (Bytes{0x84, 2}));
  ask(7, two_);
  say(two_registers(7, 1));
  EXPECT_EQ(answer(), (Bytes{4, 4, 0, 1, 0, 1}));
  EXPECT_TRUE(may_ask(7, one)) << "nothing is known of another one";
  pass(300ms);
  say(two_registers(7, 2));
  EXPECT_EQ(answer(), Bytes{});
  EXPECT_FALSE(may_ask(7, two_));
  EXPECT_FALSE(may_ask(7, one));
  EXPECT_TRUE(may_ask(7, three)) << "it was refused";
}

// It may be the earlier question's; then the answer is still to come.
TEST_F(SharedSerialBus, AnExceptionThatMayBeForAnEarlierQuestionIsNotHandedOver) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  ask(7, {4, 0, 0, 0, 1});
  say(rtu_of(7, {0x84, 2}));
  EXPECT_EQ(answer(), Bytes{});
  say(rtu_of(7, {4, 2, 0, 9}));
  EXPECT_EQ(answer(), (Bytes{4, 2, 0, 9}));
  // And what was owed may come yet: the exception may have been to this one.
  EXPECT_FALSE(may_ask(7, two_));
}

TEST_F(SharedSerialBus, AUnitOwesClientsFewAnswersSoThatItsRegistersCanBeRead) {
  const Instant begin = now_;
  ask_in_vain(7, {4, 0, 0, 0, 30});
  ask_in_vain(7, {4, 0, 0, 0, 31});
  EXPECT_FALSE(may_ask(7, {4, 0, 0, 0, 32}));
  EXPECT_FALSE(may_ask(7, {17}));
  EXPECT_TRUE(may_ask(8, {17}));
  // What it has not answered once is asked again only in twice the time.
  while (!may_ask(7, {4, 0, 0, 0, 32})) pass(10ms);
  EXPECT_GE(now_ - begin, late_answer_max);
  EXPECT_FALSE(may_ask(7, {4, 0, 0, 0, 30}));
  while (!may_ask(7, {4, 0, 0, 0, 30})) pass(10ms);
  EXPECT_GE(now_ - begin, 2 * late_answer_max);
  EXPECT_LE(now_ - begin, 2 * late_answer_max + 2s);
}

// FC 17 tells its own length, up to more than a client's frame can hold.
TEST_F(SharedSerialBus, AnAnswerThatIsTooLongForAFrameIsNone) {
  ask(7, {17});
  Bytes pdu(2 + 253, 'x');
  pdu[0] = 17;
  pdu[1] = 253;
  Bytes bytes(1 + pdu.size() + 2);
  bytes[0] = 7;
  std::copy(pdu.begin(), pdu.end(), bytes.begin() + 1);
  const std::uint16_t checksum = rtu_checksum(std::span(bytes).first(bytes.size() - 2));
  bytes[bytes.size() - 2] = static_cast<std::uint8_t>(checksum & 0xff);
  bytes[bytes.size() - 1] = static_cast<std::uint8_t>(checksum >> 8);
  say(bytes);
  EXPECT_EQ(answer(), Bytes{});
}

// Who watches over the bus takes that for no standstill.
TEST_F(SharedSerialBus, TheBytesOfALongAnswerHaveTheirTime) {
  ask(7, {3, 0, 0, 0, 125});
  const Instant asked = now_;
  pass(answer_timeout + 250ms);
  EXPECT_EQ(result(), std::nullopt);
  pass(100ms);
  EXPECT_EQ(result(), BusResult::timeout);
  EXPECT_LE(now_ - asked, answer_timeout + bus().delay_max());
}

TEST_F(SharedSerialBus, AnUnpluggedPortEndsIt) {
  ask(7, two_);
  EXPECT_TRUE(bus().is_up());
  unplug();
  EXPECT_TRUE(turn_until(loop_, [&] {
    bus().advance(now_);
    return !bus().is_up();
  }));
  EXPECT_EQ(result(), BusResult::link_lost);
}

}  // namespace
}  // namespace etcm::port
