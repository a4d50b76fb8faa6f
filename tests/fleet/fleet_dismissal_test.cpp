// A member that will not come back: who leaves it out of the list of members, and for how long.
#include "member_fixture.h"

namespace etcm::test {
namespace {

class FleetDismissalTest : public FleetMemberTest {
 protected:
  // b was there with a node, has gone, and its node has been buried.
  FleetDismissalTest() {
    settle();
    meet("b", {record_of(7, 70, "b", 3, 1)});
    say_header("b", 2, false);
  }
  void bury() { pass(settings_.leave_after + 2s); }
};

TEST_F(FleetDismissalTest, IsRefusedWhileItIsThereOrItsNodesAre) {
  EXPECT_FALSE(member->dismiss("b"));
  EXPECT_FALSE(member->dismiss("nobody"));
  EXPECT_EQ(member->peers().size(), 1u);
  say_header("b", 3);
  say("b/" + topic_tail(TopicKind::node, Serial{7}), "");
  say_set("b", {});
  pass(settings_.period);
  ASSERT_EQ(member->peers().at(0).node_count, 0u);
  EXPECT_FALSE(member->dismiss("b"));
}

TEST_F(FleetDismissalTest, HoldsUntilItIsBack) {
  bury();
  ASSERT_EQ(member->peers().size(), 1u);
  static_cast<void>(member->take_news_to_save());
  EXPECT_TRUE(member->dismiss("b"));
  EXPECT_TRUE(member->take_news_to_save());
  EXPECT_TRUE(member->peers().empty());
  EXPECT_EQ(published(7).left, LeftReason::gateway_gone) << "its own topics still have the node";
  pass(settings_.leave_after * 3);
  EXPECT_EQ(published(7).left, LeftReason::gateway_gone);
  say_header("b", 3);
  EXPECT_EQ(member->peers().size(), 1u);
  say_header("b", 4, false);
  EXPECT_EQ(member->peers().size(), 1u) << "it may be away for a moment only";
}

TEST_F(FleetDismissalTest, OutlivesARestart) {
  bury();
  ASSERT_TRUE(member->dismiss("b"));
  const std::vector<std::byte> saved = member->save();
  EXPECT_LE(saved.size(), save_bytes_max(settings_));
  start();
  ASSERT_EQ(member->restore(saved, now), "");
  connect();
  say_header("b", 2, false);
  say_node("b", record_of(7, 70, "b", 3, 1));
  say_set("b", {record_of(7, 70, "b", 3, 1)});
  pass(settings_.settle + 1s);
  EXPECT_TRUE(member->peers().empty());
  EXPECT_EQ(member->find(Serial{7}), nullptr);
}

TEST_F(FleetDismissalTest, IsNotNeededWhereItsTopicsAreEmptied) {
  bury();
  say("b/" + topic_tail(TopicKind::node, Serial{7}), "");
  say("b/set", "");
  say("b/header", "");
  EXPECT_TRUE(member->peers().empty());
  pass(settings_.leave_after + settings_.silent_after + 2s);
  EXPECT_EQ(broker.last(node_topic(7)), "") << "nobody has the node any more";
}

}  // namespace
}  // namespace etcm::test
