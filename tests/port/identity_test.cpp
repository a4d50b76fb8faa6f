// Who is there: what is written is what is read, and no bytes lead beyond their end.
#include "modbus/identity.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "modbus/frame.h"
#include "mutation.h"
#include "peer.h"

namespace etcm::port {
namespace {

constexpr Identity short_identity{{"Maker", "thing", "1.0"}};

Bytes answer_to(const Bytes& request, const Identity& identity = short_identity) {
  Bytes answer(pdu_bytes_max);
  answer.resize(write_identity_answer(answer, request, identity));
  return answer;
}

Bytes identification_request(std::uint8_t first) {
  Bytes pdu(pdu_bytes_max);
  pdu.resize(write_identification_request(pdu, first));
  return pdu;
}

TEST(Identity, HasTheLayoutOfTheSpecification) {
  EXPECT_EQ(identification_request(0), (Bytes{43, 14, 1, 0}));
  EXPECT_EQ(answer_to({43, 14, 1, 1}, {{"A", "BC", ""}}),
            (Bytes{43, 14, 1, 0x81, 0, 0, 2, 1, 2, 'B', 'C', 2, 0}));
  EXPECT_EQ(answer_to({43, 14, 4, 1}, {{"A", "BC", ""}}),
            (Bytes{43, 14, 4, 0x81, 0, 0, 1, 1, 2, 'B', 'C'}));
  EXPECT_EQ(answer_to({17}, {{"A", "BC", "D"}}), (Bytes{17, 6, 'E', 0xff, 'B', 'C', ' ', 'D'}));
}

TEST(Identity, AnUnknownObjectOfAStreamStartsAtTheFirst) {
  EXPECT_EQ(answer_to({43, 14, 1, 99}), answer_to({43, 14, 1, 0}));
  EXPECT_EQ(answer_to({43, 14, 4, 99}), (Bytes{0xab, 2}));
}

TEST(Identity, WhatIsWrongIsAnException) {
  EXPECT_EQ(answer_to({43, 14, 0, 0}), (Bytes{0xab, 3}));
  EXPECT_EQ(answer_to({43, 14, 5, 0}), (Bytes{0xab, 3}));
  EXPECT_EQ(answer_to({43, 14, 1}), (Bytes{0xab, 3}));
  EXPECT_EQ(answer_to({17, 0}), (Bytes{0x91, 3}));
  EXPECT_EQ(answer_to({43, 13, 1, 0}), Bytes{}) << "not about identity";
  EXPECT_EQ(answer_to({43}), Bytes{});
  EXPECT_EQ(answer_to({4, 0, 0, 0, 1}), Bytes{});
}

TEST(Identity, LongTextsComeInSeveralAnswers) {
  const std::string vendor(150, 'v'), product(150, 'p'), version(500, 'r');
  const Identity sent{{vendor, product, version}};
  std::string found[3];
  std::uint8_t next = 0;
  int answers = 0;
  while (next < 3) {
    ASSERT_LE(++answers, 3);
    const Bytes answer = answer_to(identification_request(next), sent);
    Identity part;
    const auto following = parse_identification_answer(answer, part);
    ASSERT_TRUE(following);
    for (std::size_t i = next; i < *following; ++i) found[i] = part.objects[i];
    ASSERT_GT(*following, next);
    next = *following;
  }
  EXPECT_EQ(found[0], vendor);
  EXPECT_EQ(found[1], product);
  EXPECT_EQ(found[2], version.substr(0, 240));
}

TEST(Identity, AServerIdIsTheUnitsOwn) {
  const Bytes answer = answer_to({17});
  const auto data = parse_server_id_answer(answer);
  ASSERT_TRUE(data);
  EXPECT_EQ(std::string(data->begin() + 2, data->end()), "thing 1.0");
  EXPECT_FALSE(parse_server_id_answer(Bytes{17, 5, 1}));
  EXPECT_FALSE(parse_server_id_answer(Bytes{0x91, 1}));
}

TEST(Identity, NoMutationIsReadBeyondItsEnd) {
  std::mt19937 chance(11);
  int understood = 0;
  for (int round = 0; round < 200000; ++round) {
    Bytes request = chance() % 4 == 0 ? Bytes{17} : Bytes{43, 14, 1, 0};
    Bytes answer = answer_to(request);
    for (Bytes* bytes : {&request, &answer}) {
      mutate(*bytes, chance() % 3, chance);
      if (bytes->empty()) bytes->push_back(43);
    }
    ASSERT_LE(answer_to(request).size(), pdu_bytes_max);
    Identity identity;
    if (parse_identification_answer(answer, identity)) {
      ++understood;
      for (const std::string_view text : identity.objects) {
        if (text.data() == nullptr) continue;
        const auto* begin = reinterpret_cast<const std::uint8_t*>(text.data());
        ASSERT_TRUE(begin >= answer.data() && begin + text.size() <= answer.data() + answer.size());
      }
    } else {
      ASSERT_EQ(identity.vendor(), "");
    }
    static_cast<void>(parse_server_id_answer(answer));
  }
  EXPECT_GT(understood, 10000);
}

}  // namespace
}  // namespace etcm::port
