#include "modbus/replies.h"

#include <gtest/gtest.h>

#include <numeric>

#include "modbus/frame.h"
#include "peer.h"

namespace etcm::port {
namespace {

constexpr std::uint16_t table_first = 200;

class RepliesTo : public testing::Test {
 protected:
  RepliesTo() { std::iota(table_.begin(), table_.end(), std::uint16_t{0x0100}); }

  Bytes read(std::uint8_t function, std::uint16_t first, std::uint16_t count) {
    Bytes request(5), answer(pdu_bytes_max);
    write_read_request(request, function, {.first = first, .count = count});
    answer.resize(replies_.to_read(request, table_first, table_, answer));
    return answer;
  }
  Bytes write(std::uint16_t first, const std::vector<std::uint16_t>& values) {
    Bytes request(pdu_bytes_max), answer(pdu_bytes_max);
    request.resize(write_write_request(request, first, values));
    answer.resize(replies_.to_write(request, table_first, table_, answer));
    return answer;
  }

  Replies replies_;
  std::array<std::uint16_t, 150> table_;
};

TEST_F(RepliesTo, ReadsOfEitherKind) {
  EXPECT_EQ(read(3, 200, 1), (Bytes{3, 2, 1, 0}));
  EXPECT_EQ(read(4, 348, 2), (Bytes{4, 4, 1, 148, 1, 149}));
  EXPECT_EQ(read(4, 200, 125).size(), 2u + 250u);
  for (const auto& [first, count] : {std::pair{199, 1}, {199, 3}, {350, 1}, {349, 2}, {65535, 1}}) {
    EXPECT_EQ(read(4, static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(count)),
              (Bytes{0x84, 2}))
        << first;
  }
}

TEST_F(RepliesTo, WritesThatFitTheTable) {
  EXPECT_EQ(write(201, {7, 8}), (Bytes{16, 0, 201, 0, 2}));
  EXPECT_EQ(read(3, 200, 4), (Bytes{3, 8, 1, 0, 0, 7, 0, 8, 1, 3}));
  EXPECT_EQ(write(200, std::vector<std::uint16_t>(123, 5)), (Bytes{16, 0, 200, 0, 123}));
  const auto before = table_;
  EXPECT_EQ(write(349, {1, 2}), (Bytes{0x90, 2}));
  EXPECT_EQ(write(199, {1}), (Bytes{0x90, 2}));
  EXPECT_EQ(table_, before);
}

TEST_F(RepliesTo, AnEmptyTable) {
  Bytes request(5), answer(pdu_bytes_max);
  write_read_request(request, 4, {.first = 0, .count = 1});
  answer.resize(replies_.to_read(request, 0, {}, answer));
  EXPECT_EQ(answer, (Bytes{0x84, 2}));
}

// Each request gets its own reply, however many there are.
TEST_F(RepliesTo, ManyRequests) {
  for (std::uint16_t round = 0; round < 20000; ++round) {
    table_[0] = round;
    ASSERT_EQ(read(4, 200, 1), (Bytes{4, 2, static_cast<std::uint8_t>(round >> 8),
                                      static_cast<std::uint8_t>(round & 0xff)}));
  }
}

}  // namespace
}  // namespace etcm::port
