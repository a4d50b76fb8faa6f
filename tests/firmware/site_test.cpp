// The site file, .poly and GeoJSON: what it becomes, and what is said about what is wrong in it.
#include <gtest/gtest.h>

#include "firmware/config/configuration.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {
namespace {

class Site : public testing::Test {
 protected:
  // A configuration with this file as its site.
  Settings read(const std::string& file, const std::string& contents, const std::string& more = "",
                const std::string& features = "") {
    folder_.write(file, contents);
    path_ = folder_.path(file);
    const std::string plane = file.ends_with(".poly") ? "" : "crs = \"plane\"\n";
    const std::string config =
        folder_.write("site.toml", "[site]\nfile = \"" + file + "\"\n" + plane + more +
                                       "\n[mesh]\nvertices_max = 200\nfeatures_max = 50\n[[bus]]\n"
                                       "tcp = \"127.0.0.1:502\"\nunits = \"1\"\n" +
                                       features);
    mistakes_.clear();
    return read_configuration(config, nullptr, mistakes_);
  }
  Settings draw(const std::string& features, const std::string& more = "") {
    return read("site.geojson",
                "{\"type\": \"FeatureCollection\", \"features\": [\n" + features + "]}", more);
  }
  // Mistakes, each without the folder.
  std::string mistakes() const {
    std::string all;
    for (const std::string& mistake : mistakes_) {
      EXPECT_TRUE(mistake.starts_with(folder_.path(""))) << mistake;
      all += mistake.substr(std::min(mistake.size(), folder_.path("").size())) + "\n";
    }
    return all;
  }
  std::string segments(const Settings& settings) const {
    std::string all;
    for (const FeatureSettings& feature : settings.features) {
      all += to_string(feature.from) + "-" + to_string(feature.to) + " ";
    }
    return all;
  }

  test::ScratchFolder folder_;
  std::string path_;
  std::vector<std::string> mistakes_;
};

std::string geometry(const std::string& type, const std::string& coordinates,
                     const std::string& properties = "{}") {
  return "{\"type\": \"Feature\", \"properties\": " + properties + ", \"geometry\": {\"type\": \"" +
         type + "\", \"coordinates\": " + coordinates + "}}";
}

TEST_F(Site, AFileThatIsNotThereIsNamedWhereItIsAskedFor) {
  const std::string config =
      folder_.write("site.toml",
                    "[mesh]\nvertices_max = 9\n[[bus]]\ntcp = \"127.0.0.1:502\"\nunits = \"1\"\n"
                    "[site]\nfile = \"nowhere.geojson\"\n");
  read_configuration(config, nullptr, mistakes_);
  EXPECT_EQ(mistakes(), "site.toml:6: the site file " + folder_.path("nowhere.geojson") +
                            " is not there; correct 'file'\n");
}

TEST_F(Site, ALineBecomesAStretchBetweenEachTwoVertices) {
  const Settings settings =
      draw(geometry("LineString", "[[0, 0], [10, 0.25, 7], [10, 0.25], [20, -1e1]]",
                    "{\"name\": \"north\\nwall\"}"),
           "unit = \"0.01\"");
  EXPECT_EQ(mistakes(), "");
  EXPECT_EQ(segments(settings), "(0, 0)-(1000, 25) (1000, 25)-(2000, -1000) ");
  EXPECT_EQ(settings.anchors.size(), 3u);
  EXPECT_EQ(settings.features[0].name, "north wall");
  EXPECT_EQ(settings.features[0].source, path_ + ":2");
}

TEST_F(Site, ANodeStandsWhereTheFileSaysSo) {
  // By a point with its serial, or by the serials of the line; every line there ends at the node.
  const Settings settings = draw(
      geometry("LineString", "[[0, 0], [5, 5]]") + "," +
      geometry("LineString", "[[5, 5], [9, 0], [9, 9]]", "{\"serials\": [null, 70001, null]}") +
      "," + geometry("Point", "[5, 5]", "{\"serial\": 4294967294}"));
  EXPECT_EQ(mistakes(), "");
  EXPECT_EQ(segments(settings), "(0, 0)-4294967294 4294967294-70001 70001-(9, 9) ");
  EXPECT_EQ(settings.anchors.size(), 2u);
}

TEST_F(Site, LinesThatShareAStretchDrawItOnce) {
  const Settings settings = draw(geometry("Polygon", "[[[0,0],[4,0],[4,4],[0,0]]]") + "," +
                                 geometry("MultiPolygon", "[[[[4,0],[8,0],[4,4],[4,0]]]]") + "," +
                                 geometry("MultiLineString", "[[[4,4],[4,0]],[[9,9],[8,9]]]"));
  EXPECT_EQ(mistakes(), "");
  EXPECT_EQ(settings.features.size(), 6u);
  EXPECT_EQ(settings.anchors.size(), 6u);
  EXPECT_TRUE(settings.domain.outline().empty());
}

TEST_F(Site, WhatDrawsNothingDoesNoHarm) {
  const Settings settings =
      draw("{\"type\": \"Feature\", \"properties\": null, \"geometry\": null}, " +
           geometry("Point", "[3, 4]", "null"));
  EXPECT_EQ(mistakes(), "");
  EXPECT_TRUE(settings.features.empty());
  ASSERT_EQ(settings.anchors.size(), 1u);
  EXPECT_EQ(settings.anchors[0].position, (Position{3, 4}));
}

TEST_F(Site, PolygonsAreTheDomainAndItsHoles) {
  const Settings settings = draw(
      geometry("Polygon",
               "[[[0,0],[100,0],[100,100],[0,100],[0,0]],"
               "[[10,10],[20,10],[20,20],[10,20],[10,10]]]",
               "{\"kind\": \"domain\"}") +
      "," + geometry("Polygon", "[[[50,50],[60,50],[50,60],[50,50]]]", "{\"kind\": \"hole\"}"));
  EXPECT_EQ(mistakes(), "");
  EXPECT_EQ(settings.features.size(), 11u) << "outlines are lines too";
  const auto at = [&](std::int32_t x, std::int32_t y) { return settings.domain.place_of({x, y}); };
  EXPECT_EQ(at(1, 1), DomainPlace::inside);
  EXPECT_EQ(at(0, 0), DomainPlace::inside) << "on the outline";
  EXPECT_EQ(at(100, 50), DomainPlace::inside) << "on the outline";
  EXPECT_EQ(at(101, 50), DomainPlace::outside);
  EXPECT_EQ(at(-1, 100), DomainPlace::outside);
  EXPECT_EQ(at(-1, 0), DomainPlace::outside);
  EXPECT_EQ(at(15, 15), DomainPlace::outside) << "a ring in the ring";
  EXPECT_EQ(at(52, 52), DomainPlace::in_hole);
  EXPECT_EQ(at(55, 55), DomainPlace::inside) << "on the edge of the hole";
  EXPECT_EQ(at(56, 55), DomainPlace::inside);
  EXPECT_EQ(at(60, 50), DomainPlace::inside) << "on its corner";
}

TEST_F(Site, CoordinatesBecomeUnitsExactly) {
  const std::string line = geometry("LineString", "[[569000.29, 7034000.5], [569001, 7034001]]");
  Settings settings = draw(line, "unit = \"0.01\"\norigin = [\"569000\", \"7034000.25\"]");
  EXPECT_EQ(mistakes(), "");
  EXPECT_EQ(segments(settings), "(29, 25)-(100, 75) ");
  settings = draw(line, "unit = \"0.5\"\norigin = [569000, 7034000]\nround = true");
  EXPECT_EQ(segments(settings), "(1, 1)-(2, 2) ");
  settings = draw(geometry("LineString", "[[-0.5, 0.5], [-0.4, 1.49]]"), "round = true");
  EXPECT_EQ(segments(settings), "(-1, 1)-(0, 1) ");
  settings = draw(geometry("LineString", "[[0.3048, 0], [3.048, 0]]"), "unit = \"0.3048\"");
  EXPECT_EQ(segments(settings), "(1, 0)-(10, 0) ");
}

struct Wrong {
  const char* name;
  std::string features;
  const char* message;  // after "site.geojson:2: "
};
class SiteMistake : public Site, public testing::WithParamInterface<Wrong> {};

TEST_P(SiteMistake, IsNamedWithItsPlaceAndCure) {
  draw(GetParam().features);
  EXPECT_EQ(mistakes(), std::string("site.geojson:2: ") + GetParam().message + "\n");
}

INSTANTIATE_TEST_SUITE_P(
    Rows, SiteMistake,
    testing::Values(
        Wrong{"no_object", "7", "features/0: must be an object"},
        Wrong{"no_feature", "{\"type\": \"Point\", \"coordinates\": [0, 0]}",
              "features/0: is no Feature; write \"type\": \"Feature\", with a geometry"},
        Wrong{"no_type", "{\"geometry\": {}}",
              "features/0: 'type' is missing; is this a GeoJSON file? Export it as one"},
        Wrong{"a_text_as_type", "{\"type\": 1}", "features/0/type: must be a text"},
        Wrong{"properties", geometry("Point", "[0, 0]", "[]"),
              "features/0/properties: must be an object or null"},
        Wrong{"unknown_geometry", geometry("Circle", "[0, 0]"),
              "features/0/geometry: the geometry 'Circle' is unknown here; use Point, LineString, "
              "MultiLineString, Polygon or MultiPolygon"},
        Wrong{
            "collection", geometry("GeometryCollection", "[]"),
            "features/0/geometry: a GeometryCollection; write its parts as features of their own"},
        Wrong{"short_line", geometry("LineString", "[[1, 1], [1, 1]]"),
              "features/0/geometry/coordinates: a line of fewer than two different positions; take "
              "it out"},
        Wrong{"flat", geometry("LineString", "[1, 2]"),
              "features/0/geometry/coordinates/0: is no position; give it as [x, y]"},
        Wrong{"text", geometry("LineString", "[[0, \"1\"], [2, 2]]"),
              "features/0/geometry/coordinates/0: holds a text where a number must be; give it as "
              "[x, y]"},
        Wrong{"fraction", geometry("Point", "[500.5, 0]"),
              "features/0/geometry/coordinates: x 500.5 is no whole number of units; set a smaller "
              "unit in [site], or round = true to take the nearest"},
        Wrong{"degrees", geometry("Point", "[10.5, 59.25]"),
              "features/0/geometry/coordinates: x 10.5 is no whole number of units; set a smaller "
              "unit in [site], or round = true to take the nearest (if these are degrees: GeoJSON "
              "is read in them where [site] has no crs)"},
        Wrong{"far", geometry("Point", "[0, 16777217]"),
              "features/0/geometry/coordinates: y 16777217 is 16777217 units, and they run from "
              "-16777216 to 16777216; set origin in [site] to a corner of the site, or a greater "
              "unit"},
        Wrong{"huge", geometry("Point", "[0, 1e300]"),
              "features/0/geometry/coordinates: y 1e300 is too large; the site file counts in "
              "something else than the unit says"},
        Wrong{"open_ring", geometry("Polygon", "[[[0,0],[1,0],[1,1]]]"),
              "features/0/geometry/coordinates/0: the ring is not closed; repeat its first "
              "coordinate at the end"},
        Wrong{"flat_ring", geometry("Polygon", "[[[0,0],[1,0],[0,0]]]"),
              "features/0/geometry/coordinates/0: the ring has no area; give it three different "
              "corners at least"},
        Wrong{"kind", geometry("Polygon", "[[[0,0],[1,0],[1,1],[0,0]]]", "{\"kind\": \"Domain\"}"),
              "features/0/properties/kind: is 'Domain'; write it as \"domain\""},
        Wrong{"line_as_domain", geometry("LineString", "[[0,0],[1,0]]", "{\"kind\": \"domain\"}"),
              "features/0/geometry: a LineString cannot be a domain or a hole; draw it as a "
              "Polygon, or take its 'kind' out"},
        Wrong{
            "serial", geometry("Point", "[0, 0]", "{\"serial\": 4294967295}"),
            "features/0/properties/serial: is no serial; give a whole number from 0 to 4294967294, "
            "or null"},
        Wrong{
            "serials", geometry("LineString", "[[0,0],[1,0]]", "{\"serials\": [1]}"),
            "features/0/geometry/coordinates: has 2 positions, and 'serials' does not fit; give it "
            "as many entries, null where no node stands"},
        Wrong{
            "one_place_two_nodes",
            geometry("Point", "[0, 0]", "{\"serial\": 1}") + "," +
                geometry("Point", "[0, 0]", "{\"serial\": 2}"),
            "features/1/geometry/coordinates: node 2 stands where node 1 does; correct one of the "
            "serials"},
        Wrong{
            "one_node_two_places", geometry("LineString", "[[0,0],[1,0]]", "{\"serials\": [5, 5]}"),
            "features/0/geometry/coordinates/1: node 5 stands at two places of this file; correct "
            "one of the serials"}),
    [](const auto& row) { return std::string(row.param.name); });

TEST_F(Site, LinesThatCrossAreFoundBeforeTheyAreInAMesh) {
  draw(geometry("LineString", "[[0,0],[9,9]]") + ",\n" + geometry("LineString", "[[0,9],[9,0]]"));
  EXPECT_EQ(mistakes(),
            "site.geojson:3: the line from (0, 9) to (9, 0) crosses the line from (0, "
            "0) to (9, 9) (" +
                path_ + ":2) at (5, 5); draw a vertex on both where they meet\n");
  draw(geometry("LineString", "[[0,0],[9,0]]") + ",\n" + geometry("LineString", "[[3,0],[12,0]]"));
  EXPECT_NE(mistakes().find(" runs along "), std::string::npos) << mistakes();
  draw(geometry("LineString", "[[0,0],[9,0]]") + ",\n" + geometry("LineString", "[[3,0],[3,7]]"));
  EXPECT_EQ(mistakes(), "") << "a line may end on another";
}

TEST_F(Site, MoreThanEnoughMistakesAreCutOff) {
  std::string features = geometry("Point", "[0.5, 0]");
  for (int i = 0; i < 100; ++i) features += "," + geometry("Point", "[0.5, 0]");
  draw(features);
  EXPECT_EQ(mistakes_.size(), 21u);
  EXPECT_NE(mistakes_.back().find("more mistakes follow"), std::string::npos);
}

TEST_F(Site, APolyOfSerials) {
  const std::string nodes = "3 2 0 0\n1 0.5 0\n2 9 0\n3 0 9\n";
  Settings settings = read("site.poly", nodes + "2 0\n1 1 2\n2 2 3\n0\n");
  EXPECT_EQ(mistakes(), "");
  EXPECT_EQ(segments(settings), "1-2 2-3 ");
  EXPECT_TRUE(settings.anchors.empty());
  read("site.poly", nodes + "0\n1\n1 1 1\n");
  EXPECT_NE(mistakes().find("site.poly:7: holes need fixed points"), std::string::npos);
  read("site.poly", nodes + "2 0\n1 1 2\n2 2 1\n0\n");
  EXPECT_NE(mistakes().find("site.poly:7: the line from 2 to 1 repeats"), std::string::npos);
}

TEST_F(Site, APolyOfAnchorsBoundsTheDomainAsInTriangle) {
  // A square with a square hole, and a spur outside that bounds nothing.
  const std::string poly =
      "8 2 0 0\n1 0 0\n2 10 0\n3 10 10\n4 0 10\n5 4 4\n6 6 4\n7 6 6\n8 4 6\n"
      "8 0\n1 1 2\n2 2 3\n3 3 4\n4 4 1\n5 5 6\n6 6 7\n7 7 8\n8 8 5\n1\n1 5 5\n";
  Settings settings = read("site.poly", poly, "nodes = \"anchors\"\nunit = \"0.1\"");
  EXPECT_EQ(mistakes(), "");
  EXPECT_EQ(settings.anchors.size(), 8u);
  EXPECT_EQ(settings.features.size(), 8u);
  EXPECT_EQ(settings.domain.place_of({1, 1}), DomainPlace::inside);
  EXPECT_EQ(settings.domain.place_of({101, 1}), DomainPlace::outside);
  EXPECT_EQ(settings.domain.place_of({50, 51}), DomainPlace::in_hole);
  EXPECT_EQ(settings.domain.place_of({40, 50}), DomainPlace::inside) << "on its edge";
  settings =
      read("site.poly", "3 2 0 0\n1 0 0\n2 10 0\n3 10 10\n1 0\n1 1 2\n0\n", "nodes = \"anchors\"");
  EXPECT_EQ(mistakes(), "");
  EXPECT_EQ(settings.domain.place_of({-5, 77}), DomainPlace::inside) << "nothing is closed";
  read("site.poly", "4 2 0 0\n1 0 0\n2 9 9\n3 0 9\n4 9 0\n2 0\n1 1 2\n2 3 4\n0\n",
       "nodes = \"anchors\"");
  EXPECT_NE(mistakes().find("site.poly:8: feature 2 (3-4) crosses feature 1"), std::string::npos)
      << mistakes();
}

TEST_F(Site, TooLittleRoomIsSaidBeforeItIsNeeded) {
  std::string line = "[[0, 0]";
  for (int i = 1; i <= 51; ++i)
    line += ", [" + std::to_string(i) + ", " + std::to_string(i % 2) + "]";
  draw(geometry("LineString", line + "]"));
  EXPECT_NE(mistakes().find("51 segments of features, and features_max in [mesh] is 50; set "
                            "features_max to twice as many"),
            std::string::npos)
      << mistakes();
}

TEST_F(Site, OtherFilesAreNone) {
  read("site.shp", "");
  EXPECT_NE(mistakes().find("site.toml:1: the site file"), std::string::npos) << mistakes();
  std::filesystem::remove(folder_.path("site.geojson"));
  read("site.poly", "");
  EXPECT_NE(mistakes().find("site.poly:1: the file ends before"), std::string::npos) << mistakes();
}

}  // namespace
}  // namespace etcm::firmware
