// Requests on the RTU bus of those who share the line.
#include "serial_bus.h"

namespace etcm::port {
namespace {

class SharedSerialBus : public SerialBus {
 protected:
  static UnitRequest of_client(std::uint8_t unit, const Bytes& pdu) {
    return {.address = unit, .pdu = pdu, .timeout = answer_timeout, .ticket = 5};
  }
  bool may_ask(std::uint8_t unit, const Bytes& pdu) {
    return bus().request_free_at(of_client(unit, pdu), now_) <= now_;
  }
  void ask(std::uint8_t unit, const Bytes& pdu) {
    become_ready();
    ASSERT_TRUE(may_ask(unit, pdu));
    bus().start_request(of_client(unit, pdu), now_);
    const Bytes frame = rtu_of(unit, pdu);
    EXPECT_EQ(take(frame.size()), frame);
  }
  void ask_in_vain(std::uint8_t unit, const Bytes& pdu) {
    ask(unit, pdu);
    pass(1s);
    EXPECT_EQ(result(), BusResult::timeout);
  }
  // The PDU of its answer; empty where there is none.
  Bytes answer() {
    BusAnswer found;
    if (!bus().take_answer(found)) return {};
    result_ = found.result;
    exception_ = found.exception;
    EXPECT_EQ(found.ticket, 5u);
    return {found.pdu.begin(), found.pdu.end()};
  }

  const Bytes two_{4, 0, 0, 0, 2};  // as request() asks
  BusResult result_ = BusResult::timeout;
};

TEST_F(SharedSerialBus, HasItsAnswerAsTheUnitGaveIt) {
  const std::pair<Bytes, Bytes> rows[] = {
      {{1, 0, 0, 0, 9}, {1, 2, 0x55, 1}},
      {{4, 0, 0, 0, 2}, {4, 4, 0, 1, 0, 2}},
      {{6, 0, 1, 0, 7}, {6, 0, 1, 0, 7}},
      {{22, 0, 4, 0, 0xf2, 0, 0x25}, {22, 0, 4, 0, 0xf2, 0, 0x25}},
      {{23, 0, 3, 0, 1, 0, 14, 0, 1, 2, 0, 255}, {23, 2, 0, 7}},
      {{17}, {17, 3, 'E', 0xff, '!'}},
      {{43, 14, 1, 0}, {43, 14, 1, 0x81, 0, 0, 1, 0, 1, 'A'}},
      {{3, 0, 0, 0, 1}, {0x83, 2}},
  };
  for (const auto& [pdu, answered] : rows) {
    ask(7, pdu);
    say(rtu_of(7, answered));
    EXPECT_EQ(answer(), answered);
    const bool is_exception = (answered[0] & 0x80) != 0;
    EXPECT_EQ(result_, is_exception ? BusResult::exception : BusResult::ok);
    EXPECT_EQ(exception_, is_exception ? answered[1] : 0);
  }
}

// The gateway asks in either way afterwards: an exception to a client says nothing of its own
// registers.
TEST_F(SharedSerialBus, AnExceptionToAClientSaysNothingAboutReading) {
  ask(7, {3, 0x40, 0, 0, 1});
  say(rtu_of(7, {0x83, 2}));
  EXPECT_EQ(answer(), (Bytes{0x83, 2}));
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  request(7, read_holding_registers);
}

TEST_F(SharedSerialBus, ALateAnswerToAClientNeverBecomesData) {
  ask_in_vain(7, two_);
  // The gateway asks in its other way.
  request(7, read_holding_registers);
  say(two_registers(7, 1));
  EXPECT_EQ(result(), std::nullopt);
  say(two_registers(7, 2, read_holding_registers));
  EXPECT_EQ(result(), BusResult::ok);
  EXPECT_EQ(value_, 2);
}

TEST_F(SharedSerialBus, AReadWithOneWayWaitsForTheLateAnswerToAClient) {
  ask_in_vain(7, two_);
  const RegisterRead read{.address = 7, .kind = RegisterKind::input, .first = 0, .count = 2};
  EXPECT_GT(bus().read_free_at(read, now_), now_ + 3s);
  say(two_registers(7, 1));
  EXPECT_LE(bus().read_free_at(read, now_), now_) << "it has come";
}

TEST_F(SharedSerialBus, ALateAnswerToTheGatewayNeverGoesToAClient) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  EXPECT_FALSE(may_ask(7, two_));
  EXPECT_TRUE(may_ask(7, {4, 0, 0, 0, 3})) << "another length";
  EXPECT_TRUE(may_ask(8, two_)) << "another unit";
  become_ready();
  bus().start_request(of_client(7, two_), now_);
  EXPECT_EQ(result(), BusResult::timeout) << "it is not sent";
  ask(7, {4, 0, 0, 0, 1});
  say(two_registers(7, 1));
  EXPECT_EQ(answer(), Bytes{});
  say(rtu_of(7, {4, 2, 0, 9}));
  EXPECT_EQ(answer(), (Bytes{4, 2, 0, 9}));
}

TEST_F(SharedSerialBus, ALateAnswerToAClientNeverGoesToTheNext) {
  ask_in_vain(7, {6, 0, 1, 0, 7});
  EXPECT_FALSE(may_ask(7, {6, 0, 1, 0, 7}));
  ask(7, {6, 0, 1, 0, 8});
  say(rtu_of(7, {6, 0, 1, 0, 7}));
  EXPECT_EQ(answer(), Bytes{});
  say(rtu_of(7, {6, 0, 1, 0, 8}));
  EXPECT_EQ(answer(), (Bytes{6, 0, 1, 0, 8}));
}

TEST_F(SharedSerialBus, WhereTwoAnswerAllThatClientsWereAnsweredMayBeAnsweredOnceMore) {
  const Bytes one{4, 0, 0, 0, 1}, three{4, 0, 0, 0, 3};
  ask(7, one);
  say(rtu_of(7, {4, 2, 0, 9}));
  EXPECT_EQ(answer(), (Bytes{4, 2, 0, 9}));
  ask(7, three);
  say(rtu_of(7, {0x84, 2}));
  EXPECT_EQ(answer(), (Bytes{0x84, 2}));
  ask(7, two_);
  say(two_registers(7, 1));
  EXPECT_EQ(answer(), (Bytes{4, 4, 0, 1, 0, 1}));
  EXPECT_TRUE(may_ask(7, one)) << "nothing is known of another one";
  pass(300ms);
  say(two_registers(7, 2));
  EXPECT_EQ(answer(), Bytes{});
  EXPECT_FALSE(may_ask(7, two_));
  EXPECT_FALSE(may_ask(7, one));
  EXPECT_TRUE(may_ask(7, three)) << "it was refused";
}

// It may be the earlier question's; then the answer is still to come.
TEST_F(SharedSerialBus, AnExceptionThatMayBeForAnEarlierQuestionIsNotHandedOver) {
  request(7);
  EXPECT_EQ(wait_in_vain(), BusResult::timeout);
  ask(7, {4, 0, 0, 0, 1});
  say(rtu_of(7, {0x84, 2}));
  EXPECT_EQ(answer(), Bytes{});
  say(rtu_of(7, {4, 2, 0, 9}));
  EXPECT_EQ(answer(), (Bytes{4, 2, 0, 9}));
  // And what was owed may come yet: the exception may have been to this one.
  EXPECT_FALSE(may_ask(7, two_));
}

TEST_F(SharedSerialBus, AUnitOwesClientsFewAnswersSoThatItsRegistersCanBeRead) {
  const Instant begin = now_;
  ask_in_vain(7, {4, 0, 0, 0, 30});
  ask_in_vain(7, {4, 0, 0, 0, 31});
  EXPECT_FALSE(may_ask(7, {4, 0, 0, 0, 32}));
  EXPECT_FALSE(may_ask(7, {17}));
  EXPECT_TRUE(may_ask(8, {17}));
  // What it has not answered once is asked again only in twice the time.
  while (!may_ask(7, {4, 0, 0, 0, 32})) pass(10ms);
  EXPECT_GE(now_ - begin, late_answer_max);
  EXPECT_FALSE(may_ask(7, {4, 0, 0, 0, 30}));
  while (!may_ask(7, {4, 0, 0, 0, 30})) pass(10ms);
  EXPECT_GE(now_ - begin, 2 * late_answer_max);
  EXPECT_LE(now_ - begin, 2 * late_answer_max + 2s);
}

// FC 17 tells its own length, up to more than a client's frame can hold.
TEST_F(SharedSerialBus, AnAnswerThatIsTooLongForAFrameIsNone) {
  ask(7, {17});
  Bytes pdu(2 + 253, 'x');
  pdu[0] = 17;
  pdu[1] = 253;
  Bytes bytes(1 + pdu.size() + 2);
  bytes[0] = 7;
  std::copy(pdu.begin(), pdu.end(), bytes.begin() + 1);
  const std::uint16_t checksum = rtu_checksum(std::span(bytes).first(bytes.size() - 2));
  bytes[bytes.size() - 2] = static_cast<std::uint8_t>(checksum & 0xff);
  bytes[bytes.size() - 1] = static_cast<std::uint8_t>(checksum >> 8);
  say(bytes);
  EXPECT_EQ(answer(), Bytes{});
}

// Who watches over the bus takes that for no standstill.
TEST_F(SharedSerialBus, TheBytesOfALongAnswerHaveTheirTime) {
  ask(7, {3, 0, 0, 0, 125});
  const Instant asked = now_;
  pass(answer_timeout + 250ms);
  EXPECT_EQ(result(), std::nullopt);
  pass(100ms);
  EXPECT_EQ(result(), BusResult::timeout);
  EXPECT_LE(now_ - asked, answer_timeout + bus().delay_max());
}

TEST_F(SharedSerialBus, AnUnpluggedPortEndsIt) {
  ask(7, two_);
  EXPECT_TRUE(bus().is_up());
  unplug();
  EXPECT_TRUE(turn_until(loop_, [&] {
    bus().advance(now_);
    return !bus().is_up();
  }));
  EXPECT_EQ(result(), BusResult::link_lost);
}

}  // namespace
}  // namespace etcm::port
