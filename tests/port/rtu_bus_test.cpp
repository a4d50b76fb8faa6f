// The RTU bus against units that answer wrongly or not at all, and a line that comes and goes.
#include "serial_bus.h"

namespace etcm::port {
namespace {

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

// One value in 65536 has that, and stays what it is.
TEST_F(SerialBus, AnAnswerThatHoldsWhatLooksLikeAFrameMayComeByteByByte) {
  become_ready();
  bus().start_read({.address = 7,
                    .kind = RegisterKind::holding,
                    .first = 0,
                    .count = 3,
                    .timeout = answer_timeout},
                   now_);
  take(rtu_read_request_bytes);
  Bytes pdu{read_holding_registers, 6, 0};
  const Bytes within = rtu_of(84, {0x81, 2});
  pdu.insert(pdu.end(), within.begin(), within.end());
  for (const std::uint8_t byte : rtu_of(7, pdu)) {
    EXPECT_EQ(result(), std::nullopt);
    say({byte});
  }
  EXPECT_EQ(result(), BusResult::ok);
}

// What has begun and does not go on takes nothing away from whom else the line belongs to.
TEST_F(SerialBus, AnAnswerThatBreaksOffHidesNoLateOne) {
  request(3);
  while (!result()) pass(1ms);
  request(7);
  const Bytes whole = two_registers(7, 42);
  say(Bytes(whole.begin(), whole.begin() + 4));
  say(two_registers(3, 41));
  while (!result()) pass(1ms);
  EXPECT_NE(log_.lines.back().find("unit 3 answered too late"), std::string::npos);
}

// Only the unit that was asked has begun its answer.
TEST_F(SerialBus, WhatAnotherUnitBeginsHidesNoLateException) {
  request(3);
  while (!result()) pass(1ms);
  request(7);
  say({9, read_input_registers, 4});
  say(rtu_of(3, {read_input_registers | 0x80, 2}));
  EXPECT_NE(log_.lines.back().find("unit 3 answered too late"), std::string::npos);
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

// Before anything else says that it has gone.
TEST_F(SerialBus, APortThatTakesNoRequestHasGone) {
  become_ready();
  unplug();
  bus().start_read({.address = 7, .first = 0, .count = 2, .timeout = answer_timeout}, now_);
  EXPECT_EQ(result(), BusResult::link_lost);
  EXPECT_FALSE(bus().ready());
  EXPECT_NE(log_.lines.back().find("Input/output error"), std::string::npos) << log_.lines.back();
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

}  // namespace
}  // namespace etcm::port
