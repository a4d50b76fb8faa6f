// The simulated nodes: their script, and what they answer.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "fleet.h"
#include "script.h"

namespace etcm::nodes {
namespace {

class NodeScript : public testing::Test {
 protected:
  NodeScript()
      : path_(std::filesystem::path(testing::TempDir()) /
              (std::string("nodes_") +
               testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv")) {}
  ~NodeScript() override { std::filesystem::remove(path_); }

  Script read(const std::string& rows) {
    std::ofstream(path_) << "time_ms,serial,event,x,y\n" << rows;
    return read_script(path_);
  }

  std::string mistake(const std::string& rows) {
    try {
      read(rows);
    } catch (const std::runtime_error& error) {
      return std::string(error.what()).substr(path_.string().size());
    }
    return "none";
  }

  std::filesystem::path path_;
};

TEST_F(NodeScript, EventsComeInTheOrderOfTheirTimes) {
  const Script script = read("500,7,move,3,4\n# a remark\n\n0,9,join,-1,-2\r\n0,7,join,1,2\n");
  EXPECT_EQ(script.serials, (std::vector<std::uint32_t>{7, 9}));
  ASSERT_EQ(script.events.size(), 3u);
  EXPECT_EQ(script.events[0].node, 1u);
  EXPECT_EQ(script.events[0].position, (Position{-1, -2}));
  EXPECT_EQ(script.events[2].action, Action::move);
}

TEST_F(NodeScript, MistakesAreNamedWithTheirLine) {
  EXPECT_EQ(mistake("0,1,join,0\n"), ":2: not five columns; write time_ms,serial,event,x,y");
  EXPECT_EQ(mistake("0,1,join,0,0\n0,1,jump,0,0\n"),
            ":3: event 'jump' is unknown; write one of join, move, silent, leave, unit, twin, "
            "jitter, drift, no_fix, low_battery, boot, exception, torn, late, garbled, truncated, "
            "wrong_unit, noise, sound");
  EXPECT_EQ(mistake("0,1,join,0.5,0\n"), ":2: x '0.5' is not a whole number in range");
  EXPECT_EQ(mistake("0,-1,join,0,0\n"), ":2: serial '-1' is not a whole number in range");
}

TEST_F(NodeScript, AUnitAnswersFromItsJoinToItsSilence) {
  Fleet fleet(read("100,1,join,5,6\n200,1,leave,,\n300,1,silent,,\n"));
  const std::vector<std::uint8_t> request{4, 0, 0, 0, 12};
  std::vector<std::uint8_t> answer(253);
  fleet.advance(99);
  EXPECT_EQ(fleet.answer(0, 1, request, answer), 0u);
  fleet.advance(100);
  EXPECT_EQ(fleet.answer(0, 1, request, answer), 26u);
  EXPECT_EQ(answer[2 + 2 * 6 + 1], 5);
  EXPECT_EQ(fleet.answer(0, 2, request, answer), 0u) << "nobody is there";
  fleet.advance(200);
  fleet.answer(0, 1, request, answer);
  EXPECT_EQ(answer[2 + 2 * 9 + 1],
            firmware::node_status::fix_valid | firmware::node_status::leaving);
  EXPECT_EQ(fleet.next_event_ms(), 300u);
  fleet.advance(5000);
  EXPECT_EQ(fleet.answer(0, 1, request, answer), 0u);
}

TEST_F(NodeScript, OtherRegistersAndFunctionsAreExceptions) {
  Fleet fleet(read("0,1,join,5,6\n"));
  fleet.advance(0);
  std::vector<std::uint8_t> answer(253);
  EXPECT_EQ(fleet.answer(0, 1, std::vector<std::uint8_t>{4, 0, 1, 0, 12}, answer), 2u);
  EXPECT_EQ(answer[1], 2);
  EXPECT_EQ(fleet.answer(0, 1, std::vector<std::uint8_t>{6, 0, 1, 0, 12}, answer), 2u);
  EXPECT_EQ(answer[1], 1);
}

TEST_F(NodeScript, AFaultLastsUntilTheUnitIsSound) {
  Fleet fleet(read("0,1,join,5,6\n10,1,exception,11,\n20,1,torn,,\n30,1,late,70,\n40,1,sound,,\n"));
  const std::vector<std::uint8_t> request{4, 0, 0, 0, 12};
  std::vector<std::uint8_t> answer(253);
  fleet.advance(10);
  EXPECT_EQ(fleet.answer(0, 1, request, answer), 2u);
  EXPECT_EQ(answer[1], 11);
  fleet.advance(20);
  EXPECT_EQ(fleet.answer(0, 1, request, answer), 26u);
  EXPECT_NE(answer[2 + 2 * 4 + 1], answer[2 + 2 * 11 + 1]) << "the sequence numbers";
  fleet.advance(30);
  EXPECT_EQ(fleet.fault(0, 1).action, Action::late);
  EXPECT_EQ(fleet.fault(0, 1).value, 70);
  fleet.advance(40);
  EXPECT_EQ(fleet.answer(0, 1, request, answer), 26u);
  EXPECT_EQ(answer[2 + 2 * 4 + 1], answer[2 + 2 * 11 + 1]);
  EXPECT_EQ(fleet.fault(0, 1).action, Action::sound);
}

using Bytes = std::vector<std::uint8_t>;

class NodesAtWork : public NodeScript {
 protected:
  // The answer of a unit.
  static Bytes ask(Fleet& fleet, std::uint8_t unit, const Bytes& request) {
    Bytes answer(253);
    answer.resize(fleet.answer(0, unit, request, answer));
    return answer;
  }
  // Gives the node with this serial a unit.
  static Bytes assignment(std::uint8_t unit, std::uint8_t serial) {
    return {16, 0, 100, 0, 4, 8, 0, unit, 0, 0, 0, serial, 0x45, 0x54};
  }
  const Bytes read_{4, 0, 0, 0, 12};
};

TEST_F(NodesAtWork, ANodeAtTheDefaultUnitTakesAUnitThatIsMeantForIt) {
  Fleet fleet(read("0,7,join,5,6\n0,7,unit,247,\n"));
  fleet.advance(0);
  EXPECT_TRUE(ask(fleet, 1, read_).empty());
  EXPECT_EQ(ask(fleet, 247, read_).size(), 26u);
  EXPECT_TRUE(ask(fleet, 247, assignment(12, 8)).empty()) << "it is for another";
  EXPECT_TRUE(ask(fleet, 247, {16, 0, 100, 0, 4, 8, 0, 12, 0, 0, 0, 7, 0, 1}).empty());
  EXPECT_EQ(ask(fleet, 247, assignment(12, 7)), (Bytes{16, 0, 100, 0, 4}));
  EXPECT_TRUE(ask(fleet, 247, read_).empty());
  EXPECT_EQ(ask(fleet, 12, read_).size(), 26u);
}

TEST_F(NodesAtWork, OfTwoAtOneUnitTheOneThatIsMeantGoes) {
  Fleet fleet(read("0,7,join,5,6\n0,7,unit,247,\n0,8,join,9,9\n0,8,unit,247,\n"));
  fleet.advance(0);
  int heard = 0;
  int silent = 0;
  for (int question = 0; question < 100; ++question) {
    ++(ask(fleet, 247, read_).empty() ? silent : heard);
  }
  EXPECT_GT(heard, 20);
  EXPECT_GT(silent, 20);
  EXPECT_EQ(ask(fleet, 247, assignment(12, 8)).size(), 5u);
  EXPECT_EQ(ask(fleet, 12, read_).at(2 + 2 * 3 + 1), 8);
  EXPECT_EQ(ask(fleet, 247, read_).at(2 + 2 * 3 + 1), 7) << "alone now, it is always heard";
}

TEST_F(NodesAtWork, WhatIsWrittenCanBeReadUntilItBoots) {
  Fleet fleet(read("0,7,join,5,6\n10,7,boot,,\n"));
  fleet.advance(0);
  EXPECT_EQ(ask(fleet, 1, {16, 0, 200, 0, 2, 4, 1, 2, 3, 4}), (Bytes{16, 0, 200, 0, 2}));
  EXPECT_EQ(ask(fleet, 1, {3, 0, 200, 0, 2}), (Bytes{3, 4, 1, 2, 3, 4}));
  EXPECT_EQ(ask(fleet, 1, {16, 1, 186, 0, 2, 4, 1, 2, 3, 4}), (Bytes{0x90, 2})) << "beyond 442";
  EXPECT_EQ(ask(fleet, 1, {16, 0, 50, 0, 1, 2, 1, 2}), (Bytes{0x90, 2}));
  EXPECT_EQ(ask(fleet, 1, {16, 0, 200, 0, 2, 4, 1, 2}), (Bytes{0x90, 3}));
  fleet.advance(10);
  EXPECT_EQ(ask(fleet, 1, {3, 0, 200, 0, 2}), (Bytes{3, 4, 0, 0, 0, 0}));
  EXPECT_EQ(ask(fleet, 1, read_).at(2 + 2 * 10 + 1), 2) << "boots";
}

TEST_F(NodesAtWork, NodesJitterDriftAndHaveTwins) {
  Fleet fleet(
      read("0,7,join,500,600\n0,7,jitter,3,\n0,8,join,0,0\n0,8,drift,10,-20\n0,7,twin,9,9\n"
           "5000,8,low_battery,,\n5000,8,no_fix,,\n"));
  EXPECT_EQ(fleet.node_count(), 3u);
  int places = 0;
  int last = -1;
  for (std::uint32_t ms = 0; ms < 5000; ms += 100) {
    fleet.advance(ms);
    const Bytes answer = ask(fleet, 1, read_);
    ASSERT_EQ(answer.size(), 26u);
    const int x = answer[2 + 2 * 6] << 8 | answer[2 + 2 * 6 + 1];
    EXPECT_GE(x, 497);
    EXPECT_LE(x, 503);
    places += x != last;
    last = x;
  }
  EXPECT_GT(places, 20);
  fleet.advance(5000);
  const Bytes drifted = ask(fleet, 2, read_);
  ASSERT_EQ(drifted.size(), 26u);
  EXPECT_EQ(drifted[2 + 2 * 6 + 1], 50);
  EXPECT_EQ(static_cast<std::int8_t>(drifted[2 + 2 * 8 + 1]), -100);
  EXPECT_EQ(drifted[2 + 2 * 9 + 1], firmware::node_status::low_battery);
  EXPECT_EQ(ask(fleet, 3, read_).at(2 + 2 * 3 + 1), 7) << "the serial of the first";
}

TEST_F(NodesAtWork, AUnitBeyondTheLineIsAMistake) {
  EXPECT_EQ(mistake("0,7,unit,248,\n"), ":2: x '248' is no unit; give 1 to 247");
}

}  // namespace
}  // namespace etcm::nodes
