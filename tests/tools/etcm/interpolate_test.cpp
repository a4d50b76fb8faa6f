// etcm interpolate: readings between nodes, as a user asks for them.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "etcm/files/error.h"
#include "node_readings.h"
#include "program_run.h"
#include "support/scratch_folder.h"

namespace etcm::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// A square with a pipe from corner to corner, a node on it, and nodes beside it that give it
// Steiner vertices. The reading is 2 x + 3 y, so it is linear wherever one asks.
const char* const piped =
    "8 2 2 0\n1 0 0 0 7\n2 300 400 1800 7\n3 0 400 1200 7\n4 300 0 600 7\n5 150 200 900 7\n"
    "6 80 90 430 7\n7 70 110 470 7\n8 220 310 1370 7\n1 0\n1 1 2\n0\n";
const char* const piped_readings =
    "node,reading\n1,0\n2,1800\n3,1200\n4,600\n5,900\n6,430\n7,470\n8,1370\n";

class Interpolation : public ::testing::Test {
 protected:
  Interpolation()
      : graph_(folder_.write("in.poly", piped)),
        readings_(folder_.write("in.csv", piped_readings)) {}

  Outcome ask(const std::string& options) const {
    return run("interpolate " + graph_ + " --readings " + readings_ + " " + options);
  }
  void expect_refusal(const Outcome& outcome, const std::string& message) const {
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_EQ(outcome.output, "") << message;
    EXPECT_THAT(outcome.errors, HasSubstr(message));
    EXPECT_EQ(outcome.errors.find('\n'), outcome.errors.size() - 1) << outcome.errors;
  }
  // The readings of a file with these lines are refused so.
  void expect_bad_readings(const std::string& lines, const std::string& message) {
    readings_ = folder_.write("bad.csv", lines);
    expect_refusal(ask("--at 1,1"), "etcm: " + readings_ + message);
  }

  test::ScratchFolder folder_;
  std::string graph_;
  std::string readings_;
};

TEST_F(Interpolation, IsLinearAtAPlace) {
  EXPECT_EQ(ask("--at 0,0").output, "0\n");
  EXPECT_EQ(ask("--at 10,20").output, "80\n");
  EXPECT_EQ(ask("--at 10.5,20.25 --at 299,1e1").output, "81.75\n628\n");
  EXPECT_EQ(ask("--at 150,0").output, "300\n");
  EXPECT_EQ(ask("--at=0.001,0").output, "0.002\n");
  // The file may come last.
  EXPECT_EQ(run("interpolate --at 10,20 --at 0,0 " + graph_).output, "80\n0\n");
}

TEST_F(Interpolation, GoesAlongAFeature) {
  // One unit along the pipe is 0.6 in x and 0.8 in y.
  EXPECT_EQ(ask("--feature 1 --distance 0").output, "0\n");
  EXPECT_EQ(ask("--feature 1 --distance 100").output, "360\n");
  EXPECT_EQ(ask("--feature 1 --distance 123.4").output, "444.24\n");
  EXPECT_EQ(ask("--feature 1 --distance 500").output, "1800\n");
  EXPECT_EQ(ask("--feature 1 --every 150").output,
            "distance,reading\n0,0\n150,540\n300,1080\n450,1620\n500,1800\n");
  EXPECT_EQ(ask("--feature 1 --every 250").output, "distance,reading\n0,0\n250,900\n500,1800\n");
  EXPECT_EQ(ask("--feature 1 --every 9e9").output, "distance,reading\n0,0\n500,1800\n");
}

// The node on it has a reading of its own; between nodes the feature is straight.
TEST_F(Interpolation, TakesTheNodesOnAFeature) {
  readings_ = folder_.write("hill.csv", "1,0\n2,0\n5,10\n");
  EXPECT_EQ(ask("--feature 1 --every 125").output,
            "distance,reading\n0,0\n125,5\n250,10\n375,5\n500,0\n");
}

TEST_F(Interpolation, AlongTheHullIsInside) {
  const std::string graph = folder_.write(
      "hull.poly", "3 2 1 0\n1 0 0 0\n2 7919 104729 1\n3 0 104729 5\n1 0\n1 1 2\n0\n");
  const Outcome outcome = run("interpolate " + graph + " --feature 1 --every 10000");
  EXPECT_EQ(outcome.code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, StartsWith("distance,reading\n0,0\n10000,0.095\n"));
  EXPECT_THAT(outcome.output, HasSubstr(",1\n"));
}

TEST_F(Interpolation, TakesAttributes) {
  const auto ask_attribute = [&](const std::string& options) {
    return run("interpolate " + graph_ + " " + options);
  };
  EXPECT_EQ(ask_attribute("--at 10,20").output, "80\n");
  EXPECT_EQ(ask_attribute("--at 10,20 --attribute 2").output, "7\n");
  expect_refusal(ask_attribute("--at 10,20 --attribute 3"), "2 attributes, and no attribute 3");
  expect_refusal(ask_attribute("--at 10,20 --attribute 0"), "no attribute 0");
  const std::string bare = folder_.write("bare.node", "3 2 0 0\n0 0 0\n1 9 0\n2 0 9\n");
  expect_refusal(run("interpolate " + bare + " --at 1,1"),
                 bare + ": its nodes have no attributes; give the readings with --readings");
}

TEST_F(Interpolation, CountsInUnitsOfTheInput) {
  EXPECT_EQ(ask("--scale 10 --at 10.5,20.25").output, "81.75\n");
  EXPECT_EQ(ask("--scale 10 --feature 1 --distance 123.4").output, "444.24\n");
  expect_refusal(ask("--scale 10 --feature 1 --distance 501"), "is 500 long");
}

TEST_F(Interpolation, KeepsTheDigitsOfReadings) {
  readings_ =
      folder_.write("fine.csv", "# comment\n\n 1 , -0.25\r\n2,-.125\n3,1e1\n4,0\n5,\n6,\n7,\n8,\n");
  EXPECT_EQ(ask("--at 0,0").output, "-0.25\n");
  EXPECT_EQ(ask("--at 300,400").output, "-0.125\n");
  EXPECT_EQ(ask("--at 0,400").output, "10\n");
}

TEST_F(Interpolation, RefusesPlacesWithoutAReading) {
  expect_refusal(ask("--at 301,0"), "--at 301,0: is outside the domain of " + graph_);
  expect_refusal(ask("--at -5,3"), "--at -5,3: is outside the domain");
  expect_refusal(ask("--at 99999999,0"), "--at 99999999,0: is out of range");
  expect_refusal(ask("--feature 1 --distance 500.001"),
                 "--distance 500.001: is beyond the end of feature 1 (1-2), which is 500 long");
  expect_refusal(ask("--feature 2 --distance 5"),
                 "--feature 2: does not exist; features run from 1 to 1");
  expect_refusal(ask("--feature 0 --distance 5"), "--feature 0: does not exist");
  expect_refusal(ask("--feature 1 --every 0.0001"), "more than a million rows");
  readings_ = folder_.write("few.csv", "1,5\n2,6\n5,\n4,7\n3,1\n");
  expect_refusal(ask("--feature 1 --distance 100"),
                 readings_ + ": node 5 has no reading, and that at 100 of feature 1 (1-2)");
  EXPECT_EQ(ask("--feature 1 --distance 500").output, "6\n");
  EXPECT_EQ(ask("--at 300,0").output, "7\n");
}

TEST_F(Interpolation, RefusesHolesOfTheDomain) {
  graph_ = folder_.write("holed.poly",
                         "8 2 1 0\n1 0 0 1\n2 90 0 1\n3 90 90 1\n4 0 90 1\n5 30 30 1\n6 60 30 1\n"
                         "7 60 60 1\n8 30 60 1\n4 0\n1 5 6\n2 6 7\n3 7 8\n4 8 5\n1\n1 45 45\n");
  const auto at = [&](const char* place) {
    return run("interpolate " + graph_ + " --at " + place);
  };
  expect_refusal(at("44,45"), "--at 44,45: is outside the domain");
  EXPECT_EQ(at("30,45").output, "1\n");
  EXPECT_EQ(at("29,45").output, "1\n");
}

TEST_F(Interpolation, RefusesReadingsThatAreWrong) {
  expect_bad_readings("1,2\n9,1\n", ":2: node 9 does not exist; nodes run from 1 to 8");
  expect_bad_readings("0,1\n", ":1: node 0 does not exist");
  expect_bad_readings("1,2\n1,3\n", ":2: node 1 has a line already, 1; take one of them out");
  expect_bad_readings("1 2\n", ":1: '1 2' is no node and reading; write them as 12,3.5");
  expect_bad_readings("1,2,3\n", ":1: '1,2,3' is no node and reading");
  expect_bad_readings("1,nan\n", ":1: reading 'nan' is no decimal number");
  expect_bad_readings("a,b\nc,d\n", ":2: node number 'c' is no integer");
  expect_bad_readings("1.5,1\n", ":1: node number '1.5' is no integer");
  expect_bad_readings(",\n", ":1: node number '' is no integer");
  expect_bad_readings("1,0.0123456789\n",
                      ":1: reading 0.0123456789 has more than 9 digits behind the point");
  expect_bad_readings("1,2147483648\n", ":1: reading 2147483648 is too large");
  expect_bad_readings("1,0.01\n2,30000000\n", ":2: reading 30000000 is too large beside others");
  expect_bad_readings("1,1e999999999\n", ":1: reading");
  expect_bad_readings("", ": node ");
  expect_bad_readings(std::string(5000, 'x') + "\n", ":1: 'xxx");
  readings_ = folder_.path("missing.csv");
  expect_refusal(ask("--at 1,1"), readings_);
}

TEST_F(Interpolation, RefusesAWrongCommandLine) {
  for (const char* options : {"",
                              "--feature 1",
                              "--distance 5",
                              "--every 5",
                              "--at 1,1 --feature 1",
                              "--at 1,1 --distance 5",
                              "--feature 1 --distance 5 --every 5",
                              "--at 1,1 --attribute 1",
                              "--at 1",
                              "--at 1:1",
                              "--at 1,1,1",
                              "--at ,",
                              "--at nan,0",
                              "--feature one --distance 5",
                              "--feature 1 --distance -5",
                              "--feature 1 --distance inf",
                              "--feature 1 --every 0",
                              "--feature 1 --every -1",
                              "--feature 1 --every 1e-999999",
                              "--feature 1 --distance 1e999999",
                              "--at 1,1 --domain sea"}) {
    const Outcome outcome = ask(options);
    EXPECT_EQ(outcome.code, 2) << options << outcome.output;
    EXPECT_EQ(outcome.output, "") << options;
    EXPECT_EQ(outcome.errors.find('\n'), outcome.errors.size() - 1) << outcome.errors;
  }
}

TEST(ReadingText, RoundsExactly) {
  constexpr std::int64_t one = std::int64_t{1} << 28;
  EXPECT_EQ(reading_text(0, 0), "0");
  EXPECT_EQ(reading_text(-1, 9), "0");
  EXPECT_EQ(reading_text(one / 2, 0), "0.5");
  EXPECT_EQ(reading_text(one / 3, 0), "0.333");
  EXPECT_EQ(reading_text(-one / 3, 2), "-0.00333");
  EXPECT_EQ(reading_text(1200 * one, 2), "12");
  EXPECT_EQ(reading_text(-(std::int64_t{1} << 31) * one, 0), "-2147483648");
  EXPECT_EQ(reading_text(((std::int64_t{1} << 31) - 1) * one, 9), "2.147483647");
}

}  // namespace
}  // namespace etcm::cli
