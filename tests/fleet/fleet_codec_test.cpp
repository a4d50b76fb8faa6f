// What goes over the broker, there and back; and what nobody should ever have sent.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_topics.h"
#include "firmware/fleet/header_codec.h"
#include "firmware/fleet/record_codec.h"
#include "firmware/fleet/site_codec.h"
#include "inputs/random.h"

namespace etcm::firmware {
namespace {

FleetRecord full_record() {
  FleetRecord record;
  record.node = {.serial = Serial{1001},
                 .position = Position{.x = -12, .y = 16'777'216},
                 .longitude = "-0.123456789",
                 .latitude = "51.5",
                 .status = 9,
                 .readings = {{.name = "temperature", .unit = "°C", .nano = -21'500'000'001},
                              {.name = "say \"ah\" \\", .unit = "", .nano = std::nullopt}},
                 .heard_at = "2026-03-01T12:00:00Z",
                 .age_s = 3};
  record.owner = "yard-a.1_b";
  record.incarnation = fleet_number_max;
  record.sequence = 7;
  record.is_heard = true;
  return record;
}

std::string wrong_with(std::string_view payload, Serial serial = Serial{1001}) {
  std::string wrong;
  return decode_record(payload, serial, wrong) ? "" : wrong;
}

// A sound record, with one part of its text replaced.
std::string with(const std::string& what, const std::string& other) {
  std::string text = encode_record(full_record());
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what << " in " << text;
  return text.replace(at, what.size(), other);
}

TEST(FleetRecordCodec, EverythingComesBack) {
  const FleetRecord record = full_record();
  std::string wrong;
  const auto back = decode_record(encode_record(record), Serial{1001}, wrong);
  ASSERT_TRUE(back) << wrong;
  EXPECT_TRUE(has_same_content(back->node, record.node));
  EXPECT_EQ(back->node.heard_at, record.node.heard_at);
  EXPECT_EQ(back->node.age_s, 3u);
  EXPECT_EQ(compare(*back, record), std::strong_ordering::equal);
  EXPECT_EQ(record_hash(*back), record_hash(record));
}

TEST(FleetRecordCodec, ANodeNeedNotHaveAPlace) {
  FleetRecord record = full_record();
  record.node.position.reset();
  record.left = LeftReason::gateway_gone;
  std::string wrong;
  const auto back = decode_record(encode_record(record), Serial{1001}, wrong);
  ASSERT_TRUE(back) << wrong;
  EXPECT_FALSE(back->node.position);
  EXPECT_EQ(back->left, LeftReason::gateway_gone);
}

TEST(FleetRecordCodec, FieldsThatNobodyKnowsAreLeftToThoseWhoDo) {
  EXPECT_EQ(wrong_with(with("{", R"({"colour":{"of":["it",null]},)")), "");
}

TEST(FleetRecordCodec, WhatIsNotSoundIsNamed) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "is no JSON"},
      {"null", "is no object"},
      {"[1]", "is no object"},
      {"{}", "serial is missing"},
      {"{\"serial\":1001", "is no JSON"},
      {std::string(3000, '['), "nested more than 8 deep"},
      {"{\"a\":" + std::string(3000, '['), "nested more than 8 deep"},
      {std::string(record_bytes_max + 1, ' '), "is too long"},
      {with("\"serial\":1001", "\"serial\":1001,\"serial\":1001"), "stands twice"},
      {with("\"serial\":1001", "\"serial\":1002"), "serial is not that of the topic"},
      {with("\"serial\":1001", "\"serial\":-1"), "serial is out of range"},
      {with("\"serial\":1001", "\"serial\":1001.5"), "serial is out of range"},
      {with("\"serial\":1001", "\"serial\":\"1001\""), "serial is no number"},
      {with("\"serial\":1001", "\"serial\":99999999999999999999999"), "serial is out of range"},
      {with("\"serial\":1001", "\"serial\":1e400"), "is no JSON"},
      {with("\"serial\":1001", "\"serial\":1e-2000000000"), "serial is out of range"},
      {with("\"serial\":1001", "\"serial\":4294967295"), "serial is out of range"},
      {with("\"serial\":1001", "\"serial\":NaN"), "is no JSON"},
      {with("yard-a.1_b", "yard/a"), "owner is no name"},
      {with("yard-a.1_b", ""), "owner is no name"},
      {with("yard-a.1_b", std::string(33, 'a')), "owner is too long"},
      {with("yard-a.1_b", "\\u0000"), "owner is no name"},
      {with("yard-a.1_b", "\xff\xfe"), "is no JSON"},
      {with("yard-a.1_b", "\\ud800"), "is no JSON"},
      {with("\"incarnation\":2147483647", "\"incarnation\":2147483648"),
       "incarnation is out of range"},
      {with("\"sequence\":7", "\"sequence\":-7"), "sequence is out of range"},
      {with("\"sequence\":7", "\"sequence\":null"), "sequence is no number"},
      {with("\"x\":-12", "\"x\":16777217"), "x is out of range"},
      {with("\"x\":-12,", ""), "x is missing"},
      {with("\"y\":16777216", "\"y\":1e300"), "y is out of range"},
      {with("\"y\":16777216", "\"y\":[]"), "y is no number"},
      {with("\"latitude\":51.5,", ""), "latitude is missing"},
      {with("51.5", "1e-3"), "it contradicts itself"},
      {with("51.5", "51." + std::string(32, '5')), "latitude is too long"},
      {with("\"heard\":true", "\"heard\":1"), "heard is neither true nor false"},
      {with("\"status\":9", "\"status\":65536"), "status is out of range"},
      {with("{", R"({"left":"bored",)"), "left is no reason"},
      {with("{", R"({"left":null,)"), "left is no text"},
      {with("\"readings\":[", "\"readings\":[5,"), "readings/0/is no object"},
      {with("\"name\":\"temperature\"", "\"name\":5"), "readings/0/name is no text"},
      {with("-21.500000001", "1e30"), "readings/0/value is out of range"},
      {with("-21.500000001", "-9223372036.854775808"), "readings/0/value is out of range"},
      {with("temperature", "tempera\\nture"), "it contradicts itself"},
      {with("temperature", std::string(33, 't')), "readings/0/name is too long"},
  };
  for (const auto& [payload, reason] : cases) {
    const std::string wrong = wrong_with(payload);
    EXPECT_NE(wrong.find(reason), std::string::npos)
        << "'" << wrong << "' and not '" << reason << "' for " << payload.substr(0, 200);
  }
  std::string many = "\"readings\":[";
  for (int i = 0; i < 17; ++i) many += R"({"name":"a","unit":"","value":1},)";
  EXPECT_EQ(wrong_with(with("\"readings\":[", many)), "readings is too long");
}

// The longest record that a gateway can have is one that others take.
TEST(FleetRecordCodec, TheLongestRecordIsShortEnough) {
  FleetRecord record = full_record();
  record.node.readings.clear();
  for (std::size_t i = 0; i < fleet_readings_max; ++i) {
    record.node.readings.push_back({.name = std::string(fleet_text_max, '"'),
                                    .unit = std::string(fleet_text_max, '\\'),
                                    .nano = -9'223'372'036'854'775'807});
  }
  record.node.longitude = "-179." + std::string(fleet_text_max - 5, '9');
  record.node.latitude = "-89." + std::string(fleet_text_max - 4, '9');
  record.node.heard_at = std::string(fleet_text_max, '"');
  record.owner = std::string(fleet_name_max, 'w');
  record.node.serial = Serial{Serial::none_value - 1};
  record.sequence = fleet_number_max;
  record.left = LeftReason::gateway_gone;
  ASSERT_TRUE(is_sound(record.node));
  EXPECT_LE(encode_record(record).size(), record_bytes_max);
  EXPECT_EQ(wrong_with(encode_record(record), record.node.serial), "");
}

// Cut, bent and mixed up in every way: it is refused or it is sound, and nothing is thrown.
TEST(FleetRecordCodec, NothingThatComesDoesHarm) {
  const std::string sound = encode_record(full_record());
  inputs::Random random(5);
  for (std::size_t size = 0; size < sound.size(); ++size) {
    EXPECT_NE(wrong_with(sound.substr(0, size)), "");
  }
  for (int round = 0; round < 20000; ++round) {
    std::string bent = sound;
    for (std::uint64_t change = 0; change <= random.below(4); ++change) {
      const std::size_t at = random.index(bent.size());
      switch (random.below(4)) {
        case 0:
          bent[at] = static_cast<char>(random.below(256));
          break;
        case 1:
          bent.insert(at, 1, "0123456789eE+-.\"\\{}[],:"[random.index(23)]);
          break;
        case 2:
          bent.erase(at, 1 + random.index(5));
          break;
        default:
          bent.insert(at, bent.substr(random.index(bent.size()), random.index(30)));
      }
      if (bent.empty()) bent = "{";
    }
    std::string wrong;
    const auto record = decode_record(bent, Serial{1001}, wrong);
    EXPECT_EQ(record.has_value(), wrong.empty());
    if (record) {
      EXPECT_TRUE(is_sound(record->node));
      EXPECT_TRUE(is_fleet_name(record->owner));
      EXPECT_EQ(wrong_with(encode_record(*record)), "");
    }
  }
}

TEST(FleetHeaderCodec, EverythingComesBack) {
  FleetHeader header{.run = {.instance = 0xfedcba9876543210, .epoch = 3, .arrival = 2},
                     .beat = 0xffffffff,
                     .version = "1.2 \"beta\"",
                     .is_online = true,
                     .other_instance = 0xffffffffffffffff,
                     .has_conflict = true,
                     .merged_count = 12,
                     .merged_hash = 1,
                     .merged_records = 2,
                     .generation = 5,
                     .mesh_hash = 0x8000000000000000,
                     .mesh_nodes = 11,
                     .is_alone = true,
                     .site = {.number = 4, .hash = 99},
                     .refused_site = {.number = 5, .hash = 98}};
  std::string wrong;
  auto back = decode_header(encode_header(header), wrong);
  ASSERT_TRUE(back) << wrong;
  EXPECT_EQ(back->run, header.run);
  EXPECT_EQ(back->other_instance, header.other_instance);
  EXPECT_TRUE(back->has_conflict);
  EXPECT_EQ(back->beat, header.beat);
  EXPECT_EQ(back->version, header.version);
  EXPECT_EQ(back->merged_count, 12u);
  EXPECT_EQ(back->merged_hash, 1u);
  EXPECT_EQ(back->merged_records, 2u);
  EXPECT_EQ(back->generation, 5u);
  EXPECT_EQ(back->mesh_hash, header.mesh_hash);
  EXPECT_EQ(back->mesh_nodes, header.mesh_nodes);
  EXPECT_TRUE(back->is_alone);
  EXPECT_EQ(back->site, header.site);
  EXPECT_EQ(back->refused_site, header.refused_site);
  header.is_online = false;
  back = decode_header(encode_header(header), wrong);
  ASSERT_TRUE(back) << wrong;
  EXPECT_FALSE(back->is_online);
  EXPECT_EQ(back->version, header.version);
  // Of a program that does not tell.
  header.version.clear();
  back = decode_header(encode_header(header), wrong);
  ASSERT_TRUE(back) << wrong;
  EXPECT_EQ(back->version, "");
}

TEST(FleetHeaderCodec, WhatIsNotSoundIsNamed) {
  std::string wrong;
  EXPECT_FALSE(decode_header(R"({"instance":"12","epoch":1,"beat":1,"online":false})", wrong));
  EXPECT_EQ(wrong, "instance is no hash of 16 digits");
  EXPECT_FALSE(
      decode_header(R"({"instance":"000000000000000g","epoch":1,"beat":1,"online":false})", wrong));
  EXPECT_EQ(wrong, "instance is no hash of 16 digits");
  EXPECT_FALSE(
      decode_header(R"({"instance":"0000000000000001","epoch":1,"beat":1,"online":true})", wrong));
  EXPECT_EQ(wrong, "merged is missing");
  EXPECT_FALSE(decode_header(
      R"({"instance":"0000000000000001","epoch":1,"beat":1,"online":true,"merged":{"count":1}})",
      wrong));
  EXPECT_EQ(wrong, "merged/hash is missing");
  EXPECT_FALSE(decode_header(R"({"instance":"0000000000000001","epoch":1,"beat":1,"online":false,)"
                             R"("version":")" +
                                 std::string(fleet_version_max + 1, '1') + R"("})",
                             wrong));
  EXPECT_EQ(wrong, "version is too long");
  EXPECT_FALSE(decode_header(std::string(header_bytes_max + 1, ' '), wrong));
  EXPECT_EQ(wrong, "is too long");
  EXPECT_FALSE(decode_header(
      R"({"instance":"0000000000000001","epoch":1,"arrival":-1,"beat":1,"online":false})", wrong));
  EXPECT_EQ(wrong.find("arrival "), 0u) << wrong;
  const FleetSetSummary set{
      .run = {.instance = 1, .epoch = 1, .arrival = 2}, .count = 9, .hash = 3};
  EXPECT_EQ(decode_set(encode_set(set), wrong), set);
  EXPECT_FALSE(decode_conflict("{}", wrong));
  EXPECT_FALSE(decode_have(R"({"first":0,"last":9,"nodes":[[1,2]]})", wrong));
  EXPECT_EQ(wrong, "nodes/0 is not sound");
}

SiteDocument full_site() {
  SiteDocument site{.number = 7, .gateway = "north"};
  site.plane = {.crs = "EPSG:25833",
                .unit = 10'000'000,
                .x = 390'000'000'000'000,
                .y = -5'820'000'500'000'000};
  site.anchors = {{-5, 6}, {100, 200}};
  site.features = {{.from = Serial{1001}, .to = FeatureEnd::anchor({100, 200}), .name = "fence"},
                   {.from = FeatureEnd::anchor({-5, 6}), .to = Serial{0}}};
  site.outline = {{.from = to_point(Position{0, 0}), .to = to_point(Position{9, 0})}};
  site.holes = {{.from = to_point(Position{-1, -2}), .to = to_point(Position{3, -4})}};
  return site;
}

TEST(FleetSiteCodec, EverythingComesBack) {
  std::string wrong;
  const auto back = decode_site(encode_site(full_site()), wrong);
  ASSERT_TRUE(back) << wrong;
  EXPECT_EQ(*back, full_site());
  EXPECT_EQ(back->version(), full_site().version());
  SiteDocument about = full_site();
  about.plane = {
      .is_about_place = true, .unit = 1'000'000'000, .x = -13'377'000'001, .y = 52'516'000'000};
  EXPECT_EQ(decode_site(encode_site(about), wrong), about) << wrong;
}

TEST(FleetSiteCodec, TheVersionIsThatOfTheContent) {
  SiteDocument other = full_site();
  other.number = 8;
  other.gateway = "south";
  EXPECT_EQ(other.version().hash, full_site().version().hash);
  EXPECT_GT(other.version(), full_site().version());
  other = full_site();
  other.anchors[0].x = -4;
  EXPECT_NE(other.version().hash, full_site().version().hash);
  std::string wrong;
  std::string text = encode_site(full_site());
  text.replace(text.find("[-5,6]"), 6, "[-5,7]");
  EXPECT_FALSE(decode_site(text, wrong));
  EXPECT_EQ(wrong, "hash is not that of the content");
}

TEST(FleetSiteCodec, WhatIsNotSoundIsNamed) {
  const auto wrong_in = [](const std::string& what, const std::string& other) {
    std::string text = encode_site(full_site());
    text.replace(text.find(what), what.size(), other);
    std::string wrong;
    EXPECT_FALSE(decode_site(text, wrong)) << text;
    return wrong;
  };
  EXPECT_EQ(wrong_in("\"number\":7", "\"number\":0"), "number is 0");
  EXPECT_EQ(wrong_in("[100,200]", "[100]"), "anchors/1 is not sound");
  EXPECT_EQ(wrong_in("[100,200]", "[100,99999999]"), "anchors/1 is not sound");
  EXPECT_EQ(wrong_in("\"from\":1001", "\"from\":-1"), "features/0 is not sound");
  EXPECT_EQ(wrong_in("\"from\":1001", "\"form\":1001"), "features/0 is not sound");
  EXPECT_EQ(wrong_in("\"fence\"", "5"), "features/0 is not sound");
  EXPECT_EQ(wrong_in("\"fence\"", "\"a\\nb\""), "features/0 is not sound");
  EXPECT_EQ(wrong_in("\"north\"", "\"no th\""), "gateway is no name of a gateway");
  EXPECT_EQ(wrong_in("\"number\":7", "\"number\":18446744073709551615"), "number is out of range");
  EXPECT_EQ(wrong_in("\"number\":7", "\"number\":\"7\""), "number is no number");
  EXPECT_EQ(wrong_in("\"unit\":0.01", "\"unit\":0"), "plane/unit is no length");
  EXPECT_EQ(wrong_in("\"unit\":0.01", "\"unit\":1e11"), "plane/unit is out of range");
  EXPECT_EQ(wrong_in("\"x\":390000", "\"longitude\":13"), "plane/latitude is missing");
  EXPECT_EQ(wrong_in("\"x\":390000,\"y\":-5820000.5", "\"longitude\":181,\"latitude\":0"),
            "plane/longitude is nowhere on the earth");
  EXPECT_EQ(wrong_in("\"plane\":{", "\"plan\":{"), "plane is missing");
  EXPECT_EQ(wrong_in("[[0,0],[9,0]]", "[[0,0],[9,0],[1,1]]"), "outline/0 is not sound");
}

TEST(FleetTopics, AreReadAsTheyAreWritten) {
  const std::vector<FleetTopic> topics{
      {.kind = TopicKind::header, .gateway = "a"},
      {.kind = TopicKind::set, .gateway = "a"},
      {.kind = TopicKind::node, .gateway = "a", .serial = Serial{0xabc}},
      {.kind = TopicKind::neighbours, .gateway = "a", .serial = Serial{0}},
      {.kind = TopicKind::alarms, .gateway = "site"},
      {.kind = TopicKind::conflict, .gateway = "a"},
      {.kind = TopicKind::have, .gateway = "a", .other = "b"},
      {.kind = TopicKind::site},
  };
  for (const FleetTopic& topic : topics) {
    const std::string text = topic_text("yard", topic);
    const auto back = parse_topic(text, "yard");
    ASSERT_TRUE(back) << text;
    EXPECT_EQ(back->kind, topic.kind) << text;
    EXPECT_EQ(back->gateway, topic.gateway) << text;
    EXPECT_EQ(back->serial, topic.serial) << text;
    EXPECT_EQ(back->other, topic.other) << text;
    EXPECT_FALSE(parse_topic(text, "yard2")) << text;
    EXPECT_FALSE(parse_topic(text + "/", "yard")) << text;
    EXPECT_FALSE(parse_topic(text + "/x", "yard")) << text;
  }
  EXPECT_EQ(topic_text("yard", topics[2]), "etcm/v1/yard/a/node/00000abc");
}

TEST(FleetTopics, AMemberReadsNoNeighboursAndAlarmsOfOthers) {
  EXPECT_EQ(member_filters("yard", "a"), (std::vector<std::string>{
                                             "etcm/v1/yard/site",
                                             "etcm/v1/yard/+/header",
                                             "etcm/v1/yard/+/set",
                                             "etcm/v1/yard/+/node/+",
                                             "etcm/v1/yard/a/neighbours/+",
                                             "etcm/v1/yard/a/alarms",
                                             "etcm/v1/yard/+/clashes",
                                             "etcm/v1/yard/+/conflict",
                                             "etcm/v1/yard/+/have/+",
                                         }));
}

TEST(FleetTopics, OthersAreNobodys) {
  for (const char* const text : {"",
                                 "etcm",
                                 "etcm/v1/",
                                 "etcm/v1/yard",
                                 "etcm/v1/yard/",
                                 "etcm/v2/yard/a/header",
                                 "etcm/v1/yard//header",
                                 "etcm/v1/yard/a/node",
                                 "etcm/v1/yard/a/node/",
                                 "etcm/v1/yard/a/node/abc",
                                 "etcm/v1/yard/a/node/00000ABC",
                                 "etcm/v1/yard/a/node/000000abc",
                                 "etcm/v1/yard/a/node/ffffffff",
                                 "etcm/v1/yard/a/node/-0000001",
                                 "etcm/v1/yard/a/mood",
                                 "etcm/v1/yard/a b/header",
                                 "etcm/v1/yard/a/have/",
                                 "etcm/v1/yard/a/have/b c",
                                 "etcm/v1/yard/\xc3\xa4/header",
                                 "sport/etcm/v1/yard/a/header"}) {
    EXPECT_FALSE(parse_topic(text, "yard")) << text;
  }
}

TEST(FleetHash, IsTheOneThatOthersCanWorkOut) {
  // FNV-1a as its authors publish it.
  EXPECT_EQ(fnv_hash(""), 0xcbf29ce484222325u);
  EXPECT_EQ(fnv_hash("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(fnv_hash("foobar"), 0x85944171f73967e8u);
  EXPECT_EQ(record_hash(full_record()),
            fnv_hash("1001 yard-a.1_b 2147483647 7 heard -12 16777216"));
}

}  // namespace
}  // namespace etcm::firmware
