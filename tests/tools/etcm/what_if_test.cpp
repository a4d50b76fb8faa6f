// etcm what-if: what an event would come to, of a mesh in which none of them is made.
#include <gmock/gmock.h>

#include <string>

#include "program_run.h"
#include "support/scratch_folder.h"

namespace etcm::cli {
namespace {

using ::testing::HasSubstr;

// A line from 1 to 2, with nodes on both sides that are too near for it, and two more beside.
const char* const crowded =
    "7 2 0 0\n1 0 0\n2 100 0\n3 30 4\n4 50 -4\n5 70 4\n6 0 50\n7 100 50\n1 0\n1 1 2\n0\n";

class WhatIf : public ::testing::Test {
 protected:
  WhatIf() : graph_(folder_.write("in.poly", crowded)) {}

  Outcome ask(const std::string& events, const std::string& options = "") const {
    return run("what-if " + graph_ + " " + folder_.write("events", events) + " " + options);
  }

  test::ScratchFolder folder_;
  std::string graph_;
};

TEST_F(WhatIf, SaysHowManySteinerVerticesWouldComeAndGo) {
  const Outcome outcome = ask("unfeature 1\nfeature 2 6 7\njoin 8 50 4\n");
  EXPECT_EQ(outcome.errors, "");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.output, HasSubstr("event,id,answer,steiner\nunfeature,1,ok,-"));
  EXPECT_THAT(outcome.output, HasSubstr("\nfeature,2,ok,0\n"));
}

TEST_F(WhatIf, IsTheAnswerOfTheEvent) {
  EXPECT_EQ(
      ask("leave 1\njoin 8 30 4\njoin 3 9 9\nmove 9 1 1\nfeature 2 1 1\nunfeature 5\n").output,
      "event,id,answer,steiner\nleave,1,endpoint_in_use,\njoin,8,duplicate_vertex,\n"
      "join,3,duplicate_vertex,\nmove,9,unknown_vertex,\nfeature,2,zero_length_feature,\n"
      "unfeature,5,unknown_feature,\n");
}

TEST_F(WhatIf, MakesNoneOfTheEvents) {
  const std::string row = ask("join 8 50 20\n").output.substr(24);
  EXPECT_EQ(ask("join 8 50 20\njoin 8 50 20\n").output, "event,id,answer,steiner\n" + row + row);
}

TEST_F(WhatIf, PlacesEventsAsTheInput) {
  EXPECT_EQ(ask("join 8 0.5 20\n").code, 2);
  EXPECT_EQ(ask("join 8 0.5 20\n", "--scale 10").output, "event,id,answer,steiner\njoin,8,ok,0\n");
}

TEST_F(WhatIf, RefusesWhatIsNoEvent) {
  const Outcome outcome = ask("jump 8\n");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.output, "");
  EXPECT_THAT(outcome.errors, HasSubstr("no event starts like this"));
}

}  // namespace
}  // namespace etcm::cli
