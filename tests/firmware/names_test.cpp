// What people call nodes, features and the site: read, checked, and shown everywhere.
#include "firmware/config/names.h"

#include <gtest/gtest.h>

#include "etcm/files/exchange.h"
#include "etcm/files/json.h"
#include "etcm/files/picture.h"
#include "fakes.h"
#include "firmware/config/configuration.h"
#include "firmware/config/reload.h"
#include "page_reader.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

constexpr const char* settings_of_names =
    "[mesh]\nvertices_max = 50\nfeatures_max = 9\n"
    "[[bus]]\nname = \"yard\"\ntcp = \"127.0.0.1:502\"\nunits = \"1-9\"\n";

class NamesRead : public testing::Test {
 protected:
  Settings read(const std::string& more) {
    mistakes_.clear();
    return read_configuration(folder_.write("gateway.toml", settings_of_names + more), nullptr,
                              mistakes_);
  }
  // The one mistake of it.
  std::string mistake(const std::string& more) {
    read(more);
    EXPECT_EQ(mistakes_.size(), 1u) << more;
    if (mistakes_.empty()) return {};
    return mistakes_.front().substr(mistakes_.front().find("gateway.toml"));
  }

  test::ScratchFolder folder_;
  std::vector<std::string> mistakes_;
};

TEST_F(NamesRead, OfNodesFeaturesAndTheSite) {
  const Settings settings = read(
      "[site]\nname = \"Hafen Süd\"\n"
      "[[node]]\nserial = 1007\nname = \"pump house\"\n"
      "[[node]]\nunit = 3\nname = \"gate\"\n"
      "[[feature]]\nfrom = 1\nto = 2\nname = \"north fence\"\n");
  EXPECT_TRUE(mistakes_.empty()) << mistakes_.front();
  EXPECT_EQ(settings.site.name, "Hafen Süd");
  ASSERT_EQ(settings.node_names.size(), 2u);
  EXPECT_EQ(settings.node_names[0].serial, Serial{1007});
  EXPECT_EQ(settings.node_names[0].name, "pump house");
  EXPECT_EQ(settings.node_names[1].bus, "yard");
  EXPECT_EQ(settings.node_names[1].address, 3u);
  EXPECT_EQ(settings.features[0].name, "north fence");
  EXPECT_TRUE(settings.nodes.empty()) << "a name alone surveys no device";
}

TEST_F(NamesRead, WhatCannotBeSeenIsRefusedWithLineAndCure) {
  for (const char* const text : {R"("a\nb")", R"("a\u007f")", R"("a\u0085b")", R"("a\u2028b")",
                                 R"("a\u202eb")", R"("a\u2066b")", R"("")", "7"}) {
    EXPECT_EQ(mistake("[site]\nname = " + std::string(text) + "\n")
                  .find("gateway.toml:9: 'name' must be a text of 1 to 64 bytes in one line, "
                        "without control characters; write it as name = \"Harbour east\""),
              0u)
        << text << ": " << mistakes_.front();
  }
  EXPECT_NE(mistake("[[feature]]\nfrom = 1\nto = 2\nname = \"" + std::string(65, 'x') + "\"\n")
                .find("gateway.toml:11: "),
            std::string::npos);
  read("[site]\nname = \"" + std::string(64, 'x') + "\"\n");
  EXPECT_TRUE(mistakes_.empty());
}

TEST_F(NamesRead, WhoseNameItIsMustBeSaid) {
  EXPECT_NE(mistake("[[node]]\nname = \"gate\"\n").find("'unit' is missing"), std::string::npos);
  EXPECT_NE(mistake("[[node]]\nserial = 7\n").find("'unit' is missing"), std::string::npos);
  EXPECT_NE(
      mistake("[[node]]\nbus = \"yard\"\nserial = 7\nname = \"gate\"\n").find("'unit' is missing"),
      std::string::npos);
  EXPECT_NE(mistake("[[node]]\nunit = 30\nname = \"gate\"\n")
                .find("gateway.toml:9: unit 30 of yard is not asked; add it to"),
            std::string::npos)
      << mistakes_.front();
  EXPECT_NE(
      mistake("[[node]]\nserial = 7\nname = \"gate\"\n[[node]]\nserial = 7\nname = \"door\"\n")
          .find("this node is named 'gate' by "),
      std::string::npos);
}

TEST_F(NamesRead, OfPointsOfTheSiteFileWhereTheyAreNodes) {
  const std::string point = R"({"type": "Feature", "geometry": {"type": "Point", "coordinates": [)";
  folder_.write("site.geojson",
                "{\"type\": \"FeatureCollection\", \"crs\": null, \"features\": [\n" + point +
                    "10, 20]}, \"properties\": {\"serial\": 1004, \"name\": \"mast\\n\"}},\n" +
                    point + "30, 20]}, \"properties\": {\"name\": \"a corner\"}}]}\n");
  const Settings settings = read("[site]\nfile = \"site.geojson\"\ncrs = \"plane\"\n");
  EXPECT_TRUE(mistakes_.empty()) << mistakes_.front();
  ASSERT_EQ(settings.node_names.size(), 1u);
  EXPECT_EQ(settings.node_names[0].serial, Serial{1004});
  EXPECT_EQ(settings.node_names[0].name, "mast ") << "a map may have anything in a name";
}

TEST_F(NamesRead, LinesThatCrossAreCalledByTheirNames) {
  const std::string line =
      R"({"type": "Feature", "geometry": {"type": "LineString", "coordinates": )";
  folder_.write("site.geojson",
                "{\"type\": \"FeatureCollection\", \"features\": [\n" + line +
                    "[[0, 0], [10, 10]]}, \"properties\": {\"name\": \"road\"}},\n" + line +
                    "[[0, 10], [10, 0]]}, \"properties\": {\"name\": \"fence\"}}]}\n");
  read("[site]\nfile = \"site.geojson\"\ncrs = \"plane\"\n");
  ASSERT_EQ(mistakes_.size(), 1u);
  EXPECT_NE(mistakes_[0].find("site.geojson:3: 'fence' crosses 'road' ("), std::string::npos)
      << mistakes_[0];
}

TEST_F(NamesRead, AReloadTakesThemOver) {
  const Settings settings = read("[[node]]\nserial = 1007\nname = \"gate\"\n");
  Settings current = settings;
  const Settings next = read(
      "[site]\nname = \"Harbour\"\n[[node]]\nserial = 1007\nname = \"door\"\n"
      "[[node]]\nunit = 2\nname = \"mast\"\n");
  EXPECT_TRUE(take_over(current, next).empty());
  EXPECT_EQ(current.site.name, "Harbour");
  ASSERT_EQ(current.node_names.size(), 2u);
  EXPECT_EQ(current.node_names[0].name, "door");
}

class Names : public RigTest, public PageReader {
 protected:
  Names() : RigTest({feature(1001, 1003)}), PageReader(rig_) {
    rig_.settings.site.name = "Harbour <east> \"1\"";
    rig_.settings.features[0].name = "fence & gate";
    rig_.settings.node_names = {
        {.serial = Serial{1001}, .name = "pump 'A' house"},
        {.bus = rig_.settings.buses[0].name, .address = 2, .name = "gate \"2\""},
        {.bus = rig_.settings.buses[0].name, .address = 6, .name = "never there"}};
  }
  void start() {
    rig_.put_square();
    rig_.start();
    make_page();
    rig_.run(1s);
    page_->advance(rig_.clock.now());
  }
  std::string get_sound(const std::string& path) {
    std::string text = get(path);
    EXPECT_NO_THROW(files::parse_json(text, path)) << text;
    return text;
  }
  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }
};

TEST_F(Names, StandInTheLogBehindTheSerial) {
  start();
  EXPECT_EQ(rig_.log.count("node 1001 'pump 'A' house' joined at"), 1u);
  EXPECT_EQ(rig_.log.count("node 1002 'gate \"2\"' joined at"), 1u);
  EXPECT_EQ(rig_.log.count("node 1003 joined at"), 1u);
}

TEST_F(Names, StandInEachDocument) {
  start();
  for (const char* const path : {"/mesh.json", "/mesh.geojson"}) {
    const std::string mesh = get_sound(path);
    EXPECT_TRUE(has(mesh, R"("type":"FeatureCollection","name":"Harbour <east> \"1\"",)")) << mesh;
    EXPECT_TRUE(has(mesh, R"("serial":1001,"name":"pump 'A' house",)")) << mesh;
    EXPECT_TRUE(has(mesh, R"("serial":1002,"name":"gate \"2\"",)")) << mesh;
    EXPECT_FALSE(has(mesh, R"("serial":1003,"name")")) << mesh;
  }
  EXPECT_TRUE(has(get_sound("/status.json"), R"("name":"Harbour <east> \"1\"",)"));
  const std::string metrics = get("/metrics");
  EXPECT_TRUE(has(metrics, R"(etcm_node_info{serial="1002",name="gate \"2\""} 1)")) << metrics;
  EXPECT_FALSE(has(metrics, R"(etcm_node_info{serial="1003")"));
  const std::string readings = get_sound("/readings.json");
  EXPECT_TRUE(has(readings, R"("names":[[1001,"pump 'A' house"],[1002,"gate \"2\""]])"))
      << readings;
}

TEST_F(Names, StandWhereSomethingIsMissing) {
  start();
  rig_.bus.silence(2);
  rig_.run(11s);
  page_->advance(rig_.clock.now());
  EXPECT_EQ(rig_.log.count("node 1002 'gate \"2\"' is missing"), 1u);
  EXPECT_TRUE(has(get_sound("/status.json"), R"("missing":[{"serial":1002,"name":"gate \"2\"",)"));
  EXPECT_TRUE(has(get("/healthz"), "1 node is missing: node 1002 'gate \"2\"', unit 2 of"));
  EXPECT_TRUE(has(get_sound("/mesh.json"), R"("serial":1002,"name":"gate \"2\"",)"));
  rig_.bus.silence(1);
  rig_.run(11s);
  page_->advance(rig_.clock.now());
  EXPECT_TRUE(has(get_sound("/mesh.json"),
                  R"("kind":"missing","feature":1,"feature_name":"fence & gate",)"));
}

TEST_F(Names, ChangeWithAReload) {
  start();
  rig_.settings.node_names = {{.serial = Serial{1003}, .name = "mast"}};
  rig_.settings.site.name.clear();
  rig_.update_settings();
  rig_.run(1s);
  page_->advance(rig_.clock.now());
  const std::string mesh = get_sound("/mesh.json");
  EXPECT_TRUE(has(mesh, R"("serial":1003,"name":"mast",)")) << mesh;
  EXPECT_FALSE(has(mesh, "pump"));
  EXPECT_FALSE(has(mesh, "Harbour"));
}

TEST_F(Names, OfTheSiteIsToldWithAlarmsAndMetrics) {
  start();
  rig_.run(1s);
  page_->advance(rig_.clock.now());
  EXPECT_TRUE(get_sound("/alarms.json").starts_with(R"({"site":"Harbour )"));
  EXPECT_TRUE(has(get("/metrics"), "\netcm_site_info{site=\"Harbour "));
}

TEST_F(Names, OfTheSiteStandFirstInFiles) {
  rig_.settings.files.emplace();
  rig_.settings.files->interval = 1s;
  start();
  rig_.run(2s);
  ASSERT_NE(rig_.files.last, nullptr);
  const files::MeshImage& image = *rig_.files.last;
  EXPECT_TRUE(has(files::svg_text(image, {.title = "mesh"}),
                  "<title>Harbour &lt;east&gt; &quot;1&quot;</title>"));
  EXPECT_TRUE(has(files::geojson_text(image), R"("name":"Harbour <east> \"1\"")"));
}

}  // namespace
}  // namespace etcm::firmware
