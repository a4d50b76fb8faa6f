// One document of the site in all gateways: whose file counts, what is refused, and what outlasts
// what.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fleet_members.h"
#include "page_reader.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

constexpr const char* site_topic = "etcm/v1/site/site";

FeatureSettings site_line(Position from, Position to, std::string name = {}) {
  return {.from = FeatureEnd::anchor(from),
          .to = FeatureEnd::anchor(to),
          .name = std::move(name),
          .source = "yard.poly:7"};
}

// A site file with one line from one anchor to another.
void draw_site(Settings& settings, Position from, Position to) {
  settings.site.path = "yard.poly";
  settings.site.unit_length = site_nano;
  settings.anchors = {{.position = from, .source = "yard.poly:2"},
                      {.position = to, .source = "yard.poly:3"}};
  settings.features = {site_line(from, to, "fence")};
}

void take_out_site(Settings& settings) {
  settings.site.path.clear();
  settings.features.clear();
  settings.anchors.clear();
}

class FleetSiteGateway : public testing::Test {
 protected:
  FleetSiteGateway() : west_(hub_, "west"), east_(hub_, "east"), office_(hub_, "office") {
    for (Member* const member : all_) member->rig.settings.site.unit_length = site_nano;
    west_.put(1, 1, 0, 0);
    west_.put(2, 2, 100, 3);
    east_.put(11, 1, 100, 100);
    east_.put(12, 2, 0, 107);
    draw_site(west_.rig.settings, {10, 50}, {90, 51});
  }
  void run_all(port::Duration duration = 8s) { run({&west_, &east_, &office_}, duration); }
  // All have this line, and the same mesh with so many nodes.
  void expect_line(Position from, Position to) {
    for (const Member* const member : all_) {
      const auto records = member->features();
      ASSERT_EQ(records.size(), 1u) << member->name();
      EXPECT_TRUE(records[0].is_active());
      EXPECT_EQ(records[0].settings.from, FeatureEnd::anchor(from)) << member->name();
      EXPECT_EQ(records[0].settings.to, FeatureEnd::anchor(to));
      EXPECT_EQ(member->mesh_hash(), west_.mesh_hash()) << member->name();
      EXPECT_EQ(member->fleet().agreeing, 3u) << member->name();
    }
  }
  std::string retained() const {
    const auto at = hub_.retained().find(site_topic);
    return at == hub_.retained().end() ? "" : at->second;
  }
  SiteDocument sent() const {
    std::string wrong;
    return decode_site(retained(), wrong).value_or(SiteDocument{});
  }
  // As the list of this one has it of that one.
  static std::string why_differs(const Member& member, const std::string& name) {
    for (const ReportedMember& row : member.fleet().members) {
      if (row.name == name) return row.why;
    }
    return "it is not in the list";
  }
  // Somebody with the rights of a gateway says so.
  void say(SiteDocument document) {
    document.gateway = "sly";
    hub_.publish(site_topic, encode_site(document), true);
  }

  MessageHub hub_;
  Member west_;
  Member east_;
  Member office_;
  Member* const all_[3] = {&west_, &east_, &office_};
};

TEST_F(FleetSiteGateway, TheFileOfOneIsTheSiteOfAll) {
  run_all();
  expect_line({10, 50}, {90, 51});
  EXPECT_EQ(office_.features()[0].settings.name, "fence");
  EXPECT_EQ(
      office_.rig.log.count("fleet: the site of gateway 'west', number 1, holds: 1 segments of "
                            "features, 2 anchors"),
      1u);
  EXPECT_EQ(office_.fleet().site_number, 1u);
  EXPECT_EQ(office_.fleet().site_gateway, "west");
  EXPECT_EQ(office_.fleet().site_trouble, "");
  EXPECT_EQ(west_.rig.log.count("yard.poly"), 0u);
}

TEST_F(FleetSiteGateway, AReloadIsTheNextOne) {
  run_all();
  draw_site(west_.rig.settings, {20, 60}, {80, 62});
  west_.rig.update_settings();
  run_all(3s);
  expect_line({20, 60}, {80, 62});
  EXPECT_EQ(sent().number, 2u);
  // Of something else, which happens every day.
  west_.rig.update_settings();
  east_.rig.update_settings();
  run_all(3s);
  expect_line({20, 60}, {80, 62});
  EXPECT_EQ(sent().number, 2u);
  // And the last line goes.
  west_.rig.settings.features.clear();
  west_.rig.update_settings();
  run_all(3s);
  EXPECT_TRUE(office_.features().empty());
  EXPECT_EQ(office_.mesh_hash(), west_.mesh_hash());
}

TEST_F(FleetSiteGateway, OfTwoFilesOneHoldsForBothAndTheOtherIsNamed) {
  draw_site(east_.rig.settings, {10, 50}, {90, 55});
  run_all();
  ASSERT_NE(sent().gateway, "");
  Member& loser = sent().gateway == "west" ? east_ : west_;
  const SiteFeature line_of_all = sent().features[0];
  expect_line(line_of_all.from.position, line_of_all.to.position);
  EXPECT_NE(loser.fleet().site_trouble.find(
                "the site of gateway '" + sent().gateway +
                "', number 1, holds here too, and differs from this gateway's own, yard.poly; "),
            std::string::npos)
      << loser.fleet().site_trouble;
  EXPECT_EQ(loser.rig.log.count("differs from this gateway's own"), 1u);
  EXPECT_EQ(office_.fleet().site_trouble, "");
  // It is taken out there: nothing is wrong any more.
  take_out_site(loser.rig.settings);
  loser.rig.update_settings();
  run_all(2s);
  expect_line(line_of_all.from.position, line_of_all.to.position);
  EXPECT_EQ(loser.fleet().site_trouble, "");
}

TEST_F(FleetSiteGateway, FeaturesInTwoSettingsAreNamedByTheirLine) {
  east_.rig.settings.features = {{.from = Serial{1}, .to = Serial{2}, .source = "east.toml:7"}};
  west_.rig.settings.features = {{.from = Serial{3}, .to = Serial{4}, .source = "west.toml:9"}};
  run_all();
  const bool is_wests = sent().gateway == "west";
  const std::string trouble = (is_wests ? east_ : west_).fleet().site_trouble;
  EXPECT_NE(trouble.find(std::string("own, the [[feature]] of ") +
                         (is_wests ? "east.toml:7" : "west.toml:9") + "; take that out here"),
            std::string::npos)
      << trouble;
}

TEST_F(FleetSiteGateway, TheSameFileInTwoIsNoQuarrel) {
  draw_site(east_.rig.settings, {10, 50}, {90, 51});
  run_all();
  expect_line({10, 50}, {90, 51});
  for (const Member* const member : all_) EXPECT_EQ(member->fleet().site_trouble, "");
}

TEST_F(FleetSiteGateway, AChangeOfTheOtherFileHoldsForAll) {
  run_all();
  draw_site(east_.rig.settings, {10, 40}, {90, 41});
  east_.rig.update_settings();
  run_all(3s);
  expect_line({10, 40}, {90, 41});
  EXPECT_NE(west_.fleet().site_trouble, "");
  EXPECT_EQ(east_.fleet().site_trouble, "");
}

TEST_F(FleetSiteGateway, WhatCannotBeInAMeshIsRefusedAndTheOldOneStays) {
  run_all();
  const SiteDocument good = sent();
  const auto refuse = [&](const SiteDocument& bad, const std::string& why) {
    SiteDocument next = bad;
    next.number = sent().number + 1;
    say(next);
    run_all(1s);
    EXPECT_NE(office_.fleet().site_trouble.find(why), std::string::npos)
        << office_.fleet().site_trouble;
    EXPECT_EQ(office_.rig.log.count(why), 1u) << why;
    expect_line({10, 50}, {90, 51});
  };
  SiteDocument bad = good;
  bad.anchors.push_back({50, 0});
  bad.anchors.push_back({50, 99});
  bad.features.push_back({.from = FeatureEnd::anchor({50, 0}), .to = FeatureEnd::anchor({50, 99})});
  refuse(bad, "the line from (50, 0) to (50, 99) crosses 'fence'");
  bad = good;
  bad.features.push_back({.from = bad.features[0].to, .to = bad.features[0].from});
  refuse(bad, "repeats");
  bad = good;
  bad.features[0].from = FeatureEnd::anchor({1, 1});
  refuse(bad, "a feature ends at (1, 1), where no anchor is");
  bad = good;
  bad.anchors.push_back(bad.anchors[0]);
  refuse(bad, "the anchor at (10, 50) repeats");
  bad = good;
  bad.features[0].to = bad.features[0].from;
  refuse(bad, "a feature ends where it begins, (10, 50)");
  bad = good;
  bad.outline = {{.from = to_point(Position{0, 0}), .to = to_point(Position{5, 0})}};
  refuse(bad, "no closed rings");
  bad = good;
  for (std::uint32_t i = 0; i < 60; ++i) bad.features.push_back({Serial{i + 50}, Serial{i + 51}});
  refuse(bad, "features_max in [mesh] is 50");
  bad = good;
  for (std::int32_t i = 0; i < 200; ++i) bad.anchors.push_back({1000 + i, i * i});
  refuse(bad, "vertices_max in [mesh] is 100");
  EXPECT_EQ(sent().gateway, "sly");
  // And whoever has the file has the last word.
  draw_site(west_.rig.settings, {10, 50}, {90, 52});
  west_.rig.update_settings();
  run_all(3s);
  expect_line({10, 50}, {90, 52});
  EXPECT_EQ(office_.fleet().site_trouble, "");
}

TEST_F(FleetSiteGateway, WhatIsNotSoundIsReplaced) {
  run_all();
  for (const std::string& payload : {std::string("{"), retained().substr(0, retained().size() / 2),
                                     std::string(R"({"number":18446744073709551615})")}) {
    hub_.publish(site_topic, payload, true);
    run_all(2s);
    EXPECT_EQ(sent().number, 1u);
    EXPECT_EQ(office_.fleet().site_trouble, "");
  }
  EXPECT_EQ(office_.rig.log.count("the site on the broker is not sound: "), 3u);
  expect_line({10, 50}, {90, 51});
}

TEST_F(FleetSiteGateway, AnotherPlaneIsRefusedWhereItIsSaidWhichItIs) {
  east_.rig.settings.site.origin = {.x = 5 * site_nano};
  run_all();
  EXPECT_NE(
      east_.fleet().site_trouble.find(
          "is refused: it is in another plane, with unit = \"1\", origin = [\"0\", \"0\"], and "
          "this gateway has unit = \"1\", origin = [\"5\", \"0\"]; set these"),
      std::string::npos)
      << east_.fleet().site_trouble;
  EXPECT_TRUE(east_.features().empty());
  east_.rig.settings.site.origin = {};
  east_.rig.update_settings();
  run_all(2s);
  expect_line({10, 50}, {90, 51});
  EXPECT_EQ(east_.fleet().site_trouble, "");
}

TEST_F(FleetSiteGateway, ATakerHasItAfterARestartWithoutTheBroker) {
  run_all();
  const std::uint64_t hash = office_.mesh_hash();
  hub_.go();
  const std::unique_ptr<Member> again = office_.restarted(hub_, 77);
  ASSERT_EQ(again->features().size(), 1u);
  EXPECT_TRUE(again->features()[0].is_active());
  EXPECT_EQ(again->mesh_hash(), hash);
  EXPECT_EQ(again->rig.log.count("restored the mesh of generation"), 1u);
  run({&west_, &east_, again.get()}, 2s);
  EXPECT_EQ(again->mesh_hash(), hash);
  hub_.come_back();
  run({&west_, &east_, again.get()}, 5s);
  EXPECT_EQ(again->mesh_hash(), west_.mesh_hash());
  EXPECT_EQ(again->fleet().agreeing, 3u);
}

TEST_F(FleetSiteGateway, AFileThatWasEditedBeforeARestartIsTheNextOne) {
  run_all();
  draw_site(west_.rig.settings, {20, 60}, {80, 62});
  const std::unique_ptr<Member> again = west_.restarted(hub_, 77);
  run({again.get(), &east_, &office_}, 6s);
  EXPECT_EQ(sent().number, 2u);
  EXPECT_EQ(office_.features()[0].settings.from, FeatureEnd::anchor({20, 60}));
  EXPECT_EQ(office_.mesh_hash(), again->mesh_hash());
}

TEST_F(FleetSiteGateway, AnotherPlaneBeforeARestartIsNotRefusedForWhatItsOwnFileWas) {
  run_all();
  west_.rig.settings.site.origin = {.x = 5 * site_nano};
  const std::unique_ptr<Member> again = west_.restarted(hub_, 77);
  run({again.get(), &east_, &office_}, 6s);
  EXPECT_EQ(sent().number, 2u);
  EXPECT_EQ(sent().plane.x, 5 * site_nano);
  EXPECT_EQ(again->rig.log.count("is refused"), 0u);
  EXPECT_EQ(again->features().size(), 1u);
  EXPECT_EQ(again->fleet().site_trouble, "");
}

TEST_F(FleetSiteGateway, AFileThatTheBrokerRefusesIsGoneWhenItIsTakenOut) {
  run_all();
  east_.client.denied = site_topic;
  draw_site(east_.rig.settings, {10, 40}, {90, 41});
  east_.rig.update_settings();
  run_all(3s);
  EXPECT_NE(east_.fleet().site_trouble.find("does not let this gateway tell its site"),
            std::string::npos)
      << east_.fleet().site_trouble;
  const std::string cure = "add `topic readwrite etcm/v1/site/site` under `user east` in etcm.acl";
  EXPECT_NE(why_differs(east_, "west").find(cure), std::string::npos) << why_differs(east_, "west");
  EXPECT_NE(why_differs(office_, "east").find("the broker does not take it from 'east'"),
            std::string::npos)
      << why_differs(office_, "east");
  EXPECT_EQ(east_.features()[0].settings.from, FeatureEnd::anchor({10, 40}));
  take_out_site(east_.rig.settings);
  east_.rig.update_settings();
  run_all(3s);
  expect_line({10, 50}, {90, 51});
  EXPECT_EQ(east_.fleet().site_trouble, "");
  // Nor does it come back when it may write.
  east_.client.denied.clear();
  east_.rig.update_settings();
  run_all(3s);
  expect_line({10, 50}, {90, 51});
  EXPECT_EQ(sent().number, 1u);
}

TEST_F(FleetSiteGateway, AFileThatTheBrokerRefusedIsGoneWhenItIsTakenOutBeforeARestart) {
  run_all();
  east_.client.denied = site_topic;
  draw_site(east_.rig.settings, {10, 40}, {90, 41});
  east_.rig.update_settings();
  run_all(3s);
  take_out_site(east_.rig.settings);
  const std::unique_ptr<Member> again = east_.restarted(hub_, 77);
  EXPECT_TRUE(again->features().empty());
  run({&west_, again.get(), &office_}, 6s);
  ASSERT_EQ(again->features().size(), 1u);
  EXPECT_EQ(again->features()[0].settings.from, FeatureEnd::anchor({10, 50}));
  EXPECT_EQ(again->mesh_hash(), west_.mesh_hash());
  EXPECT_EQ(again->fleet().agreeing, 3u);
  EXPECT_EQ(again->fleet().site_trouble, "");
  EXPECT_EQ(sent().number, 1u);
}

TEST_F(FleetSiteGateway, ABrokerThatForgotIsToldAgain) {
  run_all();
  hub_.go();
  hub_.forget();
  run_all(500ms);
  hub_.come_back();
  run_all(4s);
  EXPECT_EQ(sent().number, 1u);
  EXPECT_EQ(sent().gateway, "west");
  // Also where the one with the file is away.
  west_.client.lose();
  west_.client.is_cut_off = true;
  hub_.go();
  hub_.forget();
  run({&east_, &office_}, 500ms);
  hub_.come_back();
  run({&east_, &office_}, 6s);
  EXPECT_EQ(sent().gateway, "west");
}

TEST_F(FleetSiteGateway, WithoutAPlaneOfItsOwnItTakesThatOfTheSite) {
  for (Member* const member : {&west_, &east_}) {
    member->rig.settings.site.unit_length = site_nano / 100;
    member->rig.settings.site.origin = {.x = 390'000 * site_nano, .y = 5 * site_nano};
  }
  run_all();
  expect_line({10, 50}, {90, 51});
  EXPECT_EQ(office_.rig.gateway->settings().site.unit_length, site_nano / 100);
  EXPECT_EQ(office_.rig.gateway->settings().site.origin.x, 390'000 * site_nano);
}

TEST_F(FleetSiteGateway, WhoOnlyPublishesKeepsItsOwnSite) {
  Member own(hub_, "own", FleetShare::publish);
  draw_site(own.rig.settings, {1, 1}, {7, 2});
  run({&west_, &east_, &office_, &own}, 8s);
  EXPECT_EQ(own.features()[0].settings.to, FeatureEnd::anchor({7, 2}));
  EXPECT_EQ(own.fleet().site_trouble, "");
  EXPECT_EQ(sent().gateway, "west");
}

TEST_F(FleetSiteGateway, WhatIsTooLargeForTheBrokerIsSaid) {
  Settings& settings = west_.rig.settings;
  settings.mesh.features_max = 20'000;
  for (std::uint32_t i = 0; i < 12'000; ++i) {
    settings.features.push_back({.from = Serial{i}, .to = Serial{i + 1}, .source = "yard.poly:9"});
  }
  run_all(3s);
  EXPECT_EQ(retained(), "");
  EXPECT_NE(west_.fleet().site_trouble.find("cannot be shared: it is too long; "),
            std::string::npos)
      << west_.fleet().site_trouble;
}

TEST_F(FleetSiteGateway, PageMetricsAndHealthTellIt) {
  draw_site(east_.rig.settings, {10, 50}, {90, 55});
  run_all();
  Member& loser = sent().gateway == "west" ? east_ : west_;
  struct Reader : PageReader {
    explicit Reader(Rig& rig) : PageReader(rig) { make_page(); }
    using PageReader::get;
  } page(loser.rig), office_page(office_.rig);
  const std::string trouble = ",\"site_trouble\":\"the site of gateway '" + sent().gateway;
  EXPECT_NE(page.get("/status.json").find(trouble), std::string::npos);
  EXPECT_NE(page.get("/healthz").find("fleet: the site of gateway '"), std::string::npos);
  EXPECT_NE(office_page.get("/status.json")
                .find(",\"site_number\":1,\"site_gateway\":\"" + sent().gateway + "\""),
            std::string::npos);
  EXPECT_NE(page.get("/metrics").find("etcm_fleet_site_number 1"), std::string::npos);
  EXPECT_NE(page.get("/metrics").find("etcm_fleet_site_trouble 1"), std::string::npos);
  const auto alarms = hub_.retained().find("etcm/v1/site/" + loser.name() + "/alarms");
  ASSERT_NE(alarms, hub_.retained().end());
  EXPECT_NE(alarms->second.find("{\"name\":\"site\",\"text\":\"the site of gateway"),
            std::string::npos)
      << alarms->second;
}

}  // namespace
}  // namespace etcm::firmware
