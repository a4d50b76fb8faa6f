// How far along a missing subsegment a vertex may stand, where doubles are of no help: the answer
// is exact all the same, and comes.
#include "conforming/feasible_parameter.h"

#include <gtest/gtest.h>

namespace etcm::test {
namespace {

// Two vertices so close to the line that every cross product among them is 0 in double.
struct Needle {
  Position from;
  Position to;
  Point right;
  Point left;
  Parameter farthest;
};

constexpr Needle needles[] = {
    {{-1328628, -2657256},
     {1328627, 2657257},
     {-263843285263571, -527686465748815},
     {-315221738506629, -630443430240414},
     25806079},
    {{-6590608, -3295304},
     {6590608, 3295303},
     {1536120472118810, 768059985303076},
     {1096568426168002, 548283995674523},
     226669804},
    {{-2004882, -2004882},
     {2004882, 2004883},
     {-157713910207785, -157713815322524},
     {267301931178874, 267302132059361},
     175496255},
};

TEST(FeasibleParameter, IsFoundInTrianglesWhoseAreaIsNoneInDouble) {
  for (const Needle& needle : needles) {
    SplitSite site;
    site.from = needle.from;
    site.to = needle.to;
    site.head_right = needle.right;
    site.head_left = needle.left;
    EXPECT_EQ(internal::feasible_from_head(site), needle.farthest);
    site.from = needle.to;
    site.to = needle.from;
    site.tail_left = needle.right;
    site.tail_right = needle.left;
    EXPECT_EQ(internal::feasible_from_tail(site), parameter_end - needle.farthest);
  }
}

}  // namespace
}  // namespace etcm::test
