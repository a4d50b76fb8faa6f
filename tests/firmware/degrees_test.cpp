// Sites in degrees, with PROJ itself: what their files and nodes become in the plane.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "device_test.h"
#include "etcm/files/exchange.h"
#include "etcm/types.h"
#include "fakes.h"
#include "firmware/alarms/alarm_subject.h"
#include "firmware/alarms/alarm_watch.h"
#include "firmware/config/configuration.h"
#include "firmware/config/reload.h"
#include "firmware/config/shared_site.h"
#include "firmware/gateway/plane_change.h"
#include "firmware/mesh/length_text.h"
#include "firmware/publish/snapshot_image.h"
#include "page_reader.h"
#include "proj/proj_source.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

constexpr const char* rest = R"(
[mesh]
vertices_max = 200
features_max = 50
[[profile]]
name = "rover"
longitude = { register = 0, type = "i32", scale = "1/10000000" }
latitude = { register = 2, type = "i32", scale = "1/10000000" }
[[profile]]
name = "meter"
[[profile.reading]]
name = "level"
value = { register = 0, type = "u16" }
[[bus]]
tcp = "127.0.0.1:502"
name = "yard"
[[bus.device]]
units = "5-6"
profile = "meter"
)";

class Degrees : public testing::Test {
 protected:
  Settings read(const std::string& site, const std::string& more = "") {
    mistakes_.clear();
    config_ = folder_.write("site.toml", site + rest + more);
    return read_configuration(config_, projections_, mistakes_);
  }
  // A file of one line, with `member` before its features.
  Settings draw(const std::string& positions, const std::string& site = "",
                const std::string& member = "") {
    folder_.write("site.geojson",
                  "{\"type\": \"FeatureCollection\"," + member +
                      "\n\"features\": [{\"type\": \"Feature\", \"properties\": {}, \"geometry\": "
                      "{\"type\": \"LineString\", \"coordinates\": [\n" +
                      positions + "]}}]}");
    return read("[site]\nfile = \"site.geojson\"\n" + site);
  }
  std::string mistakes() const {
    std::string all;
    for (const std::string& mistake : mistakes_) all += mistake + "\n";
    const std::string folder = folder_.path("");
    for (std::size_t at; (at = all.find(folder)) != std::string::npos;)
      all.erase(at, folder.size());
    return all;
  }

  port::ProjSource proj_;
  port::ProjectionSource* projections_ = &proj_;
  test::ScratchFolder folder_;
  std::string config_;
  std::vector<std::string> mistakes_;
};

// Of the ellipsoid of WGS 84, in metres for a degree there.
double parallel_degree(double latitude) {
  const double radian = std::acos(-1.0) / 180, s = std::sin(latitude * radian);
  return 6378137 / std::sqrt(1 - 0.00669437999014 * s * s) * std::cos(latitude * radian) * radian;
}

TEST_F(Degrees, AreWhatGeoJsonCountsIn) {
  const Settings settings = draw("[10.4, 63.4], [10.41, 63.4]");
  ASSERT_EQ(mistakes(), "");
  ASSERT_EQ(settings.anchors.size(), 2u);
  EXPECT_EQ(settings.anchors[0].position, (Position{0, 0})) << "the first position is the middle";
  EXPECT_NEAR(settings.anchors[1].position.x, 0.01 * parallel_degree(63.4), 1);
  EXPECT_NEAR(settings.anchors[1].position.y, 0, 1);
}

constexpr const char* plane_device = R"([[bus.device]]
units = "9"
profile = "tag"
[[profile]]
name = "tag"
x = { register = 0, type = "i32" }
y = { register = 2, type = "i32" }
)";

// What is warned of the devices of 'tag'.
std::string warnings_of_tag(const Settings& settings) {
  std::string all;
  for (const std::string& warning : settings.warnings) {
    if (warning.find("'tag'") != std::string::npos) all += warning + "\n";
  }
  return all;
}

TEST_F(Degrees, PlacesOfAPlaneBesideThemNeedToSayOfWhich) {
  const auto with_rover =
      std::string("[[bus.device]]\nunits = \"8\"\nprofile = \"rover\"\n") + plane_device;
  const std::string surveyed = "[[node]]\nunit = 5\nlongitude = \"10\"\nlatitude = \"63\"\n";
  read("", surveyed + plane_device);
  EXPECT_EQ(mistakes_.size(), 1u);
  EXPECT_NE(mistakes().find("site.toml:24: x and y of the devices of 'tag' are places of a plane, "
                            "and nothing says of which"),
            std::string::npos)
      << mistakes();
  EXPECT_NE(mistakes().find("name their coordinate system as crs = \"EPSG:...\" in [site], give "
                            "longitude and latitude in their profile"),
            std::string::npos);
  Settings settings = read("[site]\norigin = [\"10.3951\", \"63.4305\"]\n", with_rover);
  EXPECT_EQ(mistakes(), "");
  EXPECT_NE(
      warnings_of_tag(settings).find("'tag' are taken as metres east and north of the origin "
                                     "(10.3951, 63.4305); if that is not what they tell, name "),
      std::string::npos)
      << warnings_of_tag(settings);
  settings = read("[site]\ncrs = \"EPSG:25832\"\norigin = [\"569000\", \"7034000\"]\n", with_rover);
  EXPECT_EQ(mistakes(), "");
  EXPECT_EQ(warnings_of_tag(settings), "");
}

TEST_F(Degrees, AnOriginThatLooksLikeThemIsNoPlaceOfAPlane) {
  Settings settings = read("[site]\norigin = [\"10.3951\", \"63.4305\"]\n", plane_device);
  EXPECT_EQ(mistakes(), "");
  EXPECT_NE(warnings_of_tag(settings).find("though it looks like longitude and latitude"),
            std::string::npos);
  settings = read("[site]\norigin = [\"10\", \"60\"]\n", plane_device);
  EXPECT_EQ(warnings_of_tag(settings), "") << "a pure plane";
  settings = read("", plane_device);
  EXPECT_EQ(warnings_of_tag(settings), "");
}

TEST_F(Degrees, AreAboutTheOriginThatIsGiven) {
  const Settings settings =
      draw("[10.4, 63.4], [10.41, 63.4]", "origin = [\"10.41\", \"63.4\"]\nunit = \"0.01\"\n");
  ASSERT_EQ(mistakes(), "");
  EXPECT_EQ(settings.anchors[1].position, (Position{0, 0}));
  EXPECT_NEAR(settings.anchors[0].position.x, -parallel_degree(63.4), 2);
}

TEST_F(Degrees, BecomeTheCoordinatesOfACrs) {
  const Settings settings = draw("[9, 0.1], [9.001, 0.1]", "crs = \"EPSG:25832\"\n");
  ASSERT_EQ(mistakes(), "");
  // The central meridian of zone 32 is 500 km east by definition.
  EXPECT_EQ(settings.anchors[0].position.x, 500'000);
  EXPECT_NEAR(settings.anchors[1].position.x, 500'000 + 0.9996 * 0.001 * parallel_degree(0.1), 1);
}

TEST_F(Degrees, AFileInTheCrsOfThePlaneIsTakenAsItIs) {
  const Settings settings = draw("[569000.25, 7034000], [569010, 7034000]",
                                 "crs = \"EPSG:25832\"\nunit = \"0.25\"\n"
                                 "origin = [\"569000\", \"7034000\"]\n");
  ASSERT_EQ(mistakes(), "");
  EXPECT_EQ(settings.anchors[0].position, (Position{1, 0}));
  EXPECT_EQ(settings.anchors[1].position, (Position{40, 0}));
  ASSERT_NE(settings.site.projection, nullptr);
}

// As QGIS writes it.
constexpr const char* utm_member =
    "\"crs\": {\"type\": \"name\", \"properties\": {\"name\": \"urn:ogc:def:crs:EPSG::25832\"}},";

TEST_F(Degrees, AFileMayNameItsCrs) {
  const Settings settings = draw("[569000, 7034000], [569010, 7034000]",
                                 "origin = [\"569000\", \"7034000\"]\n", utm_member);
  ASSERT_EQ(mistakes(), "");
  EXPECT_EQ(settings.anchors[0].position, (Position{0, 0}));
  EXPECT_EQ(settings.anchors[1].position, (Position{10, 0})) << "exactly";
  ASSERT_NE(settings.site.projection, nullptr);
}

TEST_F(Degrees, AFileInOneCrsGoesIntoThePlaneOfAnother) {
  const std::string site = "crs = \"EPSG:25833\"\norigin = [\"269000\", \"7040000\"]\n";
  const Settings settings = draw("[569000, 7034000], [569010, 7034000]", site, utm_member);
  ASSERT_EQ(mistakes(), "");
  const port::EarthPoint first =
      earth_point(settings.site.plane(), to_point(settings.anchors[0].position)).value();
  std::string why;
  const auto utm = proj_.of_crs("EPSG:25832", why)->to_plane(first);
  EXPECT_NEAR(static_cast<double>(utm->x) / 1e9, 569000, 1);
  EXPECT_NEAR(static_cast<double>(utm->y) / 1e9, 7034000, 1);
}

TEST_F(Degrees, OfNodesAreWhereTheySay) {
  const Settings settings =
      read("",
           "[[node]]\nunit = 5\nlongitude = \"10.4\"\nlatitude = \"63.4\"\n"
           "[[node]]\nunit = 6\nlongitude = \"10.41\"\nlatitude = \"63.4\"\n");
  ASSERT_EQ(mistakes(), "");
  EXPECT_EQ(settings.nodes[0].position, (Position{0, 0}));
  EXPECT_NEAR(settings.nodes[1].position->x, 0.01 * parallel_degree(63.4), 1);
}

TEST_F(Degrees, APointOfTheFileIsTheDeviceThatWasSurveyedThere) {
  folder_.write("site.geojson",
                R"({"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"unit": 5}, "geometry": {"type": "Point", "coordinates": [10, 60]}},
{"type": "Feature", "properties": {"bus": "yard", "unit": 6, "serial": 77},
 "geometry": {"type": "Point", "coordinates": [10.001, 60]}},
{"type": "Feature", "properties": {"name": "pipe"},
 "geometry": {"type": "LineString", "coordinates": [[10, 60], [10.001, 60]]}}]})");
  const Settings settings = read("[site]\nfile = \"site.geojson\"\n");
  ASSERT_EQ(mistakes(), "");
  ASSERT_EQ(settings.nodes.size(), 2u);
  EXPECT_EQ(settings.nodes[0].position, (Position{0, 0}));
  ASSERT_EQ(settings.features.size(), 1u);
  EXPECT_EQ(settings.features[0].from, FeatureEnd(Serial{1005}));
  EXPECT_EQ(settings.features[0].to, FeatureEnd(Serial{77}));
  EXPECT_TRUE(settings.anchors.empty());
}

struct Wrong {
  const char* name;
  const char* positions;
  const char* site;
  const char* member;
  const char* said;
};

class WrongDegrees : public Degrees, public testing::WithParamInterface<Wrong> {};

TEST_P(WrongDegrees, AreToldWithTheirCure) {
  const Wrong& wrong = GetParam();
  draw(wrong.positions, wrong.site, wrong.member);
  EXPECT_EQ(mistakes(), std::string(wrong.said) + "\n");
}

INSTANTIATE_TEST_SUITE_P(
    Files, WrongDegrees,
    testing::Values(
        Wrong{"metres", "[569000, 7034000], [569010, 7034000]", "", "",
              "site.geojson:3: these are no degrees, in which GeoJSON counts unless it says "
              "otherwise; name the coordinate system of the file as crs = \"EPSG:...\" in [site], "
              "or set crs = \"plane\" if it is a drawing"},
        Wrong{"some_metres", "[10, 60], [569010, 7034000]", "", "",
              "site.geojson:3: features/0/geometry/coordinates/1: [569010, 7034000] is no "
              "longitude and latitude in degrees, as the first position of the file is; correct "
              "it, or name what the file counts in by crs in [site], \"plane\" for a drawing"},
        Wrong{"a_drawing", "[0, 0], [90, 60]", "unit = \"0.1\"\n", "",
              "site.geojson:3: features/0/geometry/coordinates/1: [90, 60] is beyond the plane of "
              "the mesh, which goes 16777216 units from its origin; set origin in [site] to a "
              "place of the site, or a greater unit (if these are no degrees: crs = \"plane\")"},
        Wrong{"unknown_crs", "[10, 60], [11, 60]", "crs = \"EPSG:999999\"\n", "",
              "site.toml:1: the coordinate system 'EPSG:999999' cannot be had: PROJ does not know "
              "it; "
              "write its code as \"EPSG:25833\""},
        Wrong{"crs_in_degrees", "[10, 60], [11, 60]", "crs = \"EPSG:4258\"\n", "",
              "site.toml:1: crs 'EPSG:4258' counts in degrees, and a mesh is in a plane; name a "
              "projected one, or take crs out, and the plane is metres about the site"},
        Wrong{"crs_without_name", "[10, 60], [11, 60]", "", "\"crs\": {},",
              "site.geojson:1: crs: names no coordinate system; take it out, and name that of the "
              "file in [site]"},
        Wrong{"file_in_an_unknown_crs", "[10, 60], [11, 60]", "",
              "\"crs\": {\"properties\": {\"name\": \"nonsense\"}},",
              "site.geojson:1: the coordinate system 'nonsense' cannot be had: PROJ does not know "
              "it; "
              "write its code as \"EPSG:25833\""},
        Wrong{
            "length_of_a_unit_twice", "[10, 60], [11, 60]", "metres = \"0.01\"\n", "",
            "site.toml:1: metres in [site] is for a plane that is nowhere on the earth, and where "
            "this one is says how long a unit is; take metres out"},
        Wrong{"origin_that_is_none", "[10, 60], [11, 60]", "origin = [\"569000\", \"7034000\"]\n",
              "",
              "site.geojson:3: the origin is no longitude and latitude in degrees, in which the "
              "site is; write origin = [\"LONGITUDE\", \"LATITUDE\"] in [site], or name the crs in "
              "which it is"}),
    [](const auto& row) { return row.param.name; });

TEST_F(Degrees, WithoutProjAreToldAndThePlaneWorks) {
  projections_ = nullptr;
  draw("[10, 60], [11, 60]");
  EXPECT_EQ(mistakes(),
            "site.geojson:3: this gateway was built without PROJ, and has no degrees and no crs; "
            "draw the site in the plane, and set crs = \"plane\" in [site]\n");
  const Settings settings = draw("[10, 60], [11, 60]", "crs = \"plane\"\n");
  EXPECT_EQ(mistakes(), "");
  EXPECT_EQ(settings.anchors[1].position, (Position{11, 60}));
}

TEST_F(Degrees, OfDevicesNeedAPlaceToBeAbout) {
  const std::string rovers = "[[bus.device]]\nunits = \"7\"\nprofile = \"rover\"\n";
  read("", rovers);
  EXPECT_EQ(mistakes(),
            "site.toml:20: the devices of 'rover' tell where they stand in degrees, and nothing "
            "says about which place the plane is; set origin = [\"LONGITUDE\", \"LATITUDE\"] in "
            "[site] to the middle of the site\n");
  read("[site]\ncrs = \"plane\"\n", rovers);
  EXPECT_NE(mistakes().find("crs = \"plane\" in [site] says that nobody knows"), std::string::npos);
  read("[site]\norigin = [\"10\", \"60\"]\n", rovers);
  EXPECT_EQ(mistakes(), "");
  read("[site]\ncrs = \"EPSG:25832\"\n", rovers);
  EXPECT_EQ(mistakes(), "");
}

// They stood ten metres from (0, 0), or another device was blamed.
TEST_F(Degrees, XAndYOfANodeAreToldWhereTheyAre) {
  const std::string rovers = "[[bus.device]]\nunits = \"7\"\nprofile = \"rover\"\n";
  const std::string node = "[[node]]\nunit = 5\nx = \"10.394\"\ny = \"63.43\"\n";
  const std::string other = "[[node]]\nunit = 6\nlongitude = \"10.4\"\nlatitude = \"63.4\"\n";
  const std::string said =
      "x and y are a place in a plane, and the site is in degrees; write longitude = \"10.394\" "
      "and latitude = \"63.43\" in their place, or if they are no degrees name their coordinate "
      "system as crs = \"EPSG:...\" in [site], or an `origin` in degrees, about which they are "
      "metres\n";
  read("", rovers + node);
  EXPECT_EQ(mistakes(), "site.toml:23: " + said);
  read("", node + other);
  EXPECT_EQ(mistakes(), "site.toml:20: " + said);
  read("", rovers + "[[node]]\nunit = 5\nx = \"569000\"\ny = \"7034000\"\n" +
               "[[node]]\nunit = 6\nx = \"569100\"\ny = \"7034000\"\n");
  EXPECT_EQ(mistakes(),
            "site.toml:23: x and y are a place in a plane, and the site is in degrees; name their "
            "coordinate system as crs = \"EPSG:...\" in [site], or an `origin` in degrees, about "
            "which they are metres (and so for 1 more [[node]])\n");
  const Settings settings = read("[site]\norigin = [\"10.39\", \"63.42\"]\n", rovers + node);
  EXPECT_EQ(mistakes(), "");
  ASSERT_FALSE(settings.warnings.empty());
  EXPECT_TRUE(settings.warnings[0].ends_with(
      "x and y are taken as a place in the plane, metres east and north of the origin, and look "
      "like degrees; if they are, write longitude = \"10.394\" and latitude = \"63.43\" in their "
      "place"))
      << settings.warnings[0];
  read("[site]\ncrs = \"EPSG:25832\"\n", rovers + node);
  EXPECT_EQ(mistakes(), "");
}

TEST_F(Degrees, AMissingOriginHidesNothingElse) {
  const std::string rovers = "[[bus.device]]\nunits = \"7\"\nprofile = \"rover\"\n";
  const std::string twice = "[[feature]]\nfrom = 1\nto = 2\n[[feature]]\nfrom = 2\nto = 1\n";
  read("", rovers + twice);
  ASSERT_EQ(mistakes_.size(), 2u) << mistakes();
  EXPECT_NE(mistakes_[0].find("set origin = "), std::string::npos);
  EXPECT_NE(mistakes_[1].find(" repeats "), std::string::npos);
}

TEST_F(Degrees, ANodeHasOneWholePlace) {
  read("[site]\norigin = [\"10\", \"60\"]\n", "[[node]]\nunit = 5\nlongitude = \"10\"\n");
  EXPECT_NE(mistakes().find("'longitude' and 'latitude' go together; add 'latitude'"),
            std::string::npos)
      << mistakes();
  read("", "[[node]]\nunit = 5\nx = 1\ny = 1\nlongitude = \"10\"\nlatitude = \"60\"\n");
  EXPECT_NE(mistakes().find("both in the plane and in degrees"), std::string::npos);
  read("[site]\norigin = [\"10\", \"60\"]\n",
       "[[node]]\nunit = 5\nlongitude = \"-170\"\nlatitude = \"-60\"\n");
  EXPECT_NE(mistakes().find("beyond the plane of the mesh"), std::string::npos) << mistakes();
}

// A unit is a centimetre: there and back is the same unit, wherever on the earth.
TEST_F(Degrees, ComeBackToTheSameUnit) {
  struct Place {
    double longitude, latitude;
  };
  for (const Place& place : {Place{10.4, 63.4}, Place{12, 55}, Place{15.6, 80}, Place{-79.9, 0},
                             Place{180, -16.8}, Place{-68.3, -54.8}}) {
    char origin[80];
    std::snprintf(origin, sizeof origin, "[site]\norigin = [\"%.6f\", \"%.6f\"]\nunit = \"0.01\"\n",
                  place.longitude, place.latitude);
    const Settings settings = read(origin, "[[bus.device]]\nunits = \"7\"\nprofile = \"rover\"\n");
    ASSERT_EQ(mistakes(), "");
    const SitePlane plane = settings.site.plane();
    for (const std::int32_t x : {-2'000'000, -123'457, 0, 1, 2'000'000}) {
      for (const std::int32_t y : {-2'000'000, -3, 0, 777'777, 2'000'000}) {
        const Position there{x, y};
        const auto degrees = earth_point(plane, to_point(there));
        ASSERT_TRUE(degrees);
        ASSERT_LE(std::abs(degrees->longitude), 180 * site_nano);
        EXPECT_EQ(nearest_position(plane, *degrees), there);
      }
    }
  }
}

// What a device that is silent meanwhile does; also from a state that names the plane alone.
TEST_F(Degrees, StayTheSameInAnotherPlane) {
  const std::string rover = "[[bus.device]]\nunits = \"7\"\nprofile = \"rover\"\n";
  const Settings before = read("[site]\norigin = [\"10.4\", \"63.4\"]\n", rover);
  const Settings after = read("[site]\norigin = [\"10.41\", \"63.4\"]\nunit = \"0.1\"\n", rover);
  ASSERT_EQ(mistakes(), "");
  std::string why;
  const auto saved = site_plane_of(plane_of(before.site), projections_, why);
  ASSERT_TRUE(saved) << why;
  for (const Position there : {Position{0, 0}, Position{-1234, 777}, Position{5000, -4000}}) {
    const auto degrees = earth_point(before.site.plane(), to_point(there));
    const auto place = position_in(after.site.plane(), before.site.plane(), there);
    ASSERT_TRUE(degrees && place);
    EXPECT_EQ(place, nearest_position(after.site.plane(), *degrees));
    EXPECT_EQ(position_in(after.site.plane(), *saved, there), place);
    EXPECT_EQ(position_in(before.site.plane(), after.site.plane(), *place), there);
  }
  EXPECT_FALSE(site_plane_of(plane_of(before.site), nullptr, why));
  EXPECT_NE(why.find("without PROJ"), std::string::npos) << why;
}

// What the page of a gateway gives out.
class DegreesOnThePage : public RigTest, protected PageReader {
 protected:
  DegreesOnThePage() : PageReader(rig_) {}
  void start() {
    rig_.put_square();
    rig_.start();
    make_page();
    rig_.run(1s);
  }
};

TEST_F(DegreesOnThePage, AreThereBesideTheUnits) {
  std::string why;
  rig_.settings.site.projection =
      port::ProjSource().about({.longitude = 10 * site_nano, .latitude = 60 * site_nano}, why);
  start();
  const std::string geojson = get("/mesh.geojson");
  EXPECT_NE(geojson.find(R"("coordinates":[10,60]},"properties":{"x":0,"y":0,"kind":"node")"),
            std::string::npos)
      << geojson;
  EXPECT_EQ(geojson.find("[100,"), std::string::npos) << "edges in the plane";
  const std::string plane = get("/mesh.json");
  EXPECT_NE(plane.find(R"("coordinates":[0,0]},"properties":{"longitude":10,"latitude":60,)"),
            std::string::npos)
      << plane;
}

TEST(LengthText, HasThreeDigitsAndAUnitThatAPersonReads) {
  const std::pair<double, const char*> texts[] = {
      {0, "0 mm"},       {0.003, "3 mm"},   {0.0256, "25.6 mm"}, {0.5, "500 mm"},
      {1, "1 m"},        {1.5, "1.5 m"},    {12.34, "12.3 m"},   {100.4, "100 m"},
      {999.6, "1000 m"}, {1113, "1.11 km"}, {20000, "20 km"},    {40000000, "40000 km"}};
  for (const auto& [metres, wanted] : texts) {
    TextLine text;
    write_metres(text, metres);
    EXPECT_EQ(text.view(), wanted);
  }
}

TEST_F(DegreesOnThePage, AreInTheLog) {
  std::string why;
  rig_.settings.site.projection = port::ProjSource().about(
      {.longitude = -10 * site_nano - 5'000'000, .latitude = -60 * site_nano}, why);
  start();
  EXPECT_EQ(rig_.log.count("node 1001 joined at (0, 0), 60.000000° S, 10.005000° W: 1 node"), 1u)
      << testing::PrintToString(rig_.log.lines);
  rig_.put(1, 1113, 0);
  rig_.run(1s);
  EXPECT_EQ(rig_.log.count("node 1001 moved 1.11 km from (0, 0) to (1113, 0), 59.999998° S, "
                           "9.985054° W: "),
            1u)
      << testing::PrintToString(rig_.log.lines);
  rig_.put(5, 0, 100);
  rig_.run(1s);
  EXPECT_EQ(rig_.log.count("node 1005 cannot join at (0, 100), 59.999"), 1u)
      << testing::PrintToString(rig_.log.lines);
}

TEST_F(DegreesOnThePage, SayHowLongAUnitIs) {
  std::string why;
  rig_.settings.site.projection =
      port::ProjSource().about({.longitude = 10 * site_nano, .latitude = 60 * site_nano}, why);
  rig_.settings.site.unit_length = site_nano / 100;
  start();
  EXPECT_NE(get("/mesh.json").find(R"("metres_per_unit":0.01,)"), std::string::npos);
}

TEST_F(DegreesOnThePage, AreNotNeededToSayHowLongAUnitIs) {
  rig_.settings.site.metres = site_nano / 100;
  rig_.settings.site.unit_length = 5 * site_nano;
  start();
  EXPECT_NE(get("/mesh.json").find(R"("metres_per_unit":0.05,)"), std::string::npos);
  rig_.put(1, 20, 0);
  rig_.run(1s);
  EXPECT_EQ(rig_.log.count("node 1001 moved 1 m from (0, 0) to (20, 0): "), 1u)
      << testing::PrintToString(rig_.log.lines);
}

TEST_F(DegreesOnThePage, AreWrittenToFiles) {
  std::string why;
  rig_.settings.site.projection =
      port::ProjSource().about({.longitude = 10 * site_nano, .latitude = 60 * site_nano}, why);
  start();
  SnapshotImager imager(rig_.settings);
  const std::string text = files::geojson_text(
      *imager.make(rig_.gateway->snapshot(), rig_.gateway->readings(), rig_.settings.site.plane()));
  EXPECT_NE(text.find(R"("coordinates":[10,60]},"properties":{"kind":"node")"), std::string::npos)
      << text;
  EXPECT_NE(text.find(R"("x":100,"y":100)"), std::string::npos);
  EXPECT_EQ(text.find("planar"), std::string::npos);
}

TEST_F(DegreesOnThePage, OfASiteWithoutAreNowhere) {
  start();
  EXPECT_EQ(get("/mesh.geojson"), get("/mesh.json"));
  EXPECT_EQ(get("/mesh.json").find("longitude"), std::string::npos);
  EXPECT_EQ(get("/mesh.json").find("metres_per_unit"), std::string::npos);
  EXPECT_EQ(rig_.log.count("node 1001 joined at (0, 0): 1 node"), 1u);
}

// A projection of a few thousand kilometres; a node of ours may say that it is farther away.
TEST_F(DegreesOnThePage, WhatIsNowhereOnTheEarthHasNoGeometry) {
  std::string why;
  rig_.settings.site.projection = port::ProjSource().about({}, why);
  rig_.settings.site.unit_length = 1000 * site_nano;
  rig_.put(5, 16'000'000, 16'000'000);
  start();
  const std::string geojson = get("/mesh.geojson");
  EXPECT_NE(geojson.find(R"("geometry":null,"properties":{"x":16000000,"y":16000000)"),
            std::string::npos)
      << geojson;
  EXPECT_EQ(geojson.find("[[]"), std::string::npos) << geojson;
}

TEST_F(Degrees, ACrsOfAnotherPartOfTheEarthIsWarnedOf) {
  const auto warned = [&](const std::string& crs) {
    const Settings settings =
        draw("[10.4, 63.4], [10.41, 63.4]", "unit = 10\ncrs = \"" + crs + "\"\n");
    EXPECT_EQ(mistakes(), "");
    for (const std::string& warning : settings.warnings) {
      if (warning.find("is made for another part of the earth") != std::string::npos)
        return warning;
    }
    return std::string();
  };
  EXPECT_EQ(warned("EPSG:25832"), "");
  EXPECT_EQ(warned("EPSG:25833"), "");
  EXPECT_NE(warned("EPSG:25828").find("at longitude 10.4000, latitude 63.4000 are 1."),
            std::string::npos)
      << warned("EPSG:25828");
  EXPECT_NE(warned("EPSG:3857").find(" are 123."), std::string::npos)
      << "web Mercator: " << warned("EPSG:3857");
}

// New York, Long Island, in US survey feet.
TEST_F(Degrees, APlaneMayCountInFeet) {
  const Settings settings = draw("[-73.8, 40.7], [-73.79, 40.7]", "crs = \"EPSG:2263\"\n");
  ASSERT_EQ(mistakes(), "");
  for (const std::string& warning : settings.warnings) {
    EXPECT_EQ(warning.find("lengths at"), std::string::npos) << warning;
  }
}

TEST_F(Degrees, ASwappedOriginIsWarnedOf) {
  const Settings settings =
      draw("[10.4, 63.4], [10.41, 63.4]", "unit = 1000\norigin = [\"63.4\", \"10.4\"]\n");
  ASSERT_EQ(mistakes(), "");
  ASSERT_FALSE(settings.warnings.empty());
  EXPECT_NE(settings.warnings.back().find("are longitude and latitude swapped, here or in the "
                                          "origin of [site]?"),
            std::string::npos)
      << settings.warnings.back();
}

TEST_F(Degrees, ASurveyedPlaceOutsideTheDomainIsWarnedOf) {
  folder_.write("site.geojson",
                R"({"type": "FeatureCollection", "features": [{"type": "Feature",
"properties": {"kind": "domain"}, "geometry": {"type": "Polygon",
"coordinates": [[[10, 60], [10.01, 60], [10.01, 60.01], [10, 60.01], [10, 60]]]}}]})");
  const Settings settings =
      read("[site]\nfile = \"site.geojson\"\n",
           "[[node]]\nunit = 5\nlongitude = \"10.02\"\nlatitude = \"60.005\"\n"
           "[[node]]\nunit = 6\nlongitude = \"10.005\"\nlatitude = \"60.005\"\n");
  ASSERT_EQ(mistakes(), "");
  ASSERT_EQ(settings.warnings.size(), 1u);
  EXPECT_NE(settings.warnings[0].find("unit 5 of yard stands outside the domain of the site; are "
                                      "longitude and latitude swapped?"),
            std::string::npos)
      << settings.warnings[0];
}

TEST_F(Degrees, ADeviceOfWhichNobodySaysWhereItStandsIsWarnedOf) {
  const Settings settings = read("", "[[node]]\nunit = 5\nlongitude = \"10\"\nlatitude = \"60\"\n");
  ASSERT_EQ(mistakes(), "");
  ASSERT_EQ(settings.warnings.size(), 1u);
  EXPECT_NE(settings.warnings[0].find("unit 6 of yard does not tell where it stands"),
            std::string::npos)
      << settings.warnings[0];
}

TEST_F(Degrees, AReloadMovesWhatWasSurveyed) {
  const std::string node = "[[node]]\nunit = 5\nlongitude = \"10\"\nlatitude = \"60\"\n";
  Settings settings = read("[site]\norigin = [\"10\", \"60\"]\n", node);
  ASSERT_EQ(mistakes(), "");
  ASSERT_EQ(settings.nodes[0].position, (Position{0, 0}));
  folder_.write("site.toml", "[site]\norigin = [\"10.001\", \"60\"]\n" + std::string(rest) + node);
  RecordingLog log;
  std::string refusal;
  const auto next = reload(config_, settings, projections_, log, refusal);
  ASSERT_NE(next, nullptr);
  EXPECT_NEAR(next->nodes[0].position->x, -0.001 * parallel_degree(60), 1);
}

class DevicesInDegrees : public DeviceTest {
 protected:
  // What is wrong now.
  void look() {
    watch_.emplace(AlarmSources{.gateway = *rig_.gateway,
                                .masters = services_,
                                .readers = &services_,
                                .refusal = refusal_,
                                .started_at = started_at_});
    watch_->step(rig_.clock.now());
  }
  // "text -> cure"; empty: it is not on.
  std::string words_of(AlarmKey key) const {
    const AlarmBook& book = watch_->book();
    for (std::uint32_t i = 0; i < book.open_count(); ++i) {
      const Alarm& alarm = book.open(i);
      if (alarm.key != key || !alarm.is_on) continue;
      return std::string(alarm.text()) + " -> " + std::string(alarm.cure());
    }
    return "";
  }

  port::ProjSource proj_;
  const port::ServiceCounters services_{.is_listening = true};
  const std::string refusal_;
  const port::Instant started_at_ = rig_.clock.now();
  std::optional<AlarmWatch> watch_;
};

class PageOfDevicesInDegrees : public DevicesInDegrees, protected PageReader {
 protected:
  PageOfDevicesInDegrees() : PageReader(rig_) {}
};

// What its alarm says, and not that every node looks at the sky.
TEST_F(PageOfDevicesInDegrees, AFeatureThatWaitsForOneSaysWhyItTellsNoPosition) {
  bus_.put(7, 3, {1234});
  std::string text = R"(
[[profile]]
name = "meter"
[[profile.reading]]
name = "level"
value = { register = 3 }
)" + device_line + R"([[bus.device]]
units = "7"
profile = "meter"
[[feature]]
from = 1007
to = 1008
[site]
origin = ["8", "47"]
)";
  start(text.insert(text.find("vertices_max"), "features_max = 5\n"), &proj_);
  make_page();
  rig_.run(2s);
  const std::string told = get("/features.json");
  EXPECT_NE(
      told.find("node 1007, where it ends, has told no position yet: it has a profile without a "
                "position, and the settings do not say where it stands"),
      std::string::npos)
      << told;
  EXPECT_NE(told.find("\"cure\":\"give it a [[node]] with its bus"), std::string::npos) << told;
  EXPECT_EQ(told.find("sky"), std::string::npos) << told;
}

// A swapped place is one on the other side of the world, and as good as any.
TEST_F(DevicesInDegrees, ALetterOfTheOtherAxisIsNotBelievedAndSaysSo) {
  bus_.put(4, 0, {8, 'N', 47, 'E'});
  start(R"(
[[profile]]
name = "lettered"
longitude = { register = 0, negative_if = { register = 1, equals = "W" } }
latitude = { register = 2, negative_if = { register = 3, equals = "S" } }
)" + device_line +
            R"([[bus.device]]
units = "4"
profile = "lettered"
[site]
origin = ["8", "47"]
)",
        &proj_);
  rig_.run(1s);
  EXPECT_EQ(rig_.gateway->snapshot().node_count, 0u);
  const Poller& poller = rig_.gateway->poller();
  const UnitCounters& counters = poller.counters(poller.unit_at(BusIndex{0}, ModbusAddress{4}));
  EXPECT_EQ(counters.last_fault, UnitFault::unbelieved);
  EXPECT_EQ(explain_unbelieved(counters).view(),
            "has the letter N in its longitude, where only E and W belong: exchange the registers "
            "of 'longitude' and 'latitude' in the profile, or their letters");
  EXPECT_EQ(rig_.log.count("unit 4 of yard: has the letter N in its longitude"), 1u);
  rig_.run(5s);
  look();
  EXPECT_EQ(
      words_of({AlarmKind::faulty_unit, subject_of("yard", 4)}),
      "unit 4 of yard: has the letter N in its longitude, where only E and W belong -> "
      "exchange the registers of 'longitude' and 'latitude' in the profile, or their letters");
}

TEST_F(DevicesInDegrees, WithoutTheSerialOfItsProfileOneIsFaulty) {
  bus_.put(4, 0, {0xffff, 0xffff, 7});
  start(R"(
[[profile]]
name = "meter"
serial = { register = 0, type = "u32" }
[[profile.reading]]
name = "level"
value = { register = 2 }
)" + device_line +
        R"([[bus.device]]
units = "4"
profile = "meter"
)");
  rig_.run(1s);
  look();
  EXPECT_EQ(words_of({AlarmKind::faulty_unit, subject_of("yard", 4)}), "");
  rig_.run(5s);
  look();
  EXPECT_EQ(
      words_of({AlarmKind::faulty_unit, subject_of("yard", 4)}),
      "unit 4 of yard: no serial in the registers of `serial` -> correct its profile, or take "
      "`serial` out; one of letters is read as type = \"u32\"");
}

// A profile that tells a place in degrees, and one that measures.
const std::string rover_and_meter = R"(
[[profile]]
name = "rover"
longitude = { register = 0 }
latitude = { register = 1 }
[[profile]]
name = "meter"
[[profile.reading]]
name = "level"
value = { register = 3 }
)";

// The sky is good for one that has a position at times, and for no other.
TEST_F(DevicesInDegrees, ThatTellNoPositionSayWhy) {
  bus_.put(4, 0, {181, 47});
  bus_.put(5, 0, {0, 0});
  bus_.put(7, 3, {1234});
  start(rover_and_meter + device_line +
            R"([[bus.device]]
units = "4-5"
profile = "rover"
[[bus.device]]
units = "7"
profile = "meter"
[site]
origin = ["8", "47"]
)",
        &proj_);
  rig_.run(2s);
  look();
  const auto words = [this](std::uint32_t serial) { return words_of({AlarmKind::no_fix, serial}); };
  EXPECT_EQ(words(1004),
            "node 1004, unit 4 of yard, answers, and tells no position: it has a longitude beyond "
            "180 degrees -> correct 'register', 'type', 'order', 'scale' and 'format' of its "
            "coordinates in the profile (etcm-bus probe shows what each gives)");
  EXPECT_EQ(
      words(1005),
      "node 1005, unit 5 of yard, answers, and tells no position: it says that it is at 0, 0 "
      "degrees, as a device without a fix does, and one whose position is in other registers -> "
      "look at the sky above its antenna, and its cable; if it has a fix, correct 'register', "
      "'function' and 'counts_from' in its profile (etcm-bus probe shows what stands there)");
  EXPECT_EQ(words(1007),
            "node 1007, unit 7 of yard, answers, and tells no position: it has a profile without a "
            "position, and the settings do not say where it stands -> give it a [[node]] with its "
            "bus, its unit and x, y or longitude, latitude");
}

// Longitude and latitude exchanged are a place as good as any.
TEST_F(DevicesInDegrees, AReceiverFarFromWhatWasSurveyedIsToldAtOnceOfTwo) {
  bus_.put(4, 0, {63, 10});
  bus_.put(7, 3, {1234});
  start(rover_and_meter + device_line +
            R"([[bus.device]]
units = "4"
profile = "rover"
[[bus.device]]
units = "7"
profile = "meter"
[[node]]
unit = 7
longitude = "10"
latitude = "63"
)",
        &proj_);
  rig_.run(3s);
  look();
  EXPECT_EQ(rig_.gateway->snapshot().far_count, 1u);
  const std::string words = words_of({AlarmKind::far_node, 1004});
  EXPECT_TRUE(words.starts_with("node 1004, unit 4 of yard, stands 8")) << words;
  EXPECT_TRUE(words.ends_with(
      " km from where the site is by its settings -> correct 'order', 'scale' or 'format' in its "
      "profile, or exchange its longitude and latitude there (etcm-bus probe shows what each is); "
      "if it does stand there, acknowledge this"))
      << words;
  EXPECT_EQ(words_of({AlarmKind::far_node, 1007}), "");
  EXPECT_EQ(rig_.log.count("km from where the site is by its settings; correct 'order'"), 1u);
}

}  // namespace
}  // namespace etcm::firmware
