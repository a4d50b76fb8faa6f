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
            ":3: event 'jump' is unknown; write one of join, move, silent, leave, exception, torn, "
            "late, garbled, truncated, wrong_unit, noise, sound");
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

}  // namespace
}  // namespace etcm::nodes
