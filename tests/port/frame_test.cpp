// Framing: any cut of the stream gives the same frames, and nonsense is known as such.
#include "modbus/frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "etcm/port/node_bus.h"
#include "modbus/identity.h"
#include "mutation.h"
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

// Whatever can be asked of a PDU, on bytes that end where it does.
void parse_as_everything(const Frame& frame) {
  const Bytes pdu(frame.pdu.begin(), frame.pdu.end());
  std::uint8_t exception = 0;
  std::array<std::uint16_t, write_registers_max> values;
  const auto range = parse_read_request(pdu, exception);
  ASSERT_TRUE(!range || (range->count > 0 && range->count <= read_registers_max));
  const auto written = parse_write_request(pdu, exception);
  ASSERT_TRUE(!written || (written->count > 0 && written->count <= write_registers_max));
  static_cast<void>(
      parse_read_answer(pdu, read_input_registers, std::span(values).first(2), exception));
  static_cast<void>(parse_write_answer(pdu, {.first = 0, .count = 2}, exception));
  Bytes answer(pdu_bytes_max);
  ASSERT_LE(write_identity_answer(answer, pdu, {{"Maker", "thing", "1.0"}}), pdu_bytes_max);
}

// Feeds a stream in pieces of any size, as far as it can be followed; the number of frames.
std::size_t frames_in(const Bytes& stream, std::mt19937& chance) {
  FrameReader reader;
  std::size_t frames = 0;
  for (std::size_t at = 0; at < stream.size();) {
    const std::size_t piece =
        std::min<std::size_t>({1 + chance() % 300, stream.size() - at, reader.free_space().size()});
    EXPECT_GT(piece, 0u) << "no room for more";
    feed(reader, std::span(stream).subspan(at, piece));
    at += piece;
    Frame frame;
    FrameReader::Next next = reader.next(frame);
    for (; next == FrameReader::Next::frame; next = reader.next(frame)) {
      ++frames;
      EXPECT_GE(frame.pdu.size(), 1u);
      EXPECT_LE(frame.pdu.size(), pdu_bytes_max);
      parse_as_everything(frame);
    }
    if (next == FrameReader::Next::broken || testing::Test::HasFailure()) break;
  }
  return frames;
}

TEST(FrameReader, NoiseNeverGivesAFrameBeyondItsBytes) {
  std::mt19937 chance(1);
  for (int round = 0; round < 20000 && !HasFailure(); ++round) {
    Bytes noise(chance() % 600);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(chance() % 4 == 0 ? chance() : 0);
    frames_in(noise, chance);
  }
}

TEST(FrameReader, MutatedStreamsNeverGiveAFrameBeyondTheirBytes) {
  std::mt19937 chance(2);
  unsigned broken = 0;
  for (int round = 0; round < 20000 && !HasFailure(); ++round) {
    const std::size_t requests = 1 + chance() % 20;
    Bytes stream = request_stream(requests, chance);
    const std::size_t changes = chance() % 4;
    mutate(stream, changes, chance);
    const std::size_t frames = frames_in(stream, chance);
    if (changes == 0) {
      ASSERT_EQ(frames, requests);
    }
    broken += frames < requests ? 1 : 0;
  }
  EXPECT_GT(broken, 2000u) << "the changes must matter";
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

class WriteRequest : public testing::TestWithParam<RequestRow> {};
TEST_P(WriteRequest, IsReadOrRefused) {
  std::uint8_t exception = 0;
  const auto range = parse_write_request(GetParam().pdu, exception);
  EXPECT_EQ(range.has_value(), GetParam().exception == 0);
  if (!range) {
    EXPECT_EQ(exception, GetParam().exception);
  } else {
    EXPECT_EQ(range->first, 0x0100);
    EXPECT_EQ(range->count, GetParam().pdu[4]);
  }
}
Bytes write_of(std::uint8_t count) {
  Bytes pdu{16, 1, 0, 0, count, static_cast<std::uint8_t>(2 * count)};
  for (int i = 0; i < count; ++i) {
    pdu.push_back(7);
    pdu.push_back(8);
  }
  return pdu;
}
INSTANTIATE_TEST_SUITE_P(
    Rows, WriteRequest,
    testing::Values(RequestRow{"one", write_of(1), 0}, RequestRow{"most", write_of(123), 0},
                    RequestRow{"too_many", write_of(124), 3}, RequestRow{"none", write_of(0), 3},
                    RequestRow{"cut", {16, 1, 0, 0, 1, 2, 7}, 3},
                    RequestRow{"long", {16, 1, 0, 0, 1, 2, 7, 8, 9}, 3},
                    RequestRow{"bytes", {16, 1, 0, 0, 1, 4, 7, 8}, 3},
                    RequestRow{"head", {16, 1, 0, 0, 1}, 3}, RequestRow{"function", {16}, 3},
                    RequestRow{"single", {6, 1, 0, 7, 8}, 1}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(WritePdu, AsManyRegistersAsMayBeFitAPdu) {
  std::array<std::uint8_t, pdu_bytes_max> pdu{};
  std::array<std::uint16_t, write_registers_max> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::uint16_t>(i * 257);
  const std::size_t size = write_write_request(pdu, 200, values);
  EXPECT_EQ(size, 252u);
  std::uint8_t exception = 0;
  const auto range = parse_write_request(std::span(pdu).first(size), exception);
  ASSERT_TRUE(range);
  EXPECT_EQ(range->first, 200);
  EXPECT_EQ(range->count, values.size());
}

TEST(WriteAnswer, MustNameTheRangeThatWasWritten) {
  const RegisterRange range{.first = 0x0102, .count = 3};
  std::uint8_t exception = 0;
  EXPECT_EQ(parse_write_answer(Bytes{16, 1, 2, 0, 3}, range, exception), WriteAnswer::written);
  EXPECT_EQ(parse_write_answer(Bytes{0x90, 4}, range, exception), WriteAnswer::exception);
  EXPECT_EQ(exception, 4);
  for (const Bytes& wrong :
       {Bytes{16, 1, 2, 0, 2}, Bytes{16, 1, 3, 0, 3}, Bytes{16, 1, 2, 0}, Bytes{16, 1, 2, 0, 3, 0},
        Bytes{6, 1, 2, 0, 3}, Bytes{0x84, 4}, Bytes{16}}) {
    EXPECT_EQ(parse_write_answer(wrong, range, exception), WriteAnswer::malformed);
  }
}

}  // namespace
}  // namespace etcm::port
