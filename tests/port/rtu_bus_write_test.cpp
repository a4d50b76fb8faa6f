// Writes on the RTU bus.
#include "serial_bus.h"

namespace etcm::port {
namespace {

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

}  // namespace
}  // namespace etcm::port
