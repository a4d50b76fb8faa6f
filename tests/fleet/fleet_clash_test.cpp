// Two nodes with one serial at two gateways: what each says of it, and what is none.
#include <algorithm>

#include "firmware/fleet/fleet_clashes.h"
#include "firmware/fleet/fleet_member.h"
#include "member_fixture.h"

namespace etcm::test {
namespace {

class FleetClashTest : public FleetMemberTest {
 protected:
  // The first serial of which the one that is named, of "a" and "b", is to speak for it.
  static std::uint32_t serial_of(const std::string& name) {
    for (std::uint32_t serial = 1;; ++serial) {
      const std::string key = "0000000" + std::to_string(serial);
      const bool is_a = rendezvous_weight(key, "a") > rendezvous_weight(key, "b");
      if (is_a == (name == "a")) return serial;
    }
  }
  void hear_for(port::Duration time, std::uint32_t serial, std::int32_t x, std::int32_t step = 0) {
    for (port::Duration passed{}; passed < time; passed += 1s) {
      hear(serial, x);
      x += step;
      pass(1s);
    }
  }
  // Heard here at 10, and by "b", which speaks for it, at `x`.
  std::uint32_t hear_both_at(std::int32_t x) {
    const std::uint32_t serial = serial_of("b");
    settle();
    hear(serial, 10);
    meet("b", {record_of(serial, x, "b", 5, 1)});
    return serial;
  }
};

TEST_F(FleetClashTest, WhoHearsWhatAnotherSpeaksForElsewhereSaysSo) {
  const std::uint32_t serial = hear_both_at(500);
  hear_for(15s, serial, 10);
  ASSERT_EQ(member->clashes().size(), 1u);
  const FleetClash clash = member->clashes()[0];
  EXPECT_EQ(clash.serial, Serial{serial});
  EXPECT_EQ(clash.gateway, "b");
  EXPECT_EQ(clash.here, (Position{10, 0}));
  EXPECT_EQ(clash.there, (Position{500, 0}));
  EXPECT_FALSE(clash.is_owner);
  EXPECT_TRUE(member->take_clash_news());
  EXPECT_FALSE(member->take_clash_news());
  EXPECT_EQ(broker.last("a/clashes"), R"({"clashes":[{"serial":)" + std::to_string(serial) +
                                          R"(,"owner":"b","x":10,"y":0}]})");
  // Where it is heard no more, it is over, and taken back.
  member->lose(Serial{serial}, now);
  pass(25s);
  EXPECT_TRUE(member->clashes().empty());
  EXPECT_TRUE(member->take_clash_news());
  EXPECT_EQ(broker.last("a/clashes"), "");
  EXPECT_EQ(broker.count("a/clashes"), 2u);
}

TEST_F(FleetClashTest, TheOneThatSpeaksForItLearnsOfTheOther) {
  settle();
  hear(7, 10);
  pass(1s);
  meet("b", {});
  say("b/clashes", encode_clashes({{Serial{7}, "a", {500, 0}}, {Serial{8}, "c", {1, 1}}}), true);
  pass(3s);
  ASSERT_EQ(member->clashes().size(), 1u);
  EXPECT_TRUE(member->clashes()[0].is_owner);
  EXPECT_EQ(member->clashes()[0].there, (Position{500, 0}));
  say("b/clashes", "");
  pass(25s);
  EXPECT_TRUE(member->clashes().empty());
}

TEST_F(FleetClashTest, OfOneThatIsNotThereNothingCounts) {
  settle();
  hear(7, 10);
  meet("b", {});
  say("b/clashes", encode_clashes({{Serial{7}, "a", {500, 0}}}), true);
  pass(3s);
  EXPECT_EQ(member->clashes().size(), 1u);
  say_header("b", 0, false);
  pass(25s);
  EXPECT_TRUE(member->clashes().empty());
}

TEST_F(FleetClashTest, PlacesThatAreCloseAreThoseOfOneNode) {
  const std::uint32_t serial = hear_both_at(20);
  hear_for(30s, serial, 10);
  EXPECT_TRUE(member->clashes().empty());
}

// The owner tells of it each 5 s, and hears it where it has been here about that time.
TEST_F(FleetClashTest, ANodeThatMovesIsOne) {
  const std::uint32_t serial = hear_both_at(10);
  std::int32_t x = 10;
  for (std::uint32_t i = 2; i < 20; ++i) {
    say_header("b", i);
    say_node("b", record_of(serial, x, "b", 5, i));
    hear_for(5s, serial, x, 60);
    x += 300;
    ASSERT_TRUE(member->clashes().empty()) << i;
    ASSERT_FALSE(member->is_own(*member->find(Serial{serial}))) << i;
  }
}

// As soon as an owner says that it hears it no more, it is taken.
TEST_F(FleetClashTest, ANodeThatItsOwnerHasLostIsOne) {
  const std::uint32_t serial = hear_both_at(500);
  hear_for(5s, serial, 10);
  FleetRecord lost = record_of(serial, 500, "b", 5, 2);
  lost.is_heard = false;
  say_node("b", lost);
  hear_for(20s, serial, 10);
  EXPECT_TRUE(member->is_own(*member->find(Serial{serial})));
  EXPECT_TRUE(member->clashes().empty());
  EXPECT_EQ(broker.count("a/clashes"), 0u);
}

TEST_F(FleetClashTest, WhatAnEarlierRunHasToldIsTakenBack) {
  connect();
  say("a/clashes", encode_clashes({{Serial{7}, "b", {1, 1}}}), true);
  pass(10s);
  EXPECT_EQ(broker.count("a/clashes"), 1u);
  EXPECT_EQ(broker.last("a/clashes"), "");
}

TEST_F(FleetClashTest, WhatIsNotSoundIsRefusedAndNamed) {
  std::vector<ToldClash> clashes;
  std::string wrong;
  const std::vector<ToldClash> sound{{Serial{7}, "b", {-16777216, 16777216}}};
  EXPECT_TRUE(decode_clashes(encode_clashes(sound), clashes, wrong));
  EXPECT_EQ(clashes, sound);
  for (const char* const text : {"{", "[]", R"({"clashes":1})", R"({"clashes":[1]})",
                                 R"({"clashes":[{"serial":7,"owner":"b","x":1}]})",
                                 R"({"clashes":[{"serial":4294967295,"owner":"b","x":1,"y":1}]})",
                                 R"({"clashes":[{"serial":7,"owner":"a b","x":1,"y":1}]})",
                                 R"({"clashes":[{"serial":7,"owner":"b","x":1,"y":16777217}]})"}) {
    wrong.clear();
    EXPECT_FALSE(decode_clashes(text, clashes, wrong)) << text;
    EXPECT_FALSE(wrong.empty()) << text;
    EXPECT_TRUE(clashes.empty()) << text;
  }
  settle();
  say("b/clashes", "{");
  EXPECT_EQ(member->status().rejected_count, 1u);
}

TEST(PlaceBox, IsFarFromWhatIsFartherThanItIsLarge) {
  PlaceBox box;
  EXPECT_FALSE(box.is_far_from({0, 0}, 10));
  box.add(Position{0, 0});
  EXPECT_FALSE(box.is_far_from({10, -10}, 10));
  EXPECT_TRUE(box.is_far_from({11, 0}, 10));
  EXPECT_TRUE(box.is_far_from({0, -11}, 10));
  box.add(Position{30, 0});
  EXPECT_FALSE(box.is_far_from({60, 0}, 10));
  EXPECT_TRUE(box.is_far_from({61, 0}, 10));
  PlaceBox other;
  other.add(box);
  EXPECT_EQ(other.count(), 2u);
  EXPECT_TRUE(other.is_far_from({-31, 0}, 10));
  const std::int32_t most = position_max;
  other.add(Position{-most, -most});
  EXPECT_FALSE(other.is_far_from({most, most}, 10));
}

}  // namespace
}  // namespace etcm::test
