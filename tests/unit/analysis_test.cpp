// etcm/analysis.h on meshes small enough to be seen: what the answers mean, and what short lists
// get. That the answers are right for any mesh is shown in tests/property.
#include "etcm/analysis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <limits>
#include <memory>
#include <vector>

#include "inputs/random.h"
#include "inputs/random_graph.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

std::unique_ptr<OwnedMesh> mesh_of(std::initializer_list<Position> nodes,
                                   std::initializer_list<FeatureEnds> features = {}) {
  return built({"", nodes, features});
}

Connectivity connectivity_of(const Mesh& mesh, std::uint32_t range) {
  std::vector<ConnectivityScratch> scratch(mesh.vertex_id_end());
  Connectivity result;
  EXPECT_EQ(connectivity(mesh, range, scratch, result), Status::ok);
  return result;
}

SquaredLength units_squared(std::uint32_t units) {
  return squared_distance({0, 0}, {units * subunits_per_unit, 0});
}

constexpr std::int32_t far = position_max;

TEST(Lengths, AreExactAtTheLimits) {
  const Point one = to_point({-far, -far}), other = to_point({far, far});
  // Twice the square of 2^25 units: 2^51 * 2^56.
  EXPECT_EQ(squared_distance(one, other), (SquaredLength{std::uint64_t{1} << 43, 0}));
  EXPECT_EQ(range_for(squared_distance(one, other)), 47453133u);
  EXPECT_EQ(range_for({}), 0u);
  EXPECT_EQ(range_for({0, 1}), 1u);
  EXPECT_EQ(range_for(units_squared(5)), 5u);
  EXPECT_EQ(range_for(squared_distance({0, 0}, {5 * subunits_per_unit, 1})), 6u);
}

TEST(Analysis, HasNothingToSayAboutAnEmptyMesh) {
  const auto mesh = empty_mesh();
  EXPECT_EQ(links(**mesh, 0, {}), 0u);
  EXPECT_EQ(relays(**mesh, **mesh, 1, {}), 0u);
  EXPECT_EQ(barrier_gaps(**mesh, **mesh, 1, {}), 0u);
  EXPECT_EQ(coverage_holes(**mesh, {}, 1, {}), 0u);
  const Connectivity found = connectivity_of(**mesh, 1);
  EXPECT_EQ(found.parts, 0u);
  EXPECT_EQ(found.least, SquaredLength{});
  Interpolated reading{LocateType::on_vertex, 7};
  const std::array<std::int32_t, 1> readings{5};
  EXPECT_EQ(interpolate(**mesh, {0, 0}, readings, reading), Status::ok);
  EXPECT_EQ(reading.type, LocateType::outside);
  EXPECT_EQ(reading.value, 0);
}

TEST(Analysis, OfASingleNode) {
  const auto mesh = mesh_of({{far, -far}});
  EXPECT_EQ(links(**mesh, 0, {}), 0u);
  EXPECT_EQ(links_at(**mesh, vertex_of(0), {}), 0u);
  EXPECT_EQ(coverage_holes(**mesh, {}, 1, {}), 0u);
  EXPECT_EQ(connectivity_of(**mesh, 1).parts, 1u);
  Interpolated reading;
  const std::array<std::int32_t, 2> readings{0, -3};
  EXPECT_EQ(interpolate(**mesh, to_point({far, -far}), readings, reading), Status::ok);
  EXPECT_EQ(reading.type, LocateType::on_vertex);
  EXPECT_EQ(reading.value, -3 * subunits_per_unit);
}

TEST(Analysis, OfNodesOnALine) {
  const auto mesh = mesh_of({{0, 0}, {10, 10}, {40, 40}}, {between_nodes(0, 2)});
  std::array<Link, 2> link;
  ASSERT_EQ(links(**mesh, 0, link), 2u);
  for (const Link& each : link) EXPECT_TRUE(each.gabriel && each.urquhart && each.constrained);
  EXPECT_EQ(links(**mesh, 15, {}), 1u);
  const Connectivity found = connectivity_of(**mesh, 42);
  EXPECT_EQ(range_for(found.least), 43u);
  EXPECT_EQ(found.parts, 2u);
  std::array<Hole, 2> hole;
  ASSERT_EQ(coverage_holes(**mesh, {}, 21, hole), 1u);
  EXPECT_EQ(hole[0].position, to_point({25, 25}));
  EXPECT_TRUE(hole[0].on_boundary);
  EXPECT_EQ(coverage_holes(**mesh, {}, 22, hole), 0u);
  std::array<Gap, 1> gap;
  ASSERT_EQ(barrier_gaps(**mesh, **mesh, 21, gap), 1u);
  EXPECT_EQ(gap[0].from, vertex_of(1));
  EXPECT_EQ(gap[0].to, vertex_of(2));
  EXPECT_FALSE(gap[0].watched);
  Interpolated reading;
  const std::array<std::int32_t, 4> readings{0, 100, 200, -100};
  EXPECT_EQ(interpolate(**mesh, to_point({30, 30}), readings, reading), Status::ok);
  EXPECT_EQ(reading.type, LocateType::on_edge);
  EXPECT_EQ(reading.value, 0);
  EXPECT_EQ(interpolate(**mesh, to_point({30, 31}), readings, reading), Status::ok);
  EXPECT_EQ(reading.type, LocateType::outside);
}

// The domain is a mesh of 0, 1 or 2 vertices, or of more on a line: then it is what the sensors
// span. Each mesh is as it was built, or what is left of a larger one.
TEST(Analysis, OfADomainWithoutATriangleIsThatOfTheHull) {
  const std::vector<Position> line{{5, 5}, {65, 65}, {25, 25}, {45, 45}};
  const auto sensors = mesh_of({{0, 0}, {60, 0}, {0, 60}});
  const auto one_sensor = mesh_of({{1, 2}});
  const std::uint32_t in_hull = coverage_holes(**sensors, {}, 20, {});
  EXPECT_GT(in_hull, 0u);
  for (std::size_t count = 0; count <= line.size(); ++count) {
    const auto left = built({"", square, {}});
    std::vector<VertexId> ids;
    for (std::size_t i = 0; i < square.size(); ++i) ids.push_back(vertex_of(i));
    for (std::size_t i = 0; i < count; ++i) {
      VertexId id;
      ASSERT_EQ((*left)->join(line[i], id), Status::ok);
      if (i % 2 == 0) continue;
      // Some take the place of one that has left.
      ASSERT_EQ((*left)->leave(ids.back()), Status::ok);
      ids.pop_back();
    }
    for (const VertexId id : ids) ASSERT_EQ((*left)->leave(id), Status::ok);
    const auto fresh = built({"", {line.begin(), line.begin() + static_cast<int>(count)}, {}});
    for (const Mesh* mesh : {&**left, &**fresh}) {
      std::vector<Region> region(mesh->triangle_count());
      std::vector<TriangleId> scratch(region.size());
      for (const Exterior exterior : {Exterior::hull, Exterior::features, Exterior::automatic}) {
        ASSERT_EQ(label_domain(*mesh, exterior, {}, region, scratch), Status::ok);
        const Domain domain{.mesh = mesh, .region = region};
        EXPECT_EQ(coverage_holes(**sensors, domain, 20, {}), in_hull) << count;
        EXPECT_EQ(coverage_holes(**one_sensor, domain, 1, {}), 0u) << count;
        EXPECT_EQ(coverage_holes(*mesh, domain, 13, {}), coverage_holes(*mesh, {}, 13, {}));
      }
    }
  }
}

TEST(Analysis, OfAMeshThatAllLeaveAndOneComesBackTo) {
  const auto mesh = built({"", square, {}});
  for (int round = 0; round < 3; ++round) {
    for (IdValue value = 1; value < (*mesh)->vertex_id_end(); ++value) {
      if ((*mesh)->kind(VertexId{value}) == VertexKind::none) continue;
      ASSERT_EQ((*mesh)->leave(VertexId{value}), Status::ok);
    }
    EXPECT_EQ(coverage_holes(**mesh, {.mesh = &**mesh}, 1, {}), 0u);
    VertexId id;
    ASSERT_EQ((*mesh)->join({round, 7}, id), Status::ok);
    EXPECT_EQ(coverage_holes(**mesh, {.mesh = &**mesh}, 1, {}), 0u);
    EXPECT_EQ(links(**mesh, 0, {}), 0u);
    EXPECT_EQ(links_at(**mesh, id, {}), 0u);
    EXPECT_EQ(relays(**mesh, **mesh, 1, {}), 0u);
    EXPECT_EQ(barrier_gaps(**mesh, **mesh, 1, {}), 0u);
    EXPECT_EQ(connectivity_of(**mesh, 1).parts, 1u);
    EXPECT_EQ(locate(**mesh, to_point({round, 7})).vertex, id);
    ASSERT_EQ((*mesh)->join({round, 30}, id), Status::ok);
    EXPECT_EQ(coverage_holes(**mesh, {}, 11, {}), 1u);
  }
}

TEST(Links, OfASquareDoNotDependOnItsDiagonal) {
  const auto mesh = mesh_of({{0, 0}, {10, 0}, {10, 10}, {0, 10}});
  std::array<Link, 5> link;
  ASSERT_EQ(links(**mesh, 0, link), 5u);
  for (const Link& each : link) {
    const bool is_side =
        squared_distance((*mesh)->point(each.from), (*mesh)->point(each.to)) == units_squared(10);
    EXPECT_EQ(each.gabriel, is_side);
    EXPECT_EQ(each.urquhart, is_side);
  }
  EXPECT_EQ(links(**mesh, 10, link), 1u);
}

TEST(Links, AreAllKeptWhereSidesAreEquallyLong) {
  const auto mesh = mesh_of({{0, 0}, {6, 0}, {3, 7}});
  std::array<Link, 3> link;
  ASSERT_EQ(links(**mesh, 0, link), 3u);
  // The two long sides are equal: neither is the longest.
  for (const Link& each : link) EXPECT_TRUE(each.urquhart);
}

TEST(Links, OfAVertexStandInTheOrderOfItsNeighbours) {
  const auto mesh = mesh_of({{0, 0}, {10, 0}, {0, 10}, {3, 3}}, {between_nodes(0, 3)});
  for (IdValue value = 1; value < (*mesh)->vertex_id_end(); ++value) {
    const VertexId vertex{value};
    std::array<Neighbour, 3> around;
    std::array<Link, 3> link;
    ASSERT_EQ((*mesh)->neighbours(vertex, around), 3u);
    ASSERT_EQ(links_at(**mesh, vertex, link), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(link[i].from, vertex);
      EXPECT_EQ(link[i].to, around[i].vertex);
      EXPECT_EQ(link[i].constrained, around[i].constrained);
    }
    // A list that is too short gets what fits.
    std::array<Link, 2> part{};
    EXPECT_EQ(links_at(**mesh, vertex, std::span(part).first(1)), 3u);
    EXPECT_EQ(part[0].to, link[0].to);
    EXPECT_TRUE(part[1].to.is_none());
  }
}

// The nodes' shortest way across is not in the conforming mesh: there Steiner vertices are nearer.
TEST(Connectivity, IsOfTheVerticesItIsGiven) {
  const std::initializer_list<Position> nodes = {{-1000, 0}, {1000, 0}, {0, 90}, {0, -90}};
  const auto conforming = mesh_of(nodes, {between_nodes(0, 1)});
  ASSERT_GT((*conforming)->steiner_count(), 0u);
  const Connectivity alone = connectivity_of(**mesh_of(nodes), 500);
  EXPECT_EQ(range_for(alone.least), 1005u);
  EXPECT_EQ(alone.parts, 3u);
  EXPECT_EQ(range_for(connectivity_of(**conforming, 500).least), 1000u);
}

TEST(Connectivity, NeedsItsScratch) {
  const auto mesh = mesh_of({{0, 0}, {1, 0}, {0, 1}});
  std::array<ConnectivityScratch, 3> scratch;
  Connectivity out{.least = {}, .from = {}, .to = {}, .parts = 77};
  EXPECT_EQ(connectivity(**mesh, 1, scratch, out), Status::buffer_too_small);
  EXPECT_EQ(out.parts, 77u);
}

TEST(Relays, StandEvenlyOnALongPiece) {
  const auto mesh = mesh_of({{0, 0}, {100, 0}, {50, 400}}, {between_nodes(0, 1)});
  EXPECT_EQ(relays(**mesh, **mesh, 100, {}), 0u);
  std::array<Relay, 3> relay;
  ASSERT_EQ(relays(**mesh, **mesh, 25, relay), 3u);
  EXPECT_EQ(relay[0].position, to_point({25, 0}));
  EXPECT_EQ(relay[2].position, to_point({75, 0}));
  EXPECT_TRUE(relay[1].vertex.is_none());
  EXPECT_EQ(relay[1].feature, FeatureId{0});
  EXPECT_EQ(relays(**mesh, **mesh, 24, relay), 4u);
}

TEST(Relays, AreCountedWithoutBeingVisited) {
  const auto mesh = mesh_of({{-far, -far}, {far, far}}, {between_nodes(0, 1)});
  std::array<Relay, 2> relay;
  EXPECT_EQ(relays(**mesh, **mesh, 1, relay), 47453132u);
  EXPECT_LT(relay[0].position, relay[1].position);
  EXPECT_EQ(relays(**mesh, **mesh, 0xffffffffu, relay), 0u);
}

// Four of them would stand a unit apart, but not on sub-units.
TEST(Relays, LeaveNoHopThatRoundingMakesLongerThanTheRange) {
  for (const Position end :
       {Position{3, 4}, Position{-3, 4}, Position{-4, -3}, Position{20, -21}}) {
    const auto mesh = mesh_of({{0, 0}, end}, {between_nodes(0, 1)});
    std::array<Relay, 30> relay;
    const std::uint64_t count = relays(**mesh, **mesh, 1, relay);
    EXPECT_EQ(count, end.x == 20 ? 29u : 5u);
    std::vector<Point> stops{{0, 0}, to_point(end)};
    for (std::size_t i = 0; i < count; ++i) stops.push_back(relay[i].position);
    std::sort(stops.begin(), stops.end());
    for (std::size_t i = 1; i < stops.size(); ++i) {
      EXPECT_LE(squared_distance(stops[i - 1], stops[i]), units_squared(1)) << end.x << ", " << i;
    }
  }
  const auto on_units = mesh_of({{0, 0}, {6, 8}}, {between_nodes(0, 1)});
  EXPECT_EQ(relays(**on_units, **on_units, 5, {}), 1u);
}

TEST(Relays, AreProposedAtEachVertexWithoutADevice) {
  const auto mesh = mesh_of({{-1000, 0}, {1000, 0}, {0, 90}, {0, -90}, {0, 900}},
                            {between_nodes(0, 1), between_nodes(1, 2)});
  ASSERT_EQ((*mesh)->steiner_count(), 1u);
  const auto devices = mesh_of({{-1000, 0}, {0, -90}, {0, 90}});
  std::array<Relay, 3> relay;
  ASSERT_EQ(relays(**mesh, **devices, 2000, relay), 3u);
  EXPECT_EQ(relay[0].position, to_point({1000, 0}));
  EXPECT_EQ(relay[0].vertex, vertex_of(1));
  EXPECT_EQ(relay[0].feature, FeatureId{0}) << "of two features";
  EXPECT_EQ(relay[1].position, to_point({0, 900}));
  EXPECT_TRUE(relay[1].feature.is_none());
  EXPECT_EQ((*mesh)->kind(relay[2].vertex), VertexKind::steiner);
  EXPECT_EQ(relay[2].feature, FeatureId{0});
  EXPECT_EQ(relays(**mesh, **empty_mesh(), 2000, {}), 6u);
}

TEST(Gaps, AtAnEndWithoutASensorAreWhatIsBeyondOneRange) {
  const auto mesh = mesh_of({{0, 0}, {100, 0}, {50, 400}}, {between_nodes(0, 1)});
  const auto one = mesh_of({{100, 0}, {50, 400}});
  EXPECT_EQ(barrier_gaps(**mesh, **one, 100, {}), 0u);
  std::array<Gap, 1> gap;
  ASSERT_EQ(barrier_gaps(**mesh, **one, 99, gap), 1u);
  EXPECT_EQ(gap[0].from, vertex_of(0));
  EXPECT_EQ(gap[0].to, vertex_of(1));
  EXPECT_FALSE(gap[0].watched);
}

TEST(Gaps, WithoutASensorOnTheFeatureAreAllOfIt) {
  // A node without a sensor cuts nothing.
  const auto mesh = mesh_of({{0, 0}, {40, 0}, {20, 0}, {20, 30}}, {between_nodes(0, 1)});
  const auto beside = mesh_of({{20, 15}});
  std::array<Gap, 2> gap;
  ASSERT_EQ(barrier_gaps(**mesh, **beside, 25, gap), 1u);
  EXPECT_EQ(gap[0].from, vertex_of(0));
  EXPECT_EQ(gap[0].to, vertex_of(1));
  EXPECT_TRUE(gap[0].watched) << "the ends are just 25 from the sensor";
  ASSERT_EQ(barrier_gaps(**mesh, **beside, 24, gap), 1u);
  EXPECT_FALSE(gap[0].watched);
  ASSERT_EQ(barrier_gaps(**mesh, **empty_mesh(), 1000, gap), 1u);
  EXPECT_FALSE(gap[0].watched);
}

TEST(Gaps, MayBeWatchedFromBeside) {
  // Sensors beside the middle of a feature: its ends are far apart, yet all of it is in sight.
  const auto mesh = mesh_of({{0, 0}, {40, 0}, {20, 4}, {20, -4}}, {between_nodes(0, 1)});
  const auto nodes = mesh_of({{0, 0}, {40, 0}, {20, 4}, {20, -4}});
  std::array<Gap, 1> gap;
  ASSERT_EQ(barrier_gaps(**mesh, **nodes, 11, gap), 1u);
  EXPECT_TRUE(gap[0].watched);
  ASSERT_EQ(barrier_gaps(**mesh, **nodes, 10, gap), 1u);
  EXPECT_FALSE(gap[0].watched);
  EXPECT_EQ(barrier_gaps(**mesh, **nodes, 20, gap), 0u);
}

TEST(Holes, AreAtTheCentreOfAnAcuteTriangle) {
  const auto mesh = mesh_of({{0, 0}, {8, 0}, {4, 8}});
  std::array<Hole, 4> hole;
  // Its circumradius is 5, and the longest sides, sqrt(80), are covered at 5.
  EXPECT_EQ(coverage_holes(**mesh, {}, 5, hole), 0u);
  ASSERT_EQ(coverage_holes(**mesh, {}, 4, hole), 3u);
  EXPECT_EQ(hole[0].position, to_point({4, 3}));
  EXPECT_FALSE(hole[0].on_boundary);
  EXPECT_TRUE(hole[1].on_boundary && hole[2].on_boundary);
}

TEST(Holes, OfAnObtuseTriangleAreOnItsLongestSide) {
  // The circumradius is 10100, but the middle corner sees most of the long side: its bisectors with
  // the others meet that side 1010 from each.
  const auto mesh = mesh_of({{-2000, 0}, {2000, 0}, {0, 200}});
  std::array<Hole, 2> hole;
  EXPECT_EQ(coverage_holes(**mesh, {}, 1010, hole), 0u);
  ASSERT_EQ(coverage_holes(**mesh, {}, 1009, hole), 2u);
  for (const Hole& each : hole) {
    EXPECT_TRUE(each.on_boundary);
    EXPECT_EQ(std::abs(each.position.x), 990 * subunits_per_unit);
    EXPECT_EQ(each.position.y, 0);
  }
}

TEST(Holes, OfASquareAreOneInItsMidst) {
  const auto mesh = mesh_of({{0, 0}, {10, 0}, {10, 10}, {0, 10}});
  std::array<Hole, 2> hole;
  ASSERT_EQ(coverage_holes(**mesh, {}, 7, hole), 1u);
  EXPECT_EQ(hole[0].position, to_point({5, 5}));
  EXPECT_EQ(coverage_holes(**mesh, {}, 8, hole), 0u);
}

TEST(Holes, OutsideTheDomainDoNotCount) {
  // A square field beside a far node: the way there is not in the domain.
  const auto mesh =
      mesh_of({{0, 0}, {10, 0}, {10, 10}, {0, 10}, {1000, 5}},
              {between_nodes(0, 1), between_nodes(1, 2), between_nodes(2, 3), between_nodes(3, 0)});
  std::vector<Region> region((*mesh)->triangle_count());
  std::vector<TriangleId> scratch(region.size());
  ASSERT_EQ(label_domain(**mesh, Exterior::features, {}, region, scratch), Status::ok);
  EXPECT_EQ(coverage_holes(**mesh, {.mesh = &**mesh, .region = region}, 8, {}), 0u);
  EXPECT_EQ(coverage_holes(**mesh, {.mesh = &**mesh, .region = region}, 7, {}), 1u);
  EXPECT_GT(coverage_holes(**mesh, {}, 8, {}), 0u);
}

// The domain above y = 0 from -3 to 20, below a height.
std::uint32_t holes_above_a_line(const Mesh& sensors, std::uint32_t range, std::span<Hole> out) {
  const auto mesh =
      mesh_of({{-3, 0}, {20, 0}, {20, 9}, {-3, 9}},
              {between_nodes(0, 1), between_nodes(1, 2), between_nodes(2, 3), between_nodes(3, 0)});
  std::vector<Region> region((*mesh)->triangle_count());
  std::vector<TriangleId> scratch(region.size());
  EXPECT_EQ(label_domain(**mesh, Exterior::hull, {}, region, scratch), Status::ok);
  return coverage_holes(sensors, {.mesh = &**mesh, .region = region}, range, out);
}

bool lists(std::span<const Hole> holes, Position place) {
  return std::any_of(holes.begin(), holes.end(),
                     [&](const Hole& hole) { return hole.position == to_point(place); });
}

// The second sensor is nearest from its own foot on, so the distance rises before it and behind it.
TEST(Holes, AreNotWhereTheDistanceGoesOnToRise) {
  const auto sensors = mesh_of({{-3, 4}, {0, 5}});
  std::array<Hole, 8> hole;
  const std::uint32_t count = holes_above_a_line(**sensors, 4, hole);
  ASSERT_LE(count, hole.size());
  EXPECT_FALSE(lists(std::span(hole).first(count), {0, 0}));
  EXPECT_TRUE(lists(std::span(hole).first(count), {20, 0}));
}

// Three sensors are equally near to the place, and it is the foot of the middle one.
TEST(Holes, AreWhereTheMiddleOfThreeHandsOverAtItsFoot) {
  const auto sensors = mesh_of({{-3, 4}, {0, 5}, {3, 4}});
  std::array<Hole, 8> hole;
  const std::uint32_t count = holes_above_a_line(**sensors, 4, hole);
  ASSERT_LE(count, hole.size());
  EXPECT_TRUE(lists(std::span(hole).first(count), {0, 0}));
}

// A field of 100 by 100, its corners without sensors, and the hole in it that four more enclose.
class Field : public testing::Test {
 protected:
  void SetUp() override {
    mesh = mesh_of(
        {{0, 0}, {100, 0}, {100, 100}, {0, 100}, {40, 40}, {60, 40}, {60, 60}, {40, 60}},
        {between_nodes(0, 1), between_nodes(1, 2), between_nodes(2, 3), between_nodes(3, 0),
         between_nodes(4, 5), between_nodes(5, 6), between_nodes(6, 7), between_nodes(7, 4)});
    region.resize((*mesh)->triangle_count());
    std::vector<TriangleId> scratch(region.size());
    const Point seed = to_point({50, 50});
    ASSERT_EQ(label_domain(**mesh, Exterior::features, std::span(&seed, 1), region, scratch),
              Status::ok);
  }
  std::uint32_t holes(const Mesh& sensors, std::uint32_t range, std::span<Hole> out) const {
    return coverage_holes(sensors, {.mesh = &**mesh, .region = region}, range, out);
  }
  std::unique_ptr<OwnedMesh> mesh;
  std::vector<Region> region;
};

// A node with no feature is a place in a region as any other.
TEST(HoleSeeds, OnANodeCountUnlessItIsOnAFeature) {
  const auto mesh =
      mesh_of({{0, 0}, {100, 0}, {100, 100}, {0, 100}, {30, 50}, {0, 300}, {300, 0}},
              {between_nodes(0, 1), between_nodes(1, 2), between_nodes(2, 3), between_nodes(3, 0)});
  std::vector<Region> region((*mesh)->triangle_count());
  std::vector<TriangleId> scratch(region.size());
  const auto holes_from = [&](Position seed) {
    const Point at = to_point(seed);
    EXPECT_EQ(label_domain(**mesh, Exterior::hull, std::span(&at, 1), region, scratch), Status::ok);
    return std::count(region.begin(), region.end(), Region::hole);
  };
  EXPECT_EQ(holes_from({30, 50}), 4);
  EXPECT_EQ(holes_from({50, 50}), 4);
  EXPECT_EQ(holes_from({100, 100}), 0);
  EXPECT_EQ(holes_from({50, 0}), 0);
  const auto outside = (*mesh)->finite_triangle_count() - 4;
  EXPECT_EQ(holes_from({0, 300}), outside) << "on the hull";
}

// Of a mesh that fills its range, so that a point beyond is beside a vertex.
TEST(Places, TooFarOutForAMeshAreOutside) {
  const auto mesh = mesh_of({{-far, -far}, {far, -far}, {far, far}, {-far, far}, {0, 0}});
  std::vector<Region> region((*mesh)->triangle_count());
  std::vector<TriangleId> scratch(region.size());
  const std::vector<std::int32_t> readings((*mesh)->vertex_id_end(), 5);
  constexpr std::int64_t most = far * subunits_per_unit;
  EXPECT_EQ(locate(**mesh, {most, most}).type, LocateType::on_vertex);
  EXPECT_EQ(locate(**mesh, {most, 1}).type, LocateType::on_edge);
  for (const std::int64_t coordinate :
       {most + 1, -most - 1, 4 * most, std::numeric_limits<std::int64_t>::max(),
        std::numeric_limits<std::int64_t>::min()}) {
    for (const Point place : {Point{coordinate, 0}, Point{0, coordinate}}) {
      const Location at = locate(**mesh, place);
      EXPECT_EQ(at.type, LocateType::outside);
      EXPECT_TRUE(at.triangle.is_none());
      Interpolated reading{LocateType::on_vertex, 7};
      EXPECT_EQ(interpolate(**mesh, place, readings, reading), Status::ok);
      EXPECT_EQ(reading.type, LocateType::outside);
      EXPECT_EQ(label_domain(**mesh, Exterior::hull, std::span(&place, 1), region, scratch),
                Status::ok);
      EXPECT_EQ(std::count(region.begin(), region.end(), Region::hole), 0);
    }
  }
}

TEST(Places, AreFoundTheSameFromAnyTriangleAndFromNone) {
  const Graph graph = inputs::random_graph(60, inputs::FeatureLength::in_reach, 3);
  const auto mesh = built(graph);
  const std::uint32_t count = (*mesh)->triangle_count();
  inputs::Random random(7);
  for (int i = 0; i < 40; ++i) {
    const Position node = graph.nodes[static_cast<std::size_t>(random.below(60))];
    const Point at = i % 4 == 0
                         ? to_point(node)
                         : Point{to_point(node).x + random.between(-99, 99) * subunits_per_unit,
                                 to_point(node).y + i};
    const Location found = locate(**mesh, at);
    for (const IdValue near :
         {IdValue{0}, static_cast<IdValue>(count / 2), static_cast<IdValue>(count - 1),
          static_cast<IdValue>(count), static_cast<IdValue>(count + 1), TriangleId::none_value}) {
      const Location again = locate(**mesh, at, TriangleId{near});
      EXPECT_EQ(again.type, found.type) << near;
      EXPECT_EQ(again.vertex, found.vertex) << near;
      if (found.type == LocateType::inside_triangle) {
        EXPECT_EQ(again.triangle, found.triangle) << near;
      }
    }
  }
}

TEST(HoleSeeds, OnNodesOfALineLabelNothing) {
  const auto mesh = mesh_of({{0, 0}, {1, 1}, {2, 2}});
  std::vector<Region> region((*mesh)->triangle_count());
  std::vector<TriangleId> scratch(region.size());
  for (const Position position : {Position{0, 0}, Position{1, 1}}) {
    const Point seed = to_point(position);
    ASSERT_EQ(label_domain(**mesh, Exterior::hull, std::span(&seed, 1), region, scratch),
              Status::ok);
    EXPECT_EQ(std::count(region.begin(), region.end(), Region::outside), std::ssize(region));
  }
}

TEST_F(Field, HasItsWorstPlacesAtCornersWithoutSensors) {
  const auto sensors = mesh_of({{50, 30}});
  std::array<Hole, 8> hole;
  EXPECT_EQ(holes(**sensors, 87, hole), 0u);
  // The upper corners are 86.02 away, the lower ones 58.3.
  ASSERT_EQ(holes(**sensors, 86, hole), 2u);
  for (const Hole& each : std::span(hole).first(2)) {
    EXPECT_TRUE(each.on_boundary);
    EXPECT_EQ(each.position.y, 100 * subunits_per_unit);
    EXPECT_EQ(each.sensor, to_point({50, 30}));
  }
  EXPECT_EQ(holes(**sensors, 58, hole), 4u);
  // The far corners of the hole are 31.6 away.
  EXPECT_EQ(holes(**sensors, 31, hole), 6u);
}

TEST_F(Field, IsSeenBySensorsOutsideOfIt) {
  const auto sensors = mesh_of({{50, -10}, {50, 110}});
  std::array<Hole, 4> hole;
  EXPECT_EQ(holes(**sensors, 79, hole), 0u);
  // Where the two take turns on the sides: 50 across and 60 along.
  ASSERT_EQ(holes(**sensors, 78, hole), 2u);
  for (const Hole& each : std::span(hole).first(2)) {
    EXPECT_EQ(each.position.y, 50 * subunits_per_unit);
    EXPECT_TRUE(each.on_boundary);
  }
}

TEST_F(Field, LeavesTheHoleOut) {
  const std::initializer_list<Position> around = {{40, 40}, {60, 40}, {60, 60}, {40, 60}};
  const auto sensors = mesh_of(around);
  const auto lists_the_middle = [&] {
    std::array<Hole, 20> hole;
    const std::uint32_t count = holes(**sensors, 14, hole);
    const auto listed = std::span(hole).first(std::min<std::size_t>(count, hole.size()));
    return std::any_of(listed.begin(), listed.end(), [](const Hole& each) {
      return each.position == to_point({50, 50});
    });
  };
  EXPECT_FALSE(lists_the_middle());
  std::fill(region.begin(), region.end(), Region::inside);
  EXPECT_TRUE(lists_the_middle());
}

TEST_F(Field, HasNoWorstPlaceWithoutSensors) { EXPECT_EQ(holes(**empty_mesh(), 1, {}), 0u); }

TEST(Holes, AreFoundAtTheLimitsOfTheCoordinates) {
  const auto mesh = mesh_of({{-far, -far}, {far, -far}, {far, far}, {-far, far}});
  std::array<Hole, 1> hole;
  // Half the diagonal is 23726566.4 units.
  ASSERT_EQ(coverage_holes(**mesh, {}, 23726566, hole), 1u);
  EXPECT_EQ(hole[0].position, (Point{0, 0}));
  EXPECT_EQ(coverage_holes(**mesh, {}, 23726567, hole), 0u);
  EXPECT_EQ(coverage_holes(**mesh, {}, 0xffffffffu, hole), 0u);
}

TEST(Readings, AreLinearInTheTriangle) {
  const auto mesh = mesh_of({{0, 0}, {10, 0}, {0, 10}});
  const std::array<std::int32_t, 4> readings{0, 0, 100, 1000};
  Interpolated reading;
  ASSERT_EQ(interpolate(**mesh, to_point({2, 3}), readings, reading), Status::ok);
  EXPECT_EQ(reading.type, LocateType::inside_triangle);
  EXPECT_EQ(reading.value, 320 * subunits_per_unit);
  EXPECT_EQ(interpolate(**mesh, to_point({2, 3}), std::span(readings).first(3), reading),
            Status::buffer_too_small);
}

TEST(Readings, OfTheGreatestNumbersDoNotOverflow) {
  const auto mesh = mesh_of({{-far, -far}, {far, -far}, {-far, far}});
  constexpr std::int32_t low = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t high = std::numeric_limits<std::int32_t>::max();
  const std::array<std::int32_t, 4> readings{0, low, high, high};
  Interpolated reading;
  ASSERT_EQ(interpolate(**mesh, to_point({0, 0}), readings, reading), Status::ok);
  EXPECT_EQ(reading.value, high * subunits_per_unit);
  ASSERT_EQ(interpolate(**mesh, to_point({-far, 0}), readings, reading), Status::ok);
  EXPECT_EQ(reading.value, -subunits_per_unit / 2);
}

}  // namespace
}  // namespace etcm::test
