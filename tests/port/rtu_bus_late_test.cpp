// The RTU bus against units that answer late: no answer is taken for one to another question.
#include "serial_bus.h"

namespace etcm::port {
namespace {

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

TEST_F(SerialBus, AfterALateAnswerTheLineHasItsSilence) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  pass(1ms);
  say(two_registers(7, 1));
  const Duration silence = frame_silence({.path = {}, .baud = 9600});
  EXPECT_FALSE(bus().ready());
  EXPECT_EQ(bus().next_deadline(), now_ + silence);
  pass(silence);
  EXPECT_TRUE(bus().ready());
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

}  // namespace
}  // namespace etcm::port
