// Framing: any cut of the stream gives the same frames, and nonsense is known as such.
#include "modbus/frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "peer.h"

namespace etcm::port {
namespace {

void feed(FrameReader& reader, std::span<const std::uint8_t> bytes) {
  const auto space = reader.free_space();
  ASSERT_LE(bytes.size(), space.size());
  std::copy(bytes.begin(), bytes.end(), space.begin());
  reader.received(bytes.size());
}

TEST(FrameReader, AStreamCutAnywhereGivesTheSameFrames) {
  Bytes stream;
  for (std::uint16_t i = 0; i < 20; ++i) {
    const Bytes frame = frame_of(i, static_cast<std::uint8_t>(i), Bytes(1 + i * 12u, 0x55));
    stream.insert(stream.end(), frame.begin(), frame.end());
  }
  for (std::size_t cut = 1; cut <= 300; ++cut) {
    FrameReader reader;
    std::uint16_t found = 0;
    for (std::size_t at = 0; at < stream.size(); at += cut) {
      feed(reader, std::span(stream).subspan(at, std::min(cut, stream.size() - at)));
      Frame frame;
      FrameReader::Next next = reader.next(frame);
      for (; next == FrameReader::Next::frame; next = reader.next(frame)) {
        ASSERT_EQ(frame.transaction, found);
        ASSERT_EQ(frame.pdu.size(), 1 + found * 12u);
        ++found;
      }
      ASSERT_EQ(next, FrameReader::Next::incomplete);
    }
    ASSERT_EQ(found, 20);
    ASSERT_TRUE(reader.empty());
  }
}

struct BrokenHeader {
  const char* name;
  Bytes bytes;
};
class FrameReaderRefuses : public testing::TestWithParam<BrokenHeader> {};
TEST_P(FrameReaderRefuses, Header) {
  FrameReader reader;
  feed(reader, GetParam().bytes);
  Frame frame;
  EXPECT_EQ(reader.next(frame), FrameReader::Next::broken);
}
INSTANTIATE_TEST_SUITE_P(Rows, FrameReaderRefuses,
                         testing::Values(BrokenHeader{"protocol", {0, 1, 0, 1, 0, 6, 1}},
                                         BrokenHeader{"no_function", {0, 1, 0, 0, 0, 1, 1}},
                                         BrokenHeader{"too_long", {0, 1, 0, 0, 0, 255, 1}},
                                         BrokenHeader{"text", {'G', 'E', 'T', ' ', '/', ' ', 'H'}}),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(FrameReader, NoiseNeverGivesAFrameBeyondItsBytes) {
  std::mt19937 chance(1);
  for (int round = 0; round < 20000; ++round) {
    FrameReader reader;
    Bytes noise(chance() % 600);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(chance() % 4 == 0 ? chance() : 0);
    feed(reader, noise);
    Frame frame;
    while (reader.next(frame) == FrameReader::Next::frame) {
      ASSERT_GE(frame.pdu.size(), 1u);
      ASSERT_LE(frame.pdu.size(), pdu_bytes_max);
      std::uint8_t exception = 0;
      std::array<std::uint16_t, 12> registers;
      static_cast<void>(parse_read_request(frame.pdu, exception));
      static_cast<void>(parse_read_answer(frame.pdu, read_input_registers, registers, exception));
    }
  }
}

struct RequestRow {
  const char* name;
  Bytes pdu;
  std::uint8_t exception;  // 0: it is good
};
class ReadRequest : public testing::TestWithParam<RequestRow> {};
TEST_P(ReadRequest, IsReadOrRefused) {
  std::uint8_t exception = 0;
  const auto range = parse_read_request(GetParam().pdu, exception);
  EXPECT_EQ(range.has_value(), GetParam().exception == 0);
  if (!range) {
    EXPECT_EQ(exception, GetParam().exception);
  }
}
INSTANTIATE_TEST_SUITE_P(Rows, ReadRequest,
                         testing::Values(RequestRow{"input", {4, 0, 1, 0, 125}, 0},
                                         RequestRow{"holding", {3, 0, 1, 0, 1}, 0},
                                         RequestRow{"none", {4, 0, 1, 0, 0}, 3},
                                         RequestRow{"too_many", {4, 0, 1, 0, 126}, 3},
                                         RequestRow{"cut", {4, 0, 1, 0}, 3},
                                         RequestRow{"long", {4, 0, 1, 0, 1, 0}, 3},
                                         RequestRow{"write", {6, 0, 1, 0, 1}, 1},
                                         RequestRow{"identity", {0x2b, 0x0e, 1, 0}, 1}),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(ReadAnswer, MustHaveExactlyWhatWasAsked) {
  std::array<std::uint16_t, 2> registers{};
  std::uint8_t exception = 0;
  EXPECT_EQ(parse_read_answer(Bytes{4, 4, 1, 2, 3, 4}, read_input_registers, registers, exception),
            ReadAnswer::registers);
  EXPECT_EQ(registers, (std::array<std::uint16_t, 2>{0x0102, 0x0304}));
  EXPECT_EQ(parse_read_answer(Bytes{0x84, 11}, read_input_registers, registers, exception),
            ReadAnswer::exception);
  EXPECT_EQ(exception, 11);
  for (const Bytes& wrong : {Bytes{4, 4, 1, 2, 3}, Bytes{4, 2, 1, 2}, Bytes{3, 4, 1, 2, 3, 4},
                             Bytes{4, 2, 1, 2, 3, 4}, Bytes{0x83, 2}, Bytes{4}}) {
    EXPECT_EQ(parse_read_answer(wrong, read_input_registers, registers, exception),
              ReadAnswer::malformed);
  }
}

}  // namespace
}  // namespace etcm::port
