// What clients of a shared bus may send, and what counts as the answer to it.
#include "modbus/client_request.h"

#include <gtest/gtest.h>

#include <random>

#include "modbus/question.h"
#include "modbus/rtu_frame.h"
#include "peer.h"

namespace etcm::port {
namespace {

ClientRules rules_for(bool may_write) {
  ClientRules rules{.units = {}, .may_write = may_write};
  for (std::size_t unit = 1; unit <= 10; ++unit) rules.units.set(unit);
  return rules;
}

// Of `bytes` in all: the head, and zeros.
Bytes longer(Bytes head, std::size_t bytes) {
  head.resize(bytes);
  return head;
}

struct ClientRow {
  const char* name;
  Bytes pdu;
  std::uint8_t reading;  // the exception where nothing may be written
  std::uint8_t writing;
};

class JudgedRequest : public testing::TestWithParam<ClientRow> {};

TEST_P(JudgedRequest, IsJudged) {
  EXPECT_EQ(judge(1, GetParam().pdu, rules_for(false)), GetParam().reading);
  EXPECT_EQ(judge(1, GetParam().pdu, rules_for(true)), GetParam().writing);
  for (const auto nobody :
       {std::uint8_t{0}, std::uint8_t{11}, std::uint8_t{248}, std::uint8_t{255}}) {
    EXPECT_EQ(judge(nobody, GetParam().pdu, rules_for(true)), 0x0a) << int{nobody};
  }
}

INSTANTIATE_TEST_SUITE_P(
    Rows, JudgedRequest,
    testing::Values(
        ClientRow{"coils", {1, 0, 0, 7, 0xd0}, 0, 0},
        ClientRow{"coils_too_many", {1, 0, 0, 7, 0xd1}, 3, 3},
        ClientRow{"inputs_none", {2, 0, 0, 0, 0}, 3, 3},
        ClientRow{"holding", {3, 0xff, 0xff, 0, 125}, 0, 0},
        ClientRow{"holding_too_many", {3, 0, 0, 0, 126}, 3, 3},
        ClientRow{"input_short", {4, 0, 0, 0}, 3, 3},
        ClientRow{"input_long", {4, 0, 0, 0, 1, 0}, 3, 3},
        ClientRow{"input_function_alone", {4}, 3, 3},
        ClientRow{"coil_on", {5, 0, 1, 0xff, 0}, 1, 0},
        ClientRow{"coil_neither", {5, 0, 1, 0, 1}, 1, 3},
        ClientRow{"register", {6, 0, 1, 0, 1}, 1, 0}, ClientRow{"register_short", {6, 0, 1}, 1, 3},
        ClientRow{"coils_written", {15, 0, 0, 0, 9, 2, 1, 1}, 1, 0},
        ClientRow{"coils_written_short", {15, 0, 0, 0, 9, 2, 1}, 1, 3},
        ClientRow{"coils_written_miscounted", {15, 0, 0, 0, 9, 1, 1, 1}, 1, 3},
        ClientRow{"registers_written", {16, 0, 0, 0, 1, 2, 0, 1}, 1, 0},
        ClientRow{"registers_written_none", {16, 0, 0, 0, 0, 0}, 1, 3},
        ClientRow{"registers_written_most", longer({16, 0, 0, 0, 123, 246}, 252), 1, 0},
        ClientRow{"masked", {22, 0, 4, 0, 0xf2, 0, 0x25}, 1, 0},
        ClientRow{"masked_short", {22, 0, 4, 0, 0xf2, 0}, 1, 3},
        ClientRow{"both", {23, 0, 3, 0, 6, 0, 14, 0, 1, 2, 0, 255}, 1, 0},
        ClientRow{"both_too_many", longer({23, 0, 3, 0, 126, 0, 14, 0, 1, 2}, 12), 1, 3},
        ClientRow{"both_miscounted", longer({23, 0, 3, 0, 6, 0, 14, 0, 3, 2}, 16), 1, 3},
        ClientRow{"who", {17}, 0, 0}, ClientRow{"who_long", {17, 0}, 3, 3},
        ClientRow{"device", {43, 14, 1, 0}, 0, 0}, ClientRow{"device_short", {43, 14, 1}, 3, 3},
        ClientRow{"another_interface", {43, 13, 0, 0}, 1, 1},
        ClientRow{"diagnostics", {8, 0, 1, 0, 0}, 1, 1}, ClientRow{"nothing", {0}, 1, 1},
        ClientRow{"exception", {0x83, 2}, 1, 1}, ClientRow{"last", {255, 255}, 1, 1}),
    [](const auto& row) { return std::string(row.param.name); });

// Whatever it is, what may be sent has an answer that fits.
TEST(ClientRequest, WhateverIsSentHasAnAnswerThatFits) {
  std::mt19937 chance(11);
  int sent = 0;
  for (int round = 0; round < 300000; ++round) {
    Bytes pdu(1 + chance() % (chance() % 4 == 0 ? pdu_bytes_max : 8));
    for (auto& byte : pdu) byte = static_cast<std::uint8_t>(chance() % (chance() % 2 ? 8 : 256));
    constexpr std::uint8_t known[] = {1, 2, 3, 4, 5, 6, 15, 16, 17, 22, 23, 43};
    pdu[0] = known[chance() % std::size(known)];
    if (judge(1, pdu, rules_for(true)) != 0) continue;
    ++sent;
    ASSERT_LE(answer_bytes(question_of(pdu)), pdu_bytes_max);
    ASSERT_GE(answer_bytes(question_of(pdu)), 3u);
  }
  EXPECT_GT(sent, 3000);
}

struct AnsweredRow {
  Bytes request;
  Bytes answer;
  Bytes another;  // of the same function, to another request
};

TEST(Question, IsAnsweredByWhatFitsItAlone) {
  const AnsweredRow rows[] = {
      {{1, 0, 0, 0, 9}, {1, 2, 0xff, 1}, {1, 1, 0xff}},
      {{2, 0, 0, 0, 8}, {2, 1, 0xff}, {2, 2, 0xff, 1}},
      {{3, 0, 0, 0, 1}, {3, 2, 0, 7}, {3, 4, 0, 7, 0, 8}},
      {{4, 0, 0, 0, 2}, {4, 4, 0, 7, 0, 8}, {4, 2, 0, 7}},
      {{5, 0, 1, 0xff, 0}, {5, 0, 1, 0xff, 0}, {5, 0, 1, 0, 0}},
      {{6, 0, 1, 0, 7}, {6, 0, 1, 0, 7}, {6, 0, 1, 0, 8}},
      {{15, 0, 0, 0, 9, 2, 1, 1}, {15, 0, 0, 0, 9}, {15, 0, 0, 0, 8}},
      {{16, 0, 5, 0, 1, 2, 0, 1}, {16, 0, 5, 0, 1}, {16, 0, 6, 0, 1}},
      {{22, 0, 4, 0, 0xf2, 0, 0x25}, {22, 0, 4, 0, 0xf2, 0, 0x25}, {22, 0, 5, 0, 0xf2, 0, 0x25}},
      {{23, 0, 3, 0, 1, 0, 14, 0, 1, 2, 0, 255}, {23, 2, 0, 7}, {23, 4, 0, 7, 0, 8}},
  };
  for (const AnsweredRow& row : rows) {
    const RtuQuestion question = question_of(row.request);
    EXPECT_TRUE(answers(row.answer, question)) << int{row.request[0]};
    EXPECT_EQ(answer_bytes(question), row.answer.size()) << int{row.request[0]};
    EXPECT_FALSE(answers(row.another, question)) << int{row.request[0]};
    EXPECT_TRUE(are_answered_alike(question, question));
    EXPECT_FALSE(are_answered_alike(question, question_of(Bytes{17})));
    Bytes frame(rtu_frame_bytes_max);
    std::copy(row.answer.begin(), row.answer.end(), frame.begin() + rtu_unit_bytes);
    frame.resize(wrap_rtu(frame, 7, row.answer.size()));
    const auto found = find_rtu_answer(frame);
    ASSERT_TRUE(found) << int{row.request[0]};
    EXPECT_EQ(Bytes(found->pdu.begin(), found->pdu.end()), row.answer);
  }
  EXPECT_TRUE(
      are_answered_alike(question_of(Bytes{1, 0, 0, 0, 9}), question_of(Bytes{1, 0, 9, 0, 16})));
  EXPECT_FALSE(answers(Bytes(pdu_bytes_max + 1, 17), question_of(Bytes{17})));
}

}  // namespace
}  // namespace etcm::port
