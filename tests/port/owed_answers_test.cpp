// What a unit may still answer: what it may be asked meanwhile, and whose an answer is.
#include "modbus/owed_answers.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "peer.h"

namespace etcm::port {
namespace {

using std::chrono::seconds;

constexpr Instant start = Instant{} + std::chrono::hours(1);

RtuQuestion read(std::uint16_t count, std::uint8_t function = read_input_registers) {
  return {.function = function, .range = {.first = 0, .count = count}};
}

Bytes answer_to(const RtuQuestion& question) {
  Bytes pdu(answer_bytes(question));
  pdu[0] = question.function;
  pdu[1] = static_cast<std::uint8_t>(2 * question.range.count);
  return pdu;
}

Bytes exception_of(std::uint8_t function) {
  return {static_cast<std::uint8_t>(function | exception_bit), 2};
}

TEST(OwedAnswers, AQuestionIsFreeUnlessOneThatIsAnsweredAlikeIsOwed) {
  OwedAnswers owed;
  EXPECT_EQ(owed.free_at(read(2)), Instant{});
  owed.add(read(2), start, start + seconds(5));
  EXPECT_EQ(owed.free_at(read(2)), start + seconds(5));
  EXPECT_EQ(owed.asked_at(read(2)), start);
  EXPECT_EQ(owed.free_at(read(3)), Instant{});
  EXPECT_EQ(owed.asked_at(read(3)), std::nullopt);
  EXPECT_EQ(owed.free_at(read(2, read_holding_registers)), Instant{});
  owed.forget(read(3));
  EXPECT_EQ(owed.asked_at(read(2)), start);
  owed.forget(read(2));
  EXPECT_EQ(owed.free_at(read(2)), Instant{});
  EXPECT_EQ(owed.asked_at(read(2)), std::nullopt);
}

TEST(OwedAnswers, WithoutRoomToRememberAQuestionItWaitsForTheFirstThatEnds) {
  OwedAnswers owed;
  for (std::uint16_t i = 1; i <= OwedAnswers::count_max; ++i) {
    EXPECT_EQ(owed.free_at(read(100)), Instant{}) << i;
    owed.add(read(i), start, start + seconds(20 - i));
  }
  EXPECT_EQ(owed.free_at(read(100)), start + seconds(20 - OwedAnswers::count_max));
  owed.add(read(100), start, start + seconds(30));
  EXPECT_EQ(owed.asked_at(read(OwedAnswers::count_max)), std::nullopt)
      << "what ends first is forgotten for it";
  for (std::uint16_t i = 1; i < OwedAnswers::count_max; ++i) {
    EXPECT_EQ(owed.free_at(read(i)), start + seconds(20 - i));
  }
}

TEST(OwedAnswers, OneAskedAgainIsRememberedOnce) {
  OwedAnswers owed;
  for (int i = 0; i < 20; ++i) owed.add(read(1), start + seconds(i), start + seconds(i + 5));
  EXPECT_EQ(owed.asked_at(read(1)), start + seconds(19));
  owed.forget(read(1));
  EXPECT_EQ(owed.owed_until(read_input_registers), Instant{});
}

TEST(OwedAnswers, AFunctionIsOwedUntilTheLastOfItsQuestions) {
  OwedAnswers owed;
  owed.add(read(1), start, start + seconds(5));
  owed.add(read(2), start, start + seconds(9));
  owed.add(read(3), start, start + seconds(7));
  owed.add(read(1, read_holding_registers), start, start + seconds(20));
  EXPECT_EQ(owed.owed_until(read_input_registers), start + seconds(9));
  EXPECT_EQ(owed.owed_until(read_holding_registers), start + seconds(20));
  EXPECT_EQ(owed.owed_until(write_holding_registers), Instant{});
}

TEST(OwedAnswers, AnAnswerIsTakenOnceForWhatItAnswers) {
  OwedAnswers owed;
  owed.add(read(1), start, start + seconds(5));
  owed.add(read(2), start + seconds(1), start + seconds(6));
  EXPECT_EQ(owed.take(answer_to(read(3)), start + seconds(2)), std::nullopt);
  EXPECT_EQ(owed.take(answer_to(read(1, read_holding_registers)), start), std::nullopt);
  EXPECT_EQ(owed.take(answer_to(read(2)), start + seconds(2)), start + seconds(1));
  EXPECT_EQ(owed.free_at(read(2)), Instant{});
  EXPECT_EQ(owed.asked_at(read(2)), start + seconds(1)) << "that it was in vain is known";
  EXPECT_EQ(owed.take(answer_to(read(2)), start + seconds(2)), std::nullopt);
  EXPECT_EQ(owed.free_at(read(1)), start + seconds(5));
}

TEST(OwedAnswers, AnExceptionIsTakenWhereItCanBeForOneQuestionAlone) {
  OwedAnswers owed;
  owed.add(read(1), start, start + seconds(5));
  EXPECT_EQ(owed.take(exception_of(read_holding_registers), start), std::nullopt);
  owed.add(read(2), start, start + seconds(5));
  EXPECT_EQ(owed.take(exception_of(read_input_registers), start), std::nullopt);
  EXPECT_EQ(owed.free_at(read(1)), start + seconds(5));
  EXPECT_EQ(owed.take(answer_to(read(1)), start), start);
  EXPECT_EQ(owed.take(exception_of(read_input_registers), start), start);
  EXPECT_EQ(owed.free_at(read(2)), Instant{});
}

TEST(OwedAnswers, WhatWasOwedUntilAMinuteAgoIsAnsweredNoMore) {
  for (const bool is_in_time : {true, false}) {
    OwedAnswers owed;
    owed.add(read(1), start, start + seconds(5));
    const Instant last = start + seconds(5) + late_answer_longest;
    const Instant now = is_in_time ? last : last + Duration{1};
    EXPECT_EQ(owed.take(answer_to(read(1)), now).has_value(), is_in_time);
  }
}

TEST(OwedAnswers, OneThatWasAnsweredIsFreeAsLongAsOneUnitAnswers) {
  OwedAnswers owed;
  owed.note_answered(read(1), start, start + seconds(1), late_answer_max);
  EXPECT_EQ(owed.free_at(read(1)), Instant{});
  EXPECT_EQ(owed.asked_at(read(1)), std::nullopt) << "it was not in vain";
  EXPECT_EQ(owed.take(answer_to(read(1)), start + seconds(1)), std::nullopt);
}

TEST(OwedAnswers, WhatNobodyAskedForMayComeOnceMore) {
  OwedAnswers owed;
  owed.add_unasked(read(1), start, late_answer_max);
  EXPECT_EQ(owed.free_at(read(1)), start + late_answer_max);
  EXPECT_EQ(owed.take(answer_to(read(1)), start), std::nullopt) << "it tells no latency";
  EXPECT_EQ(owed.free_at(read(2)), Instant{});
}

// Asked at `start`, answered, and answered again so much later.
OwedAnswers answered_twice(Duration later) {
  OwedAnswers owed;
  owed.note_answered(read(2), start, start + seconds(1), late_answer_max);
  owed.note_answered(read(1), start, start + seconds(1), late_answer_max);
  owed.add(read(3), start, start + seconds(2));
  owed.add_unasked(read(1), start + later, late_answer_max);
  return owed;
}

TEST(OwedAnswers, WhereTwoAnswerAllThatWasAnsweredMayBeAnsweredOnceMore) {
  OwedAnswers owed = answered_twice(late_answer_max);
  const Instant now = start + late_answer_max;
  EXPECT_EQ(owed.free_at(read(1)), now + late_answer_max);
  EXPECT_EQ(owed.free_at(read(2)), now + late_answer_max);
  EXPECT_EQ(owed.free_at(read(3)), start + seconds(2)) << "it was not answered";
  // And so may what is answered in the next minute.
  const Instant last = now + doubled_for - Duration{1};
  owed.note_answered(read(7), last, last, late_answer_max);
  EXPECT_EQ(owed.free_at(read(7)), last + late_answer_max);
  owed.note_answered(read(8), now + doubled_for, now + doubled_for, late_answer_max);
  EXPECT_EQ(owed.free_at(read(8)), Instant{});
}

TEST(OwedAnswers, AnAnswerLongAfterAnotherIsNoSecondOneToIt) {
  OwedAnswers owed = answered_twice(late_answer_max + Duration{1});
  EXPECT_EQ(owed.free_at(read(1)), start + late_answer_max + Duration{1} + late_answer_max);
  EXPECT_EQ(owed.free_at(read(2)), Instant{});
}

}  // namespace
}  // namespace etcm::port
