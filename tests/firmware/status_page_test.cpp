// What is shown over HTTP, on a simulated clock; read in pieces as odd as a network makes them.
#include "firmware/status/status_page.h"

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "fakes.h"
#include "firmware/alarms/alarm_subject.h"
#include "firmware/status/page_files.h"
#include "page_reader.h"
#include "support/utf8_check.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// Whether brackets and quotation marks of a JSON text match, and no comma stands where none may.
testing::AssertionResult is_sound_json(const std::string& text) {
  std::string open;
  char before = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      for (++i; i < text.size() && text[i] != '"'; ++i) {
        if (static_cast<unsigned char>(text[i]) < 0x20) {
          return testing::AssertionFailure() << "a control character in a text";
        }
        if (text[i] == '\\') ++i;
      }
    } else if (c == '{' || c == '[') {
      if (before == '}' || before == ']') return testing::AssertionFailure() << "no comma at " << i;
      open += c;
    } else if (c == '}' || c == ']') {
      if (before == ',') return testing::AssertionFailure() << "a comma too many at " << i;
      if (open.empty() || open.back() != (c == '}' ? '{' : '[')) {
        return testing::AssertionFailure() << "unmatched at " << i;
      }
      open.pop_back();
    } else if (c == ',' && (before == ',' || before == '{' || before == '[')) {
      return testing::AssertionFailure() << "a comma too many at " << i;
    }
    if (c != ' ' && c != '\n') before = c;
  }
  if (!open.empty()) return testing::AssertionFailure() << "not closed: " << open;
  return testing::AssertionSuccess();
}

class StatusPageTest : public RigTest, protected PageReader {
 protected:
  StatusPageTest()
      : RigTest({{.from = Serial{1001}, .to = Serial{1003}, .source = "site.toml:1"}}),
        PageReader(rig_) {}
  // The gateway must not be started before.
  void open_page() {
    rig_.start();
    make_page();
  }
  void run(port::Duration duration) {
    for (port::Duration passed{}; passed < duration; passed += 100ms) {
      rig_.run(100ms);
      page_->advance(rig_.clock.now());
    }
  }
  void put_square() {
    rig_.put_square();
    rig_.put(5, 50, 40);
  }
};

TEST_F(StatusPageTest, TheMeshIsTheSameHoweverItIsRead) {
  open_page();
  put_square();
  run(1s);
  const std::string mesh = get("/mesh.geojson");
  EXPECT_STREQ(answer_.media_type, "application/geo+json");
  EXPECT_TRUE(is_sound_json(mesh)) << mesh;
  EXPECT_EQ(count(mesh, "\"kind\":\"node\""), 5u);
  EXPECT_EQ(count(mesh, "\"kind\":\"steiner\""), rig_.gateway->snapshot().steiner_count);
  EXPECT_NE(mesh.find("\"coordinates\":[50,40]},\"properties\":{\"kind\":\"node\",\"serial\":1005,"
                      "\"bus\":\"yard\",\"unit\":5,\"in_mesh\":true,\"stale\":false"),
            std::string::npos)
      << mesh;
  for (const std::size_t piece : {1u, 100u, 4096u}) EXPECT_EQ(get("/mesh.geojson", piece), mesh);
}

TEST_F(StatusPageTest, AnEmptyMeshIsAMeshToo) {
  open_page();
  EXPECT_TRUE(is_sound_json(get("/mesh.geojson")));
  EXPECT_TRUE(is_sound_json(get("/status.json")));
  EXPECT_EQ(get("/ages.json"), "[]\n");
  EXPECT_EQ(get("/healthz"), "ok\n");
}

TEST_F(StatusPageTest, TheVersionOfTheMeshIsAnotherWithEachGeneration) {
  open_page();
  put_square();
  run(1s);
  get("/mesh.geojson");
  const std::uint64_t before = answer_.version;
  run(1s);
  get("/mesh.geojson");
  EXPECT_EQ(answer_.version, before) << "nothing has changed";
  rig_.put(6, 20, 80);
  run(1s);
  get("/mesh.geojson");
  EXPECT_NE(answer_.version, before);
}

TEST_F(StatusPageTest, ASlowReaderHasOneGenerationToTheEnd) {
  open_page();
  put_square();
  run(1s);
  const std::string mesh = get("/mesh.geojson");
  std::array<char, 20> out;
  page_->begin(1, "/mesh.geojson");
  std::string slow(out.data(), page_->read(1, out));
  for (std::uint8_t unit = 6; unit <= 12; ++unit) {
    rig_.put(unit, 7 * unit, 5 * unit);
    run(500ms);
    // Others have the newest meanwhile.
    EXPECT_EQ(count(get("/mesh.geojson"), "\"kind\":\"node\""), unit);
  }
  EXPECT_EQ(slow + rest(1), mesh);
}

TEST_F(StatusPageTest, WhenSlowReadersHoldAllPlacesOthersHaveTheNewerOfTheirs) {
  open_page();
  put_square();
  run(1s);
  page_->begin(1, "/mesh.geojson");
  rig_.put(6, 20, 80);
  run(500ms);
  page_->begin(2, "/mesh.geojson");
  rig_.put(7, 80, 20);
  run(500ms);
  EXPECT_EQ(count(get("/mesh.geojson"), "\"kind\":\"node\""), 6u);
  EXPECT_EQ(count(rest(1), "\"kind\":\"node\""), 5u);
  EXPECT_EQ(count(get("/mesh.geojson"), "\"kind\":\"node\""), 7u);
  EXPECT_EQ(count(rest(2), "\"kind\":\"node\""), 6u);
}

TEST_F(StatusPageTest, WhoIsRefusedIsShownWithTheReason) {
  open_page();
  put_square();
  rig_.put(6, 50, 40);
  run(1s);
  const std::string mesh = get("/mesh.geojson");
  EXPECT_TRUE(is_sound_json(mesh));
  EXPECT_EQ(count(mesh, "\"in_mesh\":false,\"refused\":\"Another node stands exactly there"), 1u)
      << mesh;
  const std::string status = get("/status.json");
  EXPECT_TRUE(is_sound_json(status)) << status;
  EXPECT_EQ(count(status, "\"why\":\"Another node stands exactly there"), 1u) << status;
}

TEST_F(StatusPageTest, FeaturesThatAReloadTakesOutWhileTheyAreReadAreSoundJson) {
  const std::vector<FeatureSettings> features{feature(1001, 1003), feature(1001, 1707)};
  rig_.settings.features = features;
  open_page();
  rig_.put_square();
  run(1s);
  const std::size_t whole = get("/features.json", 1).size();
  for (std::size_t read = 0; read < whole; ++read) {
    rig_.settings.features = features;
    rig_.update_settings();
    ASSERT_EQ(page_->begin(0, "/features.json").status, 200);
    std::string text;
    char byte = 0;
    while (text.size() < read && page_->read(0, {&byte, 1}) == 1) text += byte;
    rig_.settings.features.clear();
    rig_.update_settings();
    text += rest(0);
    ASSERT_TRUE(is_sound_json(text)) << text;
  }
}

// Diagonals of the square of which one is named and drawn in a site file, as a third one of which
// an end is not there.
TEST_F(StatusPageTest, AFeatureThatIsNotInTheMeshSaysWhyAndWhatToDo) {
  rig_.settings.features = {
      {.from = Serial{1001}, .to = Serial{1003}, .name = "main pipe", .source = "site.geojson:3"},
      {.from = Serial{1002}, .to = Serial{1004}, .name = {}, .source = "site.geojson:9"},
      {.from = Serial{1001}, .to = Serial{1707}, .name = "fence", .source = "gateway.toml:4"}};
  open_page();
  rig_.put_square();
  run(1s);
  const std::string told = get("/features.json");
  EXPECT_TRUE(is_sound_json(told)) << told;
  EXPECT_NE(told.find("{\"feature\":1,\"name\":\"main pipe\",\"source\":\"site.geojson:3\","
                      "\"from\":1001,\"to\":1003,\"in_mesh\":true}"),
            std::string::npos)
      << told;
  EXPECT_NE(
      told.find("\"in_mesh\":false,\"refused\":true,\"why\":\"it crosses feature 1 'main pipe' "
                "(site.geojson:3) at (50, 50)\",\"cure\":\"in the site file give both lines a "
                "vertex there, at the same coordinates, or let one end there, or take one "
                "out; how: /guide/site.html#where-lines-meet\",\"blocker\":1,\"near\":[50,50]"),
      std::string::npos)
      << told;
  EXPECT_NE(
      told.find("\"refused\":false,\"why\":\"node 1707, where it ends, has not been heard since "
                "the start\",\"cure\":\"correct the serial in gateway.toml:4, or look for the "
                "node\"}"),
      std::string::npos)
      << told;
}

TEST_F(StatusPageTest, WhoHasSaidThatItLeavesIsTold) {
  rig_.settings.features = {feature(1001, 1002)};
  open_page();
  rig_.put_square();
  run(1s);
  EXPECT_NE(get("/status.json").find("\"left\":[]"), std::string::npos);
  rig_.put(1, 0, 0, node_status::fix_valid | node_status::leaving);
  run(5s);
  const std::string status = get("/status.json");
  EXPECT_TRUE(is_sound_json(status)) << status;
  std::smatch found;
  ASSERT_TRUE(std::regex_search(status, found,
                                std::regex(R"re("left":\[\{"serial":1001,"since_ms":(\d+)\}\])re")))
      << status;
  EXPECT_NEAR(std::stod(found[1]), 5000, 600);
  EXPECT_NE(get("/mesh.json").find("\"in_mesh\":false,\"left\":true"), std::string::npos);
  EXPECT_NE(get("/nodes.csv").find("1001,,left,0,0"), std::string::npos) << get("/nodes.csv");
  EXPECT_NE(get("/features.json")
                .find("node 1001, where it ends, has said that it leaves\",\"cure\":\"let it join "
                      "again, or take the feature out of site.toml:1\""),
            std::string::npos)
      << get("/features.json");
  rig_.put(1, 0, 0);
  run(1s);
  EXPECT_NE(get("/status.json").find("\"left\":[]"), std::string::npos);
}

// Drawn in a site file, in two parts, with the [[feature]] left where it was.
TEST_F(StatusPageTest, AFeatureThatIsDrawnTooIsTakenOut) {
  rig_.settings.features = {
      {.from = Serial{1001}, .to = Serial{1003}, .name = {}, .source = "gateway.toml:4"},
      {.from = Serial{1001},
       .to = FeatureEnd::anchor({50, 50}),
       .name = {},
       .source = "site.geojson:3"},
      {.from = FeatureEnd::anchor({50, 50}),
       .to = Serial{1003},
       .name = {},
       .source = "site.geojson:3"},
      {.from = FeatureEnd::anchor({20, 30}),
       .to = FeatureEnd::anchor({30, 20}),
       .name = {},
       .source = "site.geojson:9"}};
  for (const Position place : {Position{50, 50}, Position{20, 30}, Position{30, 20}}) {
    rig_.settings.anchors.push_back({.position = place, .source = "site.geojson:1"});
  }
  open_page();
  rig_.put_square();
  run(1s);
  const std::string told = get("/features.json");
  EXPECT_TRUE(is_sound_json(told)) << told;
  EXPECT_EQ(count(told,
                  "\"why\":\"it runs along a part of feature 1 (1001-1003, gateway.toml:4)\","
                  "\"cure\":\"take the [[feature]] of gateway.toml:4 out, the site file has "
                  "its line already; how: /guide/site.html#where-lines-meet\""),
            2u)
      << told;
  EXPECT_EQ(count(told,
                  "\"cure\":\"take the [[feature]] of gateway.toml:4 out where the site file "
                  "has its line already; else draw it there, give both lines a vertex at that "
                  "place, and take the [[feature]] out; how: "),
            1u)
      << told;
}

TEST_F(StatusPageTest, WhatWaitsForARestartIsTold) {
  const std::vector<std::string> keys = {"[mesh] vertices_max", "[http] listen"};
  open_page();
  EXPECT_EQ(get("/status.json").find("needs_restart"), std::string::npos);
  sources_->needs_restart = &keys;
  sources_->config = "/etc/etcm/gateway.toml";
  page_.emplace(*sources_, 4);
  const std::string status = get("/status.json");
  EXPECT_TRUE(is_sound_json(status)) << status;
  EXPECT_NE(status.find("\"needs_restart\":[\"[mesh] vertices_max\",\"[http] listen\"],\"config\":"
                        "\"/etc/etcm/gateway.toml\""),
            std::string::npos)
      << status;
  EXPECT_NE(status.find("\"time_ms\":1800000"), std::string::npos) << status;
}

TEST_F(StatusPageTest, NamesAndEventsMayHoldAnything) {
  rig_.settings.buses.front().name =
      "a \"b\" \\ \n\t\x01 <script> \xc3\xa9" + std::string(2000, '"');
  open_page();
  put_square();
  events_.write(port::Level::error, "quote \" and \\ and \x02 and " + std::string(5000, '\x01'));
  events_.write(port::Level::error, std::string(5000, '\x01'));
  run(12s);
  EXPECT_TRUE(is_sound_json(get("/mesh.geojson")));
  EXPECT_TRUE(is_sound_json(get("/status.json")));
  const std::string metrics = get("/metrics");
  EXPECT_EQ(metrics.find("<script> \n"), std::string::npos);
  EXPECT_NE(metrics.find("bus=\"a \\\"b\\\" \\\\ \\n"), std::string::npos) << metrics;
}

TEST_F(StatusPageTest, AnEventThatIsVeryLongIsCutBehindAWord) {
  open_page();
  std::string line = "it crosses feature 1 'main pipe'";
  while (line.size() < 380) line += " and";
  events_.write(port::Level::warning, line + "; how: /guide/site.html#where-lines-meet");
  events_.write(port::Level::warning, line);
  const std::string status = get("/status.json");
  EXPECT_EQ(count(status, line + "; how:\u2026\""), 1u) << status;
  EXPECT_EQ(count(status, line + "\""), 1u);
}

TEST_F(StatusPageTest, TheNewestEventsAreKeptAndTheNewestIsFirst) {
  open_page();
  for (int i = 1; i <= 250; ++i) events_.write(port::Level::info, "event " + std::to_string(i));
  const std::string status = get("/status.json");
  EXPECT_EQ(count(status, "\"number\":"), recent_events_max);
  EXPECT_NE(status.find("\"events\":[\n{\"number\":250,"), std::string::npos) << status;
  EXPECT_EQ(count(status, "\"event 151\""), 1u);
  EXPECT_EQ(count(status, "\"event 150\""), 0u);
  EXPECT_EQ(rig_.log.count("event"), 250u) << "all are handed on";
}

TEST_F(StatusPageTest, EventsThatComeWhileTheyAreReadDoNoHarm) {
  open_page();
  for (int i = 0; i < 150; ++i) events_.write(port::Level::info, "old");
  page_->begin(1, "/status.json");
  std::string status;
  std::array<char, 50> out;
  while (const std::size_t size = page_->read(1, out)) {
    status.append(out.data(), size);
    events_.write(port::Level::info, "new");
  }
  page_->end(1);
  EXPECT_TRUE(is_sound_json(status)) << status;
}

TEST_F(StatusPageTest, AgesAreThoseOfTheLastAnswer) {
  open_page();
  put_square();
  run(500ms);
  rig_.bus.silence(5);
  run(700ms);
  std::smatch found;
  const std::string ages = get("/ages.json");
  ASSERT_TRUE(std::regex_search(ages, found, std::regex(R"(\[1005,(\d+)\])"))) << ages;
  EXPECT_GT(std::stoi(found[1]), 500);
  ASSERT_TRUE(std::regex_search(ages, found, std::regex(R"(\[1001,(\d+)\])"))) << ages;
  EXPECT_LT(std::stoi(found[1]), 300);
}

TEST_F(StatusPageTest, AgesCountFromTheLastPositionWithAFix) {
  open_page();
  put_square();
  rig_.put(6, 3, 3, 0);  // it has never had one
  run(1s);
  rig_.put(5, 50, 40, 0);
  run(10s);
  std::smatch found;
  const std::string ages = get("/ages.json");
  ASSERT_TRUE(std::regex_search(ages, found, std::regex(R"(\[1005,(\d+)\])"))) << ages;
  EXPECT_GT(std::stoi(found[1]), 9900);
  EXPECT_EQ(ages.find("[1006,"), std::string::npos);
  const std::string mesh = get("/mesh.geojson");
  EXPECT_EQ(count(mesh, "\"stale\":true,\"no_fix\":true"), 1u) << mesh;
  EXPECT_EQ(count(mesh, "\"far\":"), 0u) << mesh;
  const std::string metrics = get("/metrics");
  EXPECT_EQ(count(metrics, "\netcm_stale_nodes 1\n"), 1u);
  EXPECT_EQ(count(metrics, "\netcm_waiting_nodes 1\n"), 1u);
  EXPECT_EQ(count(metrics, "\netcm_node_age_seconds{serial=\"1006\"}"), 0u);
  ASSERT_TRUE(std::regex_search(
      metrics, found, std::regex(R"re(etcm_node_age_seconds\{serial="1005"\} ([0-9.]+))re")));
  EXPECT_GT(std::stod(found[1]), 9.9);
  ASSERT_TRUE(std::regex_search(
      metrics, found, std::regex(R"re(etcm_node_silence_seconds\{serial="1005"\} ([0-9.]+))re")));
  EXPECT_LT(std::stod(found[1]), 0.3);
  EXPECT_EQ(count(get("/status.json"), "\"waiting_nodes\":1"), 1u);
}

TEST_F(StatusPageTest, WhoIsMissingIsSaidEverywhere) {
  open_page();
  put_square();
  run(1s);
  EXPECT_EQ(count(get("/status.json"), "\"missing\":[],"), 1u);
  rig_.bus.silence(5);
  run(9900ms);
  const std::string status = get("/status.json");
  EXPECT_TRUE(is_sound_json(status)) << status;
  EXPECT_EQ(count(status, "\"missing_nodes\":1"), 1u) << status;
  EXPECT_EQ(count(status, "\"missing\":true,\"bus_silent\":false"), 1u);
  EXPECT_TRUE(std::regex_search(
      status,
      std::regex(R"re("missing":\[\{"serial":1005,"since_ms":99\d\d,"bus":"yard","unit":5\}\])re")))
      << status;
  EXPECT_EQ(count(status, "\"troubles\":[\"1 node is missing: node 1005, unit 5 of yard; look"),
            1u);
  const std::string mesh = get("/mesh.geojson");
  EXPECT_TRUE(is_sound_json(mesh)) << mesh;
  EXPECT_EQ(count(mesh,
                  "\"coordinates\":[50,40]},\"properties\":{\"kind\":\"node\",\"serial\":1005,"
                  "\"bus\":\"yard\",\"unit\":5,\"in_mesh\":false,\"missing\":true}"),
            1u)
      << mesh;
  const std::string metrics = get("/metrics");
  EXPECT_EQ(count(metrics, "\netcm_missing_nodes 1\n"), 1u);
  EXPECT_EQ(count(metrics, "\netcm_node_missing_seconds{serial=\"1005\"} 9.9"), 1u);
  EXPECT_EQ(count(metrics, "\netcm_state{flag=\"missing\"} 1\n"), 1u);
  EXPECT_EQ(get("/healthz"),
            "1 node is missing: node 1005, unit 5 of yard; look at its supply, its cable and its "
            "address; if it is gone for good: sudo etcm-gateway ctl dismiss 1005\n");
  EXPECT_EQ(answer_.status, port::web_status::unavailable);
  rig_.bus.silence(4);
  run(9900ms);
  EXPECT_EQ(get("/healthz").find("2 nodes are missing: node 1005, unit 5 of yard, and 1 more; "),
            0u);
  put_square();
  run(1s);
  EXPECT_EQ(get("/healthz"), "ok\n");
  EXPECT_EQ(count(get("/metrics"), "\netcm_missing_nodes 0\n"), 1u);
}

TEST_F(StatusPageTest, ABusThatIsSilentIsSaidSinceWhen) {
  open_page();
  put_square();
  run(1s);
  EXPECT_EQ(count(get("/status.json"), "silent_ms"), 0u);
  rig_.bus.link_up = false;
  run(100ms);
  EXPECT_EQ(get("/healthz"), "ok\n") << "it may come back at once";
  run(1800ms);
  const std::string status = get("/status.json");
  EXPECT_TRUE(is_sound_json(status)) << status;
  EXPECT_TRUE(std::regex_search(status, std::regex(R"("silent_ms":19\d\d,"no_link":"")")))
      << status;
  EXPECT_EQ(count(status, "\"bus_silent\":true"), 1u);
  const std::string metrics = get("/metrics");
  EXPECT_EQ(count(metrics, "\netcm_bus_silent{bus=\"yard\"} 1\n"), 1u);
  EXPECT_EQ(count(metrics, "\netcm_state{flag=\"bus_silent\"} 1\n"), 1u);
}

TEST_F(StatusPageTest, ABusThatNeverAnsweredIsNamedWithItsCause) {
  rig_.bus.link_up = false;
  rig_.bus.why_no_link = "mill:502: Name or service not known; correct the name";
  open_page();
  run(2900ms);
  EXPECT_EQ(get("/healthz"), "ok\n");
  run(1s);
  EXPECT_EQ(get("/healthz"),
            "bus yard: no unit has answered for 3 s; mill:502: Name or service not known; correct "
            "the name\n");
  const std::string status = get("/status.json");
  EXPECT_EQ(count(status, "\"bus_silent\":true"), 1u) << status;
  EXPECT_EQ(count(status, "\"silent_ms\":3"), 1u) << status;
}

TEST_F(StatusPageTest, AUnitThatIsNamedAndNeverAnsweredIsSaidEverywhere) {
  rig_.settings.nodes = {{.bus = "yard", .address = 12, .position = Position{70, 80}}};
  rig_.settings.node_names = {{.bus = "yard", .address = 12, .name = "depot"},
                              {.bus = "yard", .address = 13, .name = "gate"}};
  open_page();
  put_square();
  run(3s);
  EXPECT_EQ(get("/healthz"), "ok\n");
  run(2s);
  EXPECT_EQ(get("/healthz"),
            "unit 12 of yard has not answered since the start, and 1 more; look at its supply, its "
            "cable, its address and its profile; if it is not to be there, take it out of the "
            "settings\n");
  EXPECT_EQ(rig_.server.header("absent_count"), 2u);
  EXPECT_EQ(count(get("/status.json"), "\"absent_units\":2,"), 1u);
  EXPECT_EQ(count(get("/metrics"), "\netcm_absent_units 2\n"), 1u);
  const std::string mesh = get("/mesh.geojson");
  EXPECT_TRUE(is_sound_json(mesh));
  EXPECT_EQ(count(mesh,
                  "\"coordinates\":[70,80]},\"properties\":{\"kind\":\"node\",\"serial\":1012,"
                  "\"name\":\"depot\",\"bus\":\"yard\",\"unit\":12,\"in_mesh\":false,"
                  "\"missing\":true,\"never_heard\":true}"),
            1u)
      << mesh;
}

TEST_F(StatusPageTest, APauseOfTheGatewayIsNoIllness) {
  open_page();
  put_square();
  run(1s);
  rig_.clock.pass(1h);
  run(100ms);
  EXPECT_EQ(get("/healthz"), "ok\n");
}

TEST_F(StatusPageTest, MetricsAreWhatPrometheusReads) {
  open_page();
  put_square();
  run(12s);
  masters_.rejected = 3;
  const std::string metrics = get("/metrics");
  EXPECT_STREQ(answer_.media_type, metrics_media_type);
  const std::regex sample(
      R"re(([a-z_]+)(\{([a-z]+="[^"\n]*",?)+\})? [0-9]+(\.[0-9]+)?(e[+-][0-9]+)?)re");
  std::set<std::string> seen;
  std::string family;
  std::istringstream lines(metrics);
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (std::regex_match(line, found, std::regex("# HELP ([a-z_]+) .+"))) {
      family = found[1];
      EXPECT_TRUE(seen.insert(family).second) << family << " comes twice";
    } else if (line.starts_with("# ")) {
      EXPECT_TRUE(line == "# TYPE " + family + " counter" ||
                  line == "# TYPE " + family + " gauge" || line == "# TYPE " + family + " summary")
          << line;
    } else {
      EXPECT_TRUE(std::regex_match(line, found, sample)) << line;
      EXPECT_TRUE(std::string(found[1]).starts_with(family)) << line;
    }
  }
  const auto& unit = rig_.gateway->poller().counters(UnitIndex{0});
  EXPECT_NE(metrics.find("\netcm_unit_requests_total{bus=\"yard\",unit=\"1\"} " +
                         std::to_string(unit.requests) + "\n"),
            std::string::npos);
  EXPECT_NE(metrics.find("\netcm_nodes 5\n"), std::string::npos);
  EXPECT_NE(metrics.find("\netcm_refused_total{server=\"modbus\"} 3\n"), std::string::npos);
  EXPECT_EQ(count(metrics, "\netcm_unit_errors_total{"), 20u * 7);
  EXPECT_EQ(count(metrics, "\netcm_bus_efficiency_ratio{"), 0u) << "a network has no floor";
}

// With scan = "1-247" on many buses, units that are not there would be most of the text.
TEST_F(StatusPageTest, MetricsLeaveOutUnitsThatAreOnlyLookedFor) {
  rig_.settings.buses[0].units = {{1, 5}};
  rig_.settings.buses[0].scan = {{6, 247}};
  rig_.settings.poll.interval = 20ms;
  open_page();
  put_square();
  rig_.put(9, 70, 30);
  rig_.bus.set_result(11, port::BusResult::exception, 2);
  run(10s);
  const std::string metrics = get("/metrics");
  EXPECT_EQ(count(metrics, "\netcm_unit_requests_total{"), 7u);
  EXPECT_NE(metrics.find("\netcm_unit_requests_total{bus=\"yard\",unit=\"9\"}"), std::string::npos);
  EXPECT_NE(metrics.find("\netcm_unit_requests_total{bus=\"yard\",unit=\"11\"}"),
            std::string::npos);
  // One that has answered stays, or its figures would have gaps.
  rig_.bus.silence(9);
  run(20s);
  EXPECT_EQ(count(get("/metrics"), "\netcm_unit_requests_total{"), 7u);
}

TEST_F(StatusPageTest, UnitsAreShownWithWhatTheySaidLast) {
  rig_.settings.buses[0].units = {{1, 5}};
  rig_.settings.buses[0].scan = {{6, 20}};
  open_page();
  put_square();
  rig_.put(2, 100, 0, node_status::fix_valid | node_status::moving | node_status::low_battery);
  rig_.put(9, 70, 30, 0);
  rig_.bus.silence(5);
  run(10s);
  const std::string units = get("/units.json");
  EXPECT_STREQ(answer_.media_type, "application/json");
  EXPECT_TRUE(is_sound_json(units)) << units;
  EXPECT_EQ(count(units, "{\"bus\":"), 6u) << units;
  EXPECT_EQ(count(units, "\"unit\":1,\"state\":\"answering\",\"since_ms\":99"), 1u) << units;
  EXPECT_EQ(count(units, "\"serial\":1002,\"said_ms\":90,\"moving\":true,\"low_battery\":true}"),
            1u)
      << units;
  EXPECT_EQ(count(units, "\"serial\":1009,\"said_ms\":90,\"no_fix\":true}"), 1u) << units;
  EXPECT_EQ(count(units, "\"answer_ms\":10,\"answer_mean_ms\":10,\"answer_longest_ms\":10"), 5u);
  EXPECT_TRUE(std::regex_search(
      units, std::regex(R"re("unit":5,"state":"silent","requests":\d+,"recent":\d+,)re"
                        R"re("recent_errors":\d+,"last_error":"timeout")re")))
      << units;
  for (const std::size_t piece : {1u, 100u, 4096u}) EXPECT_EQ(get("/units.json", piece), units);
}

TEST_F(StatusPageTest, APlanIsServedToTheEndThoughAReloadTakesItAway) {
  auto plan = std::make_shared<SitePlan>();
  plan->media_type = "image/png";
  plan->bytes = "what a file has";
  plan->version = 77;
  plan->width = 20;
  plan->height = 10;
  plan->world = {5, 0, 0, -5, 2.5, 47.5};
  rig_.settings.site.plan = plan;
  open_page();
  EXPECT_EQ(get("/plan", 5), plan->bytes);
  EXPECT_STREQ(answer_.media_type, "image/png");
  EXPECT_EQ(answer_.version, 77u);
  const std::string status = get("/status.json");
  EXPECT_TRUE(is_sound_json(status)) << status;
  EXPECT_EQ(count(status,
                  "\"plan\":{\"version\":\"000000000000004d\",\"width\":20,\"height\":10,"
                  "\"corners\":[[0,50],[100,50],[0,0]]}"),
            1u)
      << status;
  page_->begin(1, "/plan");
  rig_.settings.site.plan = nullptr;
  rig_.update_settings();
  EXPECT_EQ(rest(1), plan->bytes);
  get("/plan");
  EXPECT_EQ(answer_.status, port::web_status::not_found);
  EXPECT_EQ(count(get("/status.json"), "\"plan\""), 0u);
}

// By RFC 4180: lines end with CR LF, all have as many fields, and texts are in quotation marks.
std::vector<std::vector<std::string>> read_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows(1, {""});
  bool is_quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string& field = rows.back().back();
    if (text[i] == '"') {
      if (is_quoted && text.compare(i, 2, "\"\"") == 0) {
        field += text[i++];
      } else {
        is_quoted = !is_quoted;
      }
    } else if (!is_quoted && text[i] == ',') {
      rows.back().emplace_back();
    } else if (!is_quoted && text.compare(i, 2, "\r\n") == 0) {
      rows.push_back({""});
      ++i;
    } else {
      field += text[i];
    }
  }
  EXPECT_FALSE(is_quoted);
  EXPECT_EQ(rows.back(), std::vector<std::string>{""}) << "the last line ends too";
  rows.pop_back();
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows.front().size()) << row.front();
  return rows;
}

class FixedWallClock final : public port::WallClock {
 public:
  std::int64_t milliseconds() const override { return 1'790'000'000'999; }
};

TEST_F(StatusPageTest, TablesForSpreadsheetsHaveALineForEach) {
  rig_.settings.buses[0].name = "the \"old\" yard, east";
  rig_.settings.buses[0].units = {{1, 6}};
  open_page();
  put_square();
  run(1s);
  rig_.put(6, 50, 40, node_status::fix_valid | node_status::low_battery);
  run(2s);
  rig_.bus.silence(2);
  run(1s);
  auto rows = read_csv(get("/nodes.csv"));
  EXPECT_STREQ(answer_.media_type, csv_media_type);
  ASSERT_EQ(rows.size(), 7u);
  EXPECT_EQ(rows[1], (std::vector<std::string>{"1001", "", "fresh", "0", "0", "", "", rows[1][7],
                                               "the \"old\" yard, east", "1", "", "no", "no", ""}));
  EXPECT_EQ(rows[6][2], "quarantined");
  EXPECT_EQ(rows[6][12], "yes");
  EXPECT_EQ(rows[6][13].find("Another node stands exactly there"), 0u);
  rows = read_csv(get("/units.csv", 1));
  ASSERT_EQ(rows.size(), 7u);
  EXPECT_EQ(rows[1][2], "answering");
  EXPECT_EQ(rows[2][2], "silent");
  EXPECT_EQ(rows[2][10], "timeout");
}

TEST_F(StatusPageTest, TheTableOfEventsHasTheirTimes) {
  rig_.start();
  const FixedWallClock wall_clock;
  const StatusSources sources{.gateway = *rig_.gateway,
                              .events = events_,
                              .alarms = alarms_,
                              .wall_clock = wall_clock,
                              .masters = masters_,
                              .readers = readers_,
                              .version = "1.2.3",
                              .started_at = rig_.clock.now()};
  page_.emplace(sources, 4);
  events_.write(port::Level::warning, "he said \"no\",\r\nand went");
  rig_.clock.pass(60s);
  page_->advance(rig_.clock.now());
  const auto rows = read_csv(get("/events.csv", 3));
  ASSERT_EQ(rows.size(), 1 + events_.count());
  EXPECT_EQ(rows[1],
            (std::vector<std::string>{std::to_string(events_.written()), "2026-09-21T14:12:20Z",
                                      "60", "warning", "he said \"no\",  and went"}));
}

TEST_F(StatusPageTest, AnAlarmSaysWhatItIsAbout) {
  rig_.settings.buses[0].name = "the yard";
  open_page();
  put_square();
  run(1s);
  const FeatureSettings& fence = rig_.gateway->features()[0].settings;
  const std::pair<AlarmKey, const char*> known[] = {
      {{AlarmKind::missing_node, 7}, "{\"node\":7}"},
      {{AlarmKind::identity_conflict, std::uint64_t{8} << 32 | 3}, "{\"node\":8}"},
      {{AlarmKind::refused_feature, subject_of(fence)}, "{\"feature\":1,\"node\":1001}"},
      {{AlarmKind::silent_bus, subject_of("the yard")}, "{\"bus\":\"the yard\"}"},
      {{AlarmKind::never_answered, subject_of("the yard", 2)}, "{\"bus\":\"the yard\",\"unit\":2}"},
  };
  const AlarmKey unknown[] = {{AlarmKind::refused_feature, 1},    {AlarmKind::silent_bus, 1},
                              {AlarmKind::never_answered, 1},     {AlarmKind::gone_gateway, 1},
                              {AlarmKind::disagreeing_sensor, 1}, {AlarmKind::no_broker, 0}};
  alarms_.begin_look(rig_.clock.now());
  for (const auto& [key, about] : known) alarms_.hold(key, {}, "it is wrong", "");
  for (const AlarmKey& key : unknown) alarms_.hold(key, {}, "it is wrong", "");
  alarms_.end_look([](const Alarm&) { return true; });
  const std::string shown = get("/alarms.json");
  for (const auto& [key, about] : known) {
    EXPECT_EQ(count(shown, "\"about\":" + std::string(about) + "}"), 1u) << about << shown;
  }
  EXPECT_EQ(count(shown, "\"about\""), std::size(known));
}

TEST_F(StatusPageTest, TheNewestOfTheAlarmsThatHaveEndedAreShownAlone) {
  open_page();
  const auto look = [&](std::uint32_t first, std::uint32_t last) {
    alarms_.begin_look(rig_.clock.now());
    for (std::uint32_t node = first; node <= last; ++node) {
      alarms_.hold({AlarmKind::missing_node, node}, {}, "node " + std::to_string(node) + ".", "");
    }
    alarms_.end_look([](const Alarm&) { return true; },
                     [](const Alarm&) { return AlarmEnd::by_itself; });
    rig_.clock.pass(1s);
  };
  for (std::uint32_t node = 1; node <= ended_of_late_max + 5; ++node) look(node, node);
  look(1, 0);
  rig_.clock.pass(recurrence_pause);
  look(1001, 1003);
  look(1002, 1003);
  page_->advance(rig_.clock.now());
  const std::string shown = get("/ended.json");
  EXPECT_EQ(count(shown, "\"text\""), 1 + ended_of_late_max);
  EXPECT_LT(shown.find("node 1001."), shown.find("node 105."));
  EXPECT_LT(shown.find("node 105."), shown.find("node 6."));
  EXPECT_EQ(count(shown, "node 5."), 0u);
  EXPECT_EQ(count(shown, "node 1002."), 0u) << "it is on";
  EXPECT_EQ(count(shown, "}\n,") + count(shown, "},"), ended_of_late_max - 1) << shown;
  EXPECT_EQ(count(get("/status.json"), "\"ended\":106,"), 1u);
  EXPECT_EQ(count(get("/history.json"), "\"text\""), 3 + ended_of_late_max + 5);
  EXPECT_EQ(count(get("/alarms.json"), "\"text\""), 3u);
}

TEST_F(StatusPageTest, AUnitThatAnswersInVainIsNotSilent) {
  open_page();
  put_square();
  run(1s);
  rig_.bus.set_result(3, port::BusResult::exception, 4);
  run(1s);
  const std::string units = get("/units.json");
  EXPECT_TRUE(std::regex_search(
      units, std::regex(R"re("unit":3,"state":"faulty","since_ms":1\d\d\d,.*"last_error":)re"
                        R"re("exception","exception":4,)re")))
      << units;
  EXPECT_EQ(count(get("/status.json"), "\"answering\":4,"), 1u);
}

TEST_F(StatusPageTest, NoUnitOfASilentBusAnswers) {
  rig_.settings.buses[0].units = {{1, 5}};
  rig_.settings.poll.timeout = 2s;
  open_page();
  put_square();
  run(1s);
  for (std::uint8_t unit = 1; unit <= 5; ++unit) rig_.bus.silence(unit);
  while (!rig_.gateway->presence().is_silent(BusIndex{0})) run(100ms);
  EXPECT_EQ(count(get("/status.json"), "\"answering\":0,"), 1u);
  EXPECT_EQ(count(get("/units.json"), "\"state\":\"silent\""), 5u);
}

TEST_F(StatusPageTest, AUnitIsStillThatOfTheNodeThatIsMissing) {
  open_page();
  put_square();
  run(1s);
  rig_.bus.silence(5);
  run(9900ms);
  const std::string units = get("/units.json");
  EXPECT_TRUE(
      std::regex_search(units, std::regex(R"re("unit":5,"state":"silent".*"serial":1005)re")))
      << units;
}

TEST_F(StatusPageTest, NoUnitOfABusWithoutALinkAnswers) {
  rig_.settings.buses[0].units = {{1, 5}};
  open_page();
  put_square();
  run(1s);
  EXPECT_EQ(count(get("/status.json"), "\"units\":5,\"answering\":5,"), 1u);
  rig_.bus.link_up = false;
  rig_.bus.why_no_link = "/dev/ttyUSB0 is gone; plug it in";
  run(100ms);
  const std::string status = get("/status.json");
  EXPECT_TRUE(is_sound_json(status)) << status;
  EXPECT_EQ(count(status, "\"units\":5,\"answering\":0,"), 1u) << status;
  EXPECT_EQ(count(status, "\"no_link\":\"/dev/ttyUSB0 is gone; plug it in\""), 1u) << status;
  EXPECT_EQ(count(get("/units.json"), "\"state\":\"silent\",\"since_ms\":1"), 5u);
  rig_.bus.link_up = true;
  rig_.run(10ms);
  EXPECT_EQ(count(get("/status.json"), "\"answering\":0,"), 1u) << "none has answered yet";
  run(200ms);
  EXPECT_EQ(count(get("/status.json"), "\"answering\":5,"), 1u);
}

TEST_F(StatusPageTest, ABusThatAReloadAddsIsShownBeforeItIsMeasured) {
  open_page();
  put_square();
  run(25s);
  ScriptedBus yards[3];
  std::vector<port::NodeBus*> added;
  for (ScriptedBus& yard : yards) {
    BusSettings settings = rig_.settings.buses.front();
    settings.name = "yard-" + std::to_string(added.size());
    rig_.settings.buses.push_back(settings);
    added.push_back(&yard);
  }
  rig_.update_settings(added);
  const std::string status = get("/status.json");
  EXPECT_TRUE(is_sound_json(status)) << status;
  EXPECT_EQ(count(status, "\"utilisation\":0,\"efficiency\":0"), 3u) << status;
  EXPECT_EQ(count(get("/metrics"), "\netcm_bus_utilisation_ratio{bus=\"yard-2\"} 0\n"), 1u);
}

// A converter with a buffer, and a pty, are faster than their speed says.
TEST_F(StatusPageTest, EfficiencyIsNeverAboveOne) {
  BusSettings& bus = rig_.settings.buses.front();
  bus.units = {{1, 5}};
  bus.outstanding_max = 1;
  bus.link = port::SerialLine{.path = "line", .baud = 1200};
  open_page();
  put_square();
  run(25s);
  EXPECT_EQ(count(get("/status.json"), "\"efficiency\":1"), 1u) << get("/status.json");
  EXPECT_EQ(count(get("/metrics"), "\netcm_bus_efficiency_ratio{bus=\"yard\"} 1\n"), 1u);
}

// With scan = "1-247", units that are not there would be most of what is counted.
TEST_F(StatusPageTest, UnitsThatAreOnlyLookedForAreNotCounted) {
  rig_.settings.buses[0].units = {{1, 5}};
  rig_.settings.buses[0].scan = {{6, 247}};
  open_page();
  put_square();
  run(2s);
  EXPECT_EQ(count(get("/status.json"), "\"units\":5,\"answering\":5,"), 1u);
}

TEST_F(StatusPageTest, HealthNamesTheBusThatIsSilent) {
  open_page();
  put_square();
  run(5s);
  EXPECT_EQ(get("/healthz"), "ok\n");
  for (std::uint8_t unit = 1; unit <= 5; ++unit) rig_.bus.silence(unit);
  run(5s);
  EXPECT_EQ(get("/healthz").find("bus yard: no unit has answered for "), 0u);
  EXPECT_EQ(answer_.status, port::web_status::unavailable);
  put_square();
  run(2s);
  EXPECT_EQ(get("/healthz"), "ok\n");
  EXPECT_EQ(answer_.status, port::web_status::ok);
}

class NeverHeard : public RigTest, private PageReader {
 protected:
  NeverHeard() : RigTest({feature(1001, 1003), feature(1002, 9004)}), PageReader(rig_) {
    rig_.put_square();
  }
  // The part of the status that tells of them.
  std::string unheard() {
    if (!page_) make_page();
    const std::string status = get("/status.json");
    const std::size_t from = status.find("\"unheard\":");
    return status.substr(from, status.find("\n", from) - from);
  }
};

TEST_F(NeverHeard, IsSaidOfAMistypedSerialOnceAllUnitsWereAsked) {
  rig_.run(2s);
  EXPECT_EQ(unheard(), "\"unheard\":[],");
  rig_.run(3s);
  const std::string why =
      "node 9004 has not been heard since the start, and feature 2 (1002-9004, site.toml:1) waits "
      "for it; "
      "correct the "
      "serial there, or look for the node";
  EXPECT_EQ(unheard(), "\"unheard\":[{\"serial\":9004,\"why\":\"" + why + "\"}],");
  EXPECT_EQ(rig_.log.count(why), 1u);
  rig_.settings.features[1] = feature(1002, 1004);
  rig_.update_settings();
  rig_.run(5s);
  EXPECT_EQ(unheard(), "\"unheard\":[],");
  EXPECT_EQ(rig_.log.count("has not been heard since the start"), 1u);
}

TEST_F(NeverHeard, IsSaidInOtherWordsOfWhoFellSilentAndWasDismissed) {
  rig_.run(5s);
  rig_.bus.silence(3);
  rig_.run(5s);
  EXPECT_TRUE(rig_.gateway->dismiss(Serial{1003}));
  EXPECT_EQ(rig_.log.count("node 1003 is no longer missed"), 1u);
  rig_.run(5s);
  const std::string list = unheard();
  EXPECT_NE(list.find("node 1003 has left or was dismissed, and feature 1 "), std::string::npos)
      << list;
  EXPECT_EQ(list.find("node 1003 has not been heard"), std::string::npos) << list;
}

TEST_F(NeverHeard, IsNotSaidBeforeEachUnitWasAsked) {
  rig_.settings.buses[0].scan = {{.first = 30, .last = 200}};
  rig_.run(5s);
  EXPECT_EQ(unheard(), "\"unheard\":[],");
  rig_.run(60s);
  EXPECT_NE(unheard(), "\"unheard\":[],");
}

TEST_F(StatusPageTest, HealthTellsAllThatIsWrong) {
  open_page();
  std::string refusal = "the configuration is refused";
  sources_->refusal = &refusal;
  page_.emplace(*sources_, 4);
  put_square();
  run(1s);
  masters_.is_listening = false;
  rig_.bus.silence(5);
  run(15s);
  const std::string health = get("/healthz");
  EXPECT_EQ(count(health, "\n"), 3u) << health;
  EXPECT_EQ(health.find("server: nobody can read the mesh"), 0u) << health;
  EXPECT_EQ(count(health, "\nthe configuration is refused\n1 node is missing: "), 1u) << health;
  const std::string status = get("/status.json");
  EXPECT_TRUE(is_sound_json(status)) << status;
  EXPECT_EQ(count(status, "\",\"the configuration is refused\",\"1 node is missing: "), 1u)
      << status;
}

// Else an alarm would be critical beside a health of "ok".
TEST_F(StatusPageTest, HealthAndAlarmsMeanTheSameBySilent) {
  open_page();
  put_square();
  run(5s);
  rig_.bus.link_up = false;
  while (!rig_.gateway->presence().is_silent(BusIndex{0})) run(10ms);
  EXPECT_EQ(get("/healthz").find("bus yard: no unit has answered for "), 0u);
}

TEST_F(StatusPageTest, AConfigurationThatIsRefusedIsToldUntilItIsMended) {
  open_page();
  std::string refusal;
  sources_->refusal = &refusal;
  page_.emplace(*sources_, 4);
  put_square();
  run(1s);
  EXPECT_EQ(get("/healthz"), "ok\n");
  refusal = "the configuration was changed and is refused: site.toml:5: what; the old one holds";
  EXPECT_EQ(get("/healthz"), refusal + "\n");
  EXPECT_EQ(answer_.status, port::web_status::unavailable);
  EXPECT_NE(get("/status.json").find("\"troubles\":[\"" + refusal), std::string::npos);
  EXPECT_NE(get("/metrics").find("\netcm_configuration_refused 1\n"), std::string::npos);
  refusal.clear();
  EXPECT_EQ(get("/healthz"), "ok\n");
  EXPECT_NE(get("/metrics").find("\netcm_configuration_refused 0\n"), std::string::npos);
}

TEST_F(StatusPageTest, AServerWithoutItsPortIsNotHealthy) {
  open_page();
  put_square();
  run(1s);
  EXPECT_NE(get("/metrics").find("\netcm_listening{server=\"modbus\"} 1\n"), std::string::npos);
  masters_.is_listening = false;
  EXPECT_EQ(get("/healthz"),
            "server: nobody can read the mesh; the log says what is wrong with its port\n");
  EXPECT_EQ(answer_.status, port::web_status::unavailable);
  EXPECT_NE(get("/metrics").find("\netcm_listening{server=\"modbus\"} 0\n"), std::string::npos);
  EXPECT_NE(get("/status.json").find("\"troubles\":[\"server: nobody"), std::string::npos);
}

TEST_F(StatusPageTest, FilesAreThereAndNothingElse) {
  open_page();
  for (const PageFile& file : page_files()) {
    EXPECT_EQ(get(std::string(file.path)), file.content);
    EXPECT_EQ(answer_.status, port::web_status::ok);
    EXPECT_NE(answer_.version, 0u);
    // Nothing comes from elsewhere: it works without a network. The guide names other places.
    const bool is_of_guide = file.path.starts_with("/guide");
    EXPECT_EQ(count(std::string(file.content), is_of_guide ? "src=\"http" : "https://"), 0u)
        << file.path;
    if (is_of_guide) continue;
    EXPECT_EQ(count(std::string(file.content), "\"//"), 0u) << file.path;
  }
  EXPECT_EQ(get("/").find("<!doctype html>"), 0u);
  for (const char* path :
       {"/index.html", "/map.js/", "//", "/../etc/passwd", "/embed.cmake", "/ "}) {
    get(path);
    EXPECT_EQ(answer_.status, port::web_status::not_found) << path;
  }
}

// Names are cut for each document, and may be longer than any of them has room for.
// Built without cmark-gfm there is none, and nothing leads there.
TEST_F(StatusPageTest, TheGuideLeadsOnlyToWhatIsThere) {
  open_page();
  std::map<std::string, std::string> pages;
  for (const PageFile& file : page_files()) pages.emplace(file.path, file.content);
  EXPECT_EQ(count(pages.at("/"), "href=\"guide") > 0, pages.contains("/guide"));
  if (!pages.contains("/guide")) return;
  EXPECT_TRUE(pages.contains("/guide/settings.html"));
  ASSERT_TRUE(pages.contains("/guide/")) << "with a slash at its end";
  std::size_t links = 0;
  const std::regex link("(href|src)=\"([^\"#:]*)(#?)([^\":]*)\"");
  for (const auto& [path, text] : pages) {
    if (!(path == "/" || path.starts_with("/guide")) || text.find("<!doctype html>") != 0) continue;
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at, ++links) {
      const std::string where = (*at)[2];
      if (where == "./" || where == "../") continue;
      if (path == "/" && !where.starts_with("guide")) continue;
      std::string to = where.empty() ? path : path.substr(0, path.rfind('/') + 1) + where;
      if (where.starts_with("../")) to = "/" + where.substr(3);
      ASSERT_TRUE(pages.contains(to)) << path << ": " << at->str();
      if ((*at)[3] == "") continue;
      EXPECT_EQ(count(pages.at(to), " id=\"" + (*at)[4].str() + "\""), 1u)
          << path << ": " << at->str();
    }
  }
  EXPECT_GT(links, 200u);
  EXPECT_EQ(count(pages.at("/guide/nodes.html"), "id=\"names\""), 1u);
}

TEST_F(StatusPageTest, EveryDocumentIsUtf8WhateverTheNameOfABus) {
  for (const std::string name : {"\u00e4", "\u20ac", "\U0001f600", "\xff", "\xe2\x82"}) {
    for (std::size_t before = 190; before < 204; ++before) {
      Rig rig;
      rig.settings.buses[0].name = std::string(before, 'y') + name;
      for (int i = 0; i < 30; ++i) rig.settings.buses[0].name += name;
      rig.start();
      rig.put_square();
      RecentEvents events(rig.clock, rig.log);
      events.write(port::Level::warning, "bus " + rig.settings.buses[0].name + ": is silent");
      const StatusSources sources{.gateway = *rig.gateway,
                                  .events = events,
                                  .alarms = alarms_,
                                  .wall_clock = wall_clock_,
                                  .masters = masters_,
                                  .readers = readers_,
                                  .version = "1.2.3",
                                  .started_at = rig.clock.now()};
      StatusPage page(sources, 1);
      rig.run(1s);
      for (const char* const path :
           {"/status.json", "/mesh.geojson", "/ages.json", "/metrics", "/healthz"}) {
        ASSERT_EQ(page.begin(0, path).status, 200) << path;
        std::string text;
        std::vector<char> out(1000);
        while (const std::size_t size = page.read(0, out)) text.append(out.data(), size);
        page.end(0);
        EXPECT_TRUE(test::is_utf8(text)) << path << " with " << before << " bytes before " << name;
      }
    }
  }
}

// A slow reader has the time of its question, and what it reads may have come since.
TEST_F(StatusPageTest, NoAgeIsBelowZeroWhateverComesWhileItIsRead) {
  rig_.settings.poll.leave_after = 2s;
  open_page();
  put_square();
  rig_.put(6, 90'000'000, 0);  // outside
  run(1s);
  const std::regex below_zero(R"re((_seconds[^ \n]* |_ms":|,)-[0-9])re");
  for (const char* const path : {"/metrics", "/status.json", "/ages.json"}) {
    answer_ = page_->begin(0, path);
    events_.write(port::Level::info, "later");
    rig_.put(7, 30, 30);
    rig_.put(8, 90'000'000, 7);
    rig_.bus.silence(5);
    run(5s);
    const std::string text = rest(0);
    EXPECT_FALSE(std::regex_search(text, below_zero)) << text;
  }
}

}  // namespace
}  // namespace etcm::firmware
