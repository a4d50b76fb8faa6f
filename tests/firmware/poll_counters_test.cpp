// What the poller counts, on a simulated clock and a scripted bus.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "fakes.h"
#include "firmware/protocol/modbus_exception.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;
using port::BusResult;

class PollCounters : public testing::Test {
 protected:
  const UnitCounters& unit(std::uint32_t address) {
    return rig_.gateway->poller().counters(UnitIndex{address - 1});
  }
  Rig rig_;
};

TEST_F(PollCounters, EachResultIsCountedForItsUnit) {
  rig_.put(1, 0, 0);
  rig_.put(2, 10, 0);
  rig_.put(3, 0, 10);
  rig_.bus.set_result(2, BusResult::exception, 2);
  rig_.bus.set_result(3, BusResult::bad_answer);
  rig_.run(2s);
  EXPECT_EQ(unit(1).count(BusResult::ok), unit(1).requests);
  EXPECT_EQ(unit(1).requests, rig_.bus.reads[1]);
  EXPECT_GE(unit(1).requests, 18u);
  EXPECT_GT(unit(2).count(BusResult::exception), 0u);
  EXPECT_EQ(unit(2).count(BusResult::ok), 0u);
  EXPECT_GT(unit(3).count(BusResult::bad_answer), 0u);
  EXPECT_GT(unit(4).count(BusResult::timeout), 0u);
  EXPECT_LE(unit(4).count(BusResult::timeout), unit(4).requests);
}

TEST_F(PollCounters, AnAnswerOfNoNodeIsUnbelieved) {
  rig_.put(1, 0, 0);
  rig_.bus.set_registers(2, NodeRegisters{});
  rig_.run(1s);
  EXPECT_EQ(unit(2).unbelieved, unit(2).count(BusResult::ok));
  EXPECT_GT(unit(2).unbelieved, 0u);
  EXPECT_EQ(unit(1).unbelieved, 0u);
}

TEST_F(PollCounters, TornReadsAreCountedEachTime) {
  NodeRegisters torn = encode_node({.serial = Serial{1001}, .position = {5, 5}}, 7);
  torn.back() = 8;
  rig_.bus.set_registers(1, torn);
  rig_.run(1s);
  EXPECT_EQ(unit(1).torn, unit(1).count(BusResult::ok));
  EXPECT_GT(unit(1).torn, 4u);
}

TEST_F(PollCounters, AnswersTakeTime) {
  rig_.put(1, 0, 0);
  rig_.run(1s);
  EXPECT_EQ(unit(1).answer_time_last, 10ms);
  EXPECT_EQ(unit(1).answer_time_max, 10ms);
  EXPECT_EQ(unit(1).answer_time, 10ms * unit(1).count(BusResult::ok));
}

TEST_F(PollCounters, ABusIsBusyWhileAQuestionIsUnderWay) {
  rig_.settings.buses.front().units = {{.first = 1, .last = 1}};
  rig_.put(1, 0, 0);
  rig_.run(1s);
  // Ten questions, each answered in the next step.
  const BusCounters& counters = rig_.gateway->poller().bus_counters(BusIndex{0});
  EXPECT_EQ(counters.busy, 10ms * unit(1).count(BusResult::ok));
  EXPECT_EQ(counters.floor, 0ms) << "a network has no floor";
}

TEST_F(PollCounters, ASerialLineHasAFloor) {
  BusSettings& bus = rig_.settings.buses.front();
  bus.units = {{.first = 1, .last = 1}};
  bus.outstanding_max = 1;
  bus.link = port::SerialLine{.path = "line", .baud = 9600};
  rig_.put(1, 0, 0);
  rig_.run(1s);
  // 8 + 29 bytes of 11 bits, and twice the silence of 3.5 of them.
  const port::Duration floor =
      rig_.gateway->poller().bus_counters(BusIndex{0}).floor / unit(1).count(BusResult::ok);
  EXPECT_NEAR(static_cast<double>(floor.count()), 50.4e6, 0.1e6);
}

TEST(ModbusException, OfEachKindMeansSomethingOfItsOwn) {
  std::set<std::string> meanings, cures;
  for (const int code : {1, 2, 3, 4, 5, 6, 10, 11}) {
    const ExceptionText text = explain_exception(static_cast<std::uint8_t>(code), false);
    EXPECT_TRUE(meanings.insert(text.meaning).second) << code;
    EXPECT_TRUE(cures.insert(text.cure).second) << code;
  }
  EXPECT_EQ(meanings.count(explain_exception(7, false).meaning), 0u) << "it is none of these";
}

TEST(ModbusException, OfAUnitWithoutAProfileSaysThatItMayBeNoNode) {
  for (const int code : {1, 2, 3}) {
    EXPECT_TRUE(std::string(explain_exception(static_cast<std::uint8_t>(code), true).cure)
                    .starts_with("take it out of 'units'"));
  }
  EXPECT_STREQ(explain_exception(6, true).cure, explain_exception(6, false).cure);
}

}  // namespace
}  // namespace etcm::firmware
