// etcm nearest: the nodes around a place, as a user asks for them.
#include <gmock/gmock.h>

#include <string>

#include "program_run.h"
#include "support/scratch_folder.h"

namespace etcm::cli {
namespace {

using ::testing::HasSubstr;

// A square, numbered from 0, and one of its diagonals as feature.
const char* const cornered = "4 2 0 0\n0 0 0\n1 6 0\n2 6 6\n3 0 6\n1 0\n0 0 2\n0\n";

class Nearest : public ::testing::Test {
 protected:
  Nearest() : graph_(folder_.write("in.poly", cornered)) {}

  Outcome ask(const std::string& options) const { return run("nearest " + graph_ + " " + options); }
  void expect_refusal(const std::string& options, const std::string& message) const {
    const Outcome outcome = ask(options);
    EXPECT_EQ(outcome.code, 2) << options;
    EXPECT_EQ(outcome.output, "") << options;
    EXPECT_THAT(outcome.errors, HasSubstr(message));
    EXPECT_EQ(outcome.errors.find('\n'), outcome.errors.size() - 1) << outcome.errors;
  }

  test::ScratchFolder folder_;
  std::string graph_;
};

TEST_F(Nearest, IsOneUnlessToldMore) {
  EXPECT_EQ(ask("--at 1,0").output, "node,distance\n0,1\n");
  EXPECT_EQ(ask("--at 9,2 --count 2").output, "node,distance\n1,3.60555128\n2,5\n");
}

TEST_F(Nearest, TieByPlace) {
  EXPECT_EQ(ask("--at 10,3 --count 9").output,
            "node,distance\n1,5\n2,5\n0,10.44030651\n3,10.44030651\n");
}

TEST_F(Nearest, AreAsFarAsThePlaceIsKnown) {
  EXPECT_EQ(ask("--at 0.1,0").output, "node,distance\n0,0.1\n");
}

TEST_F(Nearest, AreInTheUnitOfTheInput) {
  EXPECT_EQ(ask("--at 5.5,0 --scale 10").output, "node,distance\n1,0.5\n");
}

TEST_F(Nearest, StandInAFileOfOneNodeToo) {
  graph_ = folder_.write("one.node", "1 2 0 0\n1 3 4\n");
  EXPECT_EQ(ask("--at 0,0 --count 5").output, "node,distance\n1,5\n");
}

TEST_F(Nearest, RefuseWhatIsNoPlace) {
  expect_refusal("", "--at is required");
  expect_refusal("--at 5", "--at 5: must be two decimal numbers");
  expect_refusal("--at 16777217,0", "--at 16777217,0: is out of range");
  expect_refusal("--at 1,1 --count 0", "--count: Value 0 not in range");
  expect_refusal("--at 1,1 --count -1", "--count: Value -1 not in range");
  expect_refusal("--at 1,1 --count 99999999999", "--count: Value 99999999999 not in range");
  graph_ = folder_.path("none.poly");
  expect_refusal("--at 1,1", "none.poly");
}

}  // namespace
}  // namespace etcm::cli
