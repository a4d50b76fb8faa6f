// RTU framing: known checksums, frames found in noise, and nothing found that is not there.
#include "modbus/rtu_frame.h"

#include <gtest/gtest.h>

#include <random>

#include "etcm/port/serial_line.h"
#include "mutation.h"
#include "peer.h"

namespace etcm::port {
namespace {

TEST(RtuFrame, HasTheChecksumOfTheSpecification) {
  // "Modbus over serial line", appendix B: the checksum of 02 07 is 1241, low byte first.
  const Bytes bytes{0x02, 0x07};
  EXPECT_EQ(rtu_checksum(bytes), 0x1241);
  Bytes frame(8);
  frame[1] = 0x07;
  frame.resize(wrap_rtu(frame, 0x02, 1));
  EXPECT_EQ(frame, (Bytes{0x02, 0x07, 0x41, 0x12}));
  EXPECT_TRUE(is_rtu_frame(frame));
}

TEST(RtuFrame, EveryWrongBitIsFound) {
  Bytes frame(40, 0x5a);
  frame.resize(wrap_rtu(frame, 9, 30));
  for (std::size_t bit = 0; bit < frame.size() * 8; ++bit) {
    Bytes wrong = frame;
    wrong[bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
    EXPECT_FALSE(is_rtu_frame(wrong)) << bit;
  }
}

Bytes rtu_frame_of(std::uint8_t unit, const Bytes& pdu) {
  Bytes frame(rtu_frame_bytes_max);
  std::copy(pdu.begin(), pdu.end(), frame.begin() + rtu_unit_bytes);
  frame.resize(wrap_rtu(frame, unit, pdu.size()));
  return frame;
}

// Answers changed at random: whatever is found has the right checksum and stays inside its bytes.
TEST(RtuFrame, MutatedAnswersAreFoundWholeOrNotAtAll) {
  std::mt19937 chance(7);
  int whole = 0;
  for (int round = 0; round < 100000; ++round) {
    Bytes bytes(chance() % 20, 0);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(chance());
    const std::size_t begin = bytes.size();
    // A write of any range, or twelve registers.
    Bytes pdu = round % 4 == 0 ? Bytes{write_holding_registers} : Bytes{read_input_registers, 24};
    const std::size_t pdu_bytes = round % 4 == 0 ? 5 : 2 + 24;
    while (pdu.size() < pdu_bytes) pdu.push_back(static_cast<std::uint8_t>(chance()));
    const Bytes frame = rtu_frame_of(static_cast<std::uint8_t>(chance()), pdu);
    bytes.insert(bytes.end(), frame.begin(), frame.end());
    const std::size_t changes = chance() % 4;
    mutate(bytes, changes, chance);
    const auto found = find_rtu_answer(bytes);
    if (changes == 0) {
      ASSERT_TRUE(found && found->end == bytes.size()) << begin;
    }
    if (!found) continue;
    ++whole;
    ASSERT_LE(found->end, bytes.size());
    const std::size_t size = found->pdu.size() + 3;
    ASSERT_LE(size, found->end);
    ASSERT_TRUE(is_rtu_frame(std::span(bytes).subspan(found->end - size, size)));
    std::array<std::uint16_t, 12> parsed;
    std::uint8_t exception = 0;
    static_cast<void>(parse_read_answer(found->pdu, read_input_registers, parsed, exception));
  }
  EXPECT_GT(whole, 25000);
}

TEST(RtuFrame, EveryKindOfAnswerIsFoundBehindNoiseAndOnlyWhole) {
  const Bytes pdus[] = {
      {3, 2, 0x12, 0x34},
      {0x83, 2},
      {16, 0, 100, 0, 3},
      {0x90, 4},
      {17, 3, 'E', 0xff, '!'},
      {0x91, 1},
      {43, 14, 1, 0x81, 0, 0, 2, 0, 1, 'A', 1, 0},
      {43, 14, 1, 0x81, 0, 0, 0},
      {0xab, 1},
  };
  for (const Bytes& pdu : pdus) {
    const Bytes frame = rtu_frame_of(7, pdu);
    Bytes bytes{0x00, 0xff, 0x2b};
    const std::size_t noise = bytes.size();
    bytes.insert(bytes.end(), frame.begin(), frame.end());
    for (std::size_t heard = 0; heard < bytes.size(); ++heard) {
      EXPECT_FALSE(find_rtu_answer(Bytes(bytes.begin(), bytes.begin() + static_cast<int>(heard))))
          << int{pdu[0]} << " of " << heard << " bytes";
    }
    const auto found = find_rtu_answer(bytes);
    ASSERT_TRUE(found) << int{pdu[0]};
    EXPECT_EQ(found->address, 7);
    EXPECT_EQ(Bytes(found->pdu.begin(), found->pdu.end()), pdu);
    EXPECT_EQ(found->end, noise + frame.size());
  }
}

TEST(SerialLine, TimesAreThoseOfTheSpecification) {
  using namespace std::chrono_literals;
  const SerialLine slow{.path = {}, .baud = 9600};
  EXPECT_EQ(character_time(slow) / 1us, 1145) << "11 bits";
  EXPECT_EQ(frame_silence(slow) / 1us, 4010) << "3.5 characters";
  const SerialLine fast{.path = {}, .baud = 115200, .parity = Parity::none};
  EXPECT_EQ(character_time(fast) / 1us, 86) << "10 bits";
  EXPECT_EQ(frame_silence(fast), 1750us);
  EXPECT_TRUE(is_baud(19200));
  EXPECT_FALSE(is_baud(49));
  EXPECT_FALSE(is_baud(4'000'001));
  EXPECT_EQ(usual_baud_near(19600), 19200u);
  EXPECT_EQ(usual_baud_near(0), 1200u);
  EXPECT_EQ(usual_baud_near(4'294'967'295), 921600u);
}

}  // namespace
}  // namespace etcm::port
