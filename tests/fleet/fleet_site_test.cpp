// Which document of the site a member holds, tells and offers to its gateway.
#include "firmware/fleet/site_codec.h"
#include "member_fixture.h"

namespace etcm::test {
namespace {

SiteDocument drawing(std::int32_t x) {
  SiteDocument site{.plane = {.unit = 1'000'000'000}};
  site.anchors = {{x, 0}};
  return site;
}

SiteDocument numbered(std::uint32_t number, std::int32_t x, const std::string& gateway = "b") {
  SiteDocument site = drawing(x);
  site.number = number;
  site.gateway = gateway;
  return site;
}

class FleetSiteTest : public FleetMemberTest {
 protected:
  void say_site(const SiteDocument& site) { say("site", encode_site(site)); }
  // What a member that is there goes by, and what it has refused.
  void say_stand(const std::string& name, std::uint32_t beat, SiteVersion site,
                 SiteVersion refused = {}) {
    FleetHeader header{.run = {.instance = 77, .epoch = 1}, .beat = beat};
    header.is_online = true;
    header.site = site;
    header.refused_site = refused;
    say(name + "/header", encode_header(header));
  }
  FleetHeader own_header() {
    std::string wrong;
    return decode_header(broker.last("a/header"), wrong).value_or(FleetHeader{});
  }
  std::string on_broker() { return broker.last("yard/site"); }
  std::uint32_t number() { return member->site_version().number; }
  // Its own goes out while it runs, and the broker refuses it.
  void refuse_own(std::int32_t x) {
    member->set_site(drawing(x), true, now);
    member->step(now);
    const RecordingBroker::Published sent = broker.published.back();
    ASSERT_TRUE(sent.topic.ends_with("yard/site"));
    member->on_refused(sent.token, "not allowed", now);
  }
  // Starts again with what was saved; whether there is a file is said next.
  void restart() {
    const std::vector<std::byte> saved = member->save();
    start();
    ASSERT_EQ(member->restore(saved, now), "");
  }
  void restart_without_file() {
    restart();
    member->clear_site(now);
  }
  bool holds(std::int32_t x) {
    return member->site() != nullptr && member->site()->anchors[0].x == x;
  }
};

TEST_F(FleetSiteTest, TheFirstIsNumberOne) {
  member->set_site(drawing(5), false, now);
  EXPECT_TRUE(holds(5));
  EXPECT_EQ(number(), 0u);
  settle();
  EXPECT_EQ(on_broker(), encode_site(numbered(1, 5, "a")));
  EXPECT_EQ(number(), 1u);
}

TEST_F(FleetSiteTest, AnothersHoldsWhereNobodyHasChangedTheFile) {
  member->set_site(drawing(5), false, now);
  connect();
  say_site(numbered(1, 7));
  pass(5s);
  EXPECT_TRUE(holds(7));
  EXPECT_EQ(broker.count("yard/site"), 0u);
  ASSERT_EQ(gateway.offered.size(), 1u);
}

TEST_F(FleetSiteTest, AChangeHoldsForAll) {
  connect();
  say_site(numbered(4, 7));
  pass(5s);
  member->set_site(drawing(5), false, now);
  EXPECT_TRUE(holds(7));
  member->set_site(drawing(6), true, now);
  pass(1s);
  EXPECT_EQ(on_broker(), encode_site(numbered(5, 6, "a")));
}

TEST_F(FleetSiteTest, ItsOwnOfBeforeIsReplacedByItsFile) {
  member->set_site(drawing(5), false, now);
  connect();
  say_site(numbered(9, 7, "a"));
  EXPECT_TRUE(gateway.offered.empty());
  pass(5s);
  EXPECT_EQ(on_broker(), encode_site(numbered(10, 5, "a")));
}

// Its broker has an older one, which a bridge has not made new, and this member cannot see it.
TEST_F(FleetSiteTest, WhoHasAnOlderOneIsToldAgainEverLessOften) {
  member->set_site(drawing(5), false, now);
  settle();
  ASSERT_EQ(broker.count("yard/site"), 1u);
  say_header("b", 1);
  pass(settings_.period / 2 + 2s);
  EXPECT_EQ(broker.count("yard/site"), 2u);
  for (std::uint32_t beat = 2; beat < 60; ++beat) {
    say_header("b", beat);
    pass(settings_.period / 2);
  }
  EXPECT_GT(broker.count("yard/site"), 5u);
  EXPECT_LT(broker.count("yard/site"), 12u);
}

// The broker has it: an access list that lets its owner alone write it would throw others out.
TEST_F(FleetSiteTest, WhoRefusesItIsNotTakenForOneThatLacksIt) {
  settle();
  say_site(numbered(3, 7));
  for (std::uint32_t beat = 1; beat < 20; ++beat) {
    say_stand("c", beat, {}, numbered(3, 7).version());
    pass(settings_.period / 2);
  }
  EXPECT_EQ(broker.count("yard/site"), 0u);
}

TEST_F(FleetSiteTest, WhoHasAnOlderOneIsToldAgainByItsOwnerWhileThatOneIsThere) {
  settle();
  const SiteVersion newest = numbered(3, 7).version();
  say_site(numbered(3, 7));
  for (std::uint32_t beat = 1; beat < 20; ++beat) {
    say_stand("b", beat, newest);
    say_stand("c", beat, numbered(2, 6).version());
    pass(settings_.period / 2);
  }
  EXPECT_EQ(broker.count("yard/site"), 0u);
  say_header("b", 20, false);
  for (std::uint32_t beat = 20; beat < 24; ++beat) {
    say_stand("c", beat, numbered(2, 6).version());
    pass(settings_.period / 2);
  }
  EXPECT_EQ(on_broker(), encode_site(numbered(3, 7)));
}

TEST_F(FleetSiteTest, AnOwnerThatHasLostItItselfIsToldToo) {
  settle();
  say_site(numbered(3, 7));
  for (std::uint32_t beat = 1; beat < 5; ++beat) {
    say_stand("b", beat, {});
    pass(settings_.period / 2);
  }
  EXPECT_EQ(on_broker(), encode_site(numbered(3, 7)));
}

// Mosquitto 2.0.11 hangs up after a message that it refuses.
TEST_F(FleetSiteTest, WhoMayNotTellItsSiteTriesAgainOnlyWhenAsked) {
  member->set_site(drawing(5), false, now);
  connect();
  now += settings_.settle + 500ms;
  member->step(now);
  ASSERT_EQ(broker.count("yard/site"), 1u);
  const std::vector<RecordingBroker::Published> sent = broker.published;
  for (const auto& each : sent) {
    if (each.topic.ends_with("yard/site")) member->on_refused(each.token, "not allowed", now);
  }
  for (int i = 0; i < 5; ++i) {
    disconnect();
    pass(3s);
    settle();
    say_header("b", static_cast<std::uint32_t>(i + 1));
    pass(settings_.report_max);
  }
  EXPECT_EQ(broker.count("yard/site"), 1u);
  member->retry_site(now);
  pass(1s);
  EXPECT_EQ(broker.count("yard/site"), 2u);
  EXPECT_EQ(count_lines("reload the broker and then this gateway"), 1u);
}

TEST_F(FleetSiteTest, ASecondOfItsNameIsNotOutbid) {
  member->set_site(drawing(5), false, now);
  settle();
  say_site(numbered(2, 7, "a"));
  pass(5s);
  EXPECT_TRUE(holds(7));
  EXPECT_EQ(broker.count("yard/site"), 1u);
}

// An earlier run had told it, and its power failed before that was saved.
TEST_F(FleetSiteTest, ItsOwnOfBeforeOfTheSameNumberIsReplacedThoughItComesLate) {
  member->set_site(drawing(5), false, now);
  settle();
  ASSERT_EQ(number(), 1u);
  std::int32_t x = 6;
  while (numbered(1, x, "a").version() < member->site_version()) ++x;
  say_site(numbered(1, x, "a"));
  pass(5s);
  EXPECT_TRUE(gateway.offered.empty());
  EXPECT_EQ(on_broker(), encode_site(numbered(2, 5, "a")));
}

TEST_F(FleetSiteTest, ANewerOneIsOfferedAndAnOlderOneReplaced) {
  member->set_site(drawing(5), false, now);
  settle();
  say_site(numbered(3, 6));
  ASSERT_EQ(gateway.offered.size(), 1u);
  EXPECT_TRUE(holds(6));
  pass(30s);
  EXPECT_EQ(broker.count("yard/site"), 1u);
  // Played back by somebody. Who has it from elsewhere waits whether its owner says it.
  say_site(numbered(2, 7));
  pass(1s);
  EXPECT_EQ(broker.count("yard/site"), 1u);
  pass(21s);
  EXPECT_EQ(on_broker(), encode_site(numbered(3, 6)));
  EXPECT_EQ(gateway.offered.size(), 1u);
}

TEST_F(FleetSiteTest, WhatTheBrokerForgotIsToldByItsOwnerAtOnceByOthersWhereNobodyDoes) {
  member->set_site(drawing(5), false, now);
  settle();
  say("site", "");
  pass(1s);
  EXPECT_EQ(broker.count("yard/site"), 2u);
  say_site(numbered(2, 6));
  say("site", "");
  pass(5s);
  say_site(numbered(2, 6));
  pass(40s);
  EXPECT_EQ(broker.count("yard/site"), 2u);
  say("site", "");
  pass(21s);
  EXPECT_EQ(on_broker(), encode_site(numbered(2, 6)));
}

TEST_F(FleetSiteTest, ARefusedOneIsOfferedOnceAndAgainWhenAsked) {
  member->set_site(drawing(5), false, now);
  settle();
  gateway.refusal = "its domain is elsewhere";
  for (int i = 0; i < 3; ++i) say_site(numbered(3, 6));
  EXPECT_EQ(gateway.offered.size(), 1u);
  EXPECT_EQ(count_lines("the site of gateway 'b', number 3, is refused: its domain is elsewhere"),
            1u);
  EXPECT_NE(member->status().site_trouble, "");
  EXPECT_TRUE(holds(5));
  pass(settings_.period);
  EXPECT_EQ(own_header().refused_site, numbered(3, 6).version()) << "the others are told";
  EXPECT_EQ(broker.count("yard/site"), 1u);
  gateway.refusal.clear();
  member->retry_site(now);
  EXPECT_TRUE(holds(6));
  pass(settings_.period);
  EXPECT_EQ(own_header().refused_site, SiteVersion{});
  EXPECT_EQ(member->status().site_trouble, "");
}

TEST_F(FleetSiteTest, AChangeIsNewerThanWhatWasRefused) {
  member->set_site(drawing(5), false, now);
  settle();
  gateway.refusal = "its domain is elsewhere";
  say_site(numbered(3, 6));
  member->set_site(drawing(8), true, now);
  pass(1s);
  EXPECT_EQ(on_broker(), encode_site(numbered(4, 8, "a")));
  EXPECT_EQ(member->status().site_trouble, "");
}

TEST_F(FleetSiteTest, WhoStartsDoesNotReplaceWhatItRefuses) {
  gateway.refusal = "its domain is elsewhere";
  member->set_site(drawing(5), false, now);
  connect();
  say_site(numbered(3, 6));
  pass(30s);
  EXPECT_EQ(broker.count("yard/site"), 0u);
  EXPECT_TRUE(holds(5));
}

TEST_F(FleetSiteTest, WhatIsNotSoundIsNamedAndReplaced) {
  member->set_site(drawing(5), false, now);
  settle();
  const std::string sound = encode_site(numbered(3, 6));
  std::string wrong_hash = sound;
  wrong_hash[wrong_hash.find("\"hash\":\"") + 9] ^= 1;
  const std::string sly[] = {
      "{\"number\":9}",          "[[[[[[[[[[[[[[[[", sound.substr(0, sound.size() / 2),
      std::string(300'000, ' '), wrong_hash,         encode_site(numbered(fleet_number_max, 6))};
  for (const std::string& payload : sly) say("site", payload);
  EXPECT_TRUE(gateway.offered.empty());
  EXPECT_EQ(member->status().rejected_count, std::size(sly));
  EXPECT_EQ(count_lines("the site on the broker is not sound: "), std::size(sly));
  EXPECT_EQ(member->status().site_trouble,
            "the site on the broker is not sound: number is far beyond the last one; the old one "
            "stays; look who may write etcm/v1/yard/site");
  pass(6s);
  EXPECT_EQ(broker.count("yard/site"), 2u);
  say_site(numbered(1, 5, "a"));
  EXPECT_EQ(member->status().site_trouble, "");
}

// Nothing of a fleet without a site takes its place.
TEST_F(FleetSiteTest, WhatIsNotSoundIsForgottenWhereThereIsNone) {
  connect();
  settle();
  say("site", "{\"hello\":1}");
  const std::string trouble = member->status().site_trouble;
  EXPECT_NE(trouble.find("is not sound"), std::string::npos) << trouble;
  EXPECT_NE(trouble.find("mosquitto_pub -r -n -t etcm/v1/yard/site"), std::string::npos) << trouble;
  say("site", "");
  EXPECT_EQ(member->status().site_trouble, "");
  say("site", "{\"hello\":1}");
  pass(settings_.report_max - 10s);
  EXPECT_EQ(member->status().site_trouble, trouble) << "it may be there still";
  pass(20s);
  EXPECT_EQ(member->status().site_trouble, "");
}

TEST_F(FleetSiteTest, ItOutlivesARestart) {
  connect();
  say_site(numbered(2, 5));
  EXPECT_EQ(FleetMember::saved_site(member->save()), numbered(2, 5));
  restart();
  EXPECT_TRUE(holds(5));
  EXPECT_EQ(number(), 2u);
  member->set_site(drawing(6), false, now);
  EXPECT_TRUE(holds(5));
}

TEST_F(FleetSiteTest, AFileThatWasChangedMeanwhileIsItsNewOne) {
  member->set_site(drawing(5), false, now);
  settle();
  restart();
  member->set_site(drawing(6), false, now);
  EXPECT_TRUE(holds(6));
  settle();
  EXPECT_EQ(on_broker(), encode_site(numbered(2, 6, "a")));
}

TEST_F(FleetSiteTest, WhoMayNotTellItsSiteIsTold) {
  member->set_site(drawing(5), false, now);
  connect();
  for (int i = 0; i < 6 && broker.count("yard/site") == 0; ++i) {
    now += 500ms;
    member->step(now);
  }
  for (const auto& each : broker.published) {
    if (each.topic.ends_with("yard/site")) member->on_refused(each.token, "its access list", now);
  }
  EXPECT_NE(
      member->status().site_trouble.find("the broker does not let this gateway tell its site"),
      std::string::npos);
  EXPECT_NE(member->status().site_trouble.find(
                "add `topic readwrite etcm/v1/yard/site` under `user a` in etcm.acl"),
            std::string::npos);
  EXPECT_TRUE(member->status().is_site_refused);
  EXPECT_EQ(count_lines("does not let this gateway tell its site"), 1u);
}

TEST_F(FleetSiteTest, AFileThatIsTakenOutBeforeItWasToldIsNothing) {
  member->set_site(drawing(5), false, now);
  member->clear_site(now);
  EXPECT_EQ(member->site(), nullptr);
  settle();
  EXPECT_EQ(broker.count("yard/site"), 0u);
}

TEST_F(FleetSiteTest, AFileTakenOutThatTheBrokerRefusedGivesWayToTheFleets) {
  settle();
  say_site(numbered(3, 7));
  refuse_own(5);
  EXPECT_TRUE(holds(5));
  EXPECT_EQ(number(), 4u);
  member->clear_site(now);
  member->retry_site(now);
  EXPECT_TRUE(holds(7));
  EXPECT_EQ(number(), 3u);
  EXPECT_EQ(member->status().site_trouble, "");
  pass(settings_.report_max);
  EXPECT_EQ(broker.count("yard/site"), 1u);
}

TEST_F(FleetSiteTest, WhatCameOfTheFleetMeanwhileHoldsWhenTheFileIsTakenOut) {
  settle();
  say_site(numbered(8, 7));
  refuse_own(5);
  say_site(numbered(2, 6));
  member->clear_site(now);
  EXPECT_TRUE(holds(6));
}

TEST_F(FleetSiteTest, AFileTakenOutBeforeARestartIsNeverTold) {
  settle();
  say_site(numbered(3, 7));
  refuse_own(5);
  EXPECT_FALSE(FleetMember::saved_site(member->save()));
  restart_without_file();
  EXPECT_EQ(member->site(), nullptr);
  settle();
  pass(settings_.report_max);
  EXPECT_EQ(broker.count("yard/site"), 0u);
  say_site(numbered(3, 7));
  EXPECT_TRUE(holds(7));
  EXPECT_EQ(member->status().site_trouble, "");
}

TEST_F(FleetSiteTest, AFileThatWasRefusedAndIsStillThereOutlivesARestart) {
  settle();
  say_site(numbered(3, 7));
  refuse_own(5);
  restart();
  member->set_site(drawing(5), false, now);
  connect();
  say_site(numbered(3, 7));
  pass(settings_.settle + 1s);
  EXPECT_EQ(on_broker(), encode_site(numbered(4, 5, "a")));
}

TEST_F(FleetSiteTest, AFileTakenOutBeforeItWasSentIsNeverTold) {
  settle();
  say_site(numbered(3, 7));
  disconnect();
  member->set_site(drawing(5), true, now);
  pass(1s);
  member->clear_site(now);
  EXPECT_TRUE(holds(7));
  connect();
  say_site(numbered(3, 7));
  pass(settings_.report_max);
  EXPECT_EQ(broker.count("yard/site"), 0u);
}

TEST_F(FleetSiteTest, AFileTakenOutThatTheBrokerTookStaysTheFleets) {
  settle();
  say_site(numbered(3, 7));
  member->set_site(drawing(5), true, now);
  pass(1s);
  member->clear_site(now);
  EXPECT_TRUE(holds(5));
  restart_without_file();
  EXPECT_TRUE(holds(5));
  settle();
  pass(settings_.period);
  EXPECT_EQ(on_broker(), encode_site(numbered(4, 5, "a")));
}

// It may be on the broker by now.
TEST_F(FleetSiteTest, AFileAfterOneThatWasTakenOutUnsentIsNewerThanThat) {
  settle();
  say_site(numbered(3, 7));
  refuse_own(5);
  member->clear_site(now);
  member->set_site(drawing(6), true, now);
  EXPECT_EQ(number(), 5u);
}

// Others may have it, and tell it once the broker has forgotten all.
TEST_F(FleetSiteTest, AFileAfterOneThatWasTakenOutUnsentIsNewerThanThatAfterARestartToo) {
  settle();
  say_site(numbered(3, 7));
  refuse_own(5);
  restart_without_file();
  restart();
  member->set_site(drawing(6), false, now);
  settle();
  say_site(numbered(4, 5, "a"));
  pass(settings_.period);
  EXPECT_EQ(on_broker(), encode_site(numbered(5, 6, "a")));
}

TEST_F(FleetSiteTest, AFileAfterOneThatWasTakenOutIsLessThanAnothersAtAStart) {
  settle();
  refuse_own(5);
  member->clear_site(now);
  restart();
  member->set_site(drawing(6), false, now);
  connect();
  say_site(numbered(1, 7));
  pass(settings_.period);
  EXPECT_TRUE(holds(7));
  EXPECT_EQ(broker.count("yard/site"), 0u);
}

TEST_F(FleetSiteTest, NoSavedSiteIsNoneInRubbish) {
  const std::vector<std::byte> saved = member->save();
  EXPECT_FALSE(FleetMember::saved_site(saved));
  for (std::size_t size = 0; size < saved.size(); ++size) {
    EXPECT_FALSE(FleetMember::saved_site(std::span(saved).first(size)));
  }
}

}  // namespace
}  // namespace etcm::test
