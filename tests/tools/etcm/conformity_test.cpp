#include "conformity.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <ostream>

#include "etcm/files/mesh_text.h"
#include "inputs/owned_mesh.h"
#include "support/scratch_folder.h"

namespace etcm::cli {
namespace {

using ::testing::HasSubstr;

// A plate 0-4 with a hole 5-8, and a feature 9-11 that needs a Steiner vertex.
const char* const plate =
    "12 2 0 0\n0 0 0\n1 200 0\n2 260 90\n3 200 160\n4 0 160\n5 60 60\n6 120 50\n7 130 100\n"
    "8 70 110\n9 20 80\n10 190 80\n11 100 140\n10 0\n0 0 1\n1 1 2\n2 2 3\n3 3 4\n4 4 0\n5 5 6\n"
    "6 6 7\n7 7 8\n8 8 5\n9 9 11\n1\n0 100 80\n";

struct Case {
  files::ConstraintGraph graph;
  files::GridGraph grid;
  files::MeshImage image;

  std::string violation() const { return first_violation({graph, grid, image}).value_or(""); }
};

Case meshed(const std::string& poly, Exterior exterior = Exterior::automatic) {
  const test::ScratchFolder folder;
  Case result;
  result.graph = files::read_graph(folder.write("case.poly", poly));
  result.grid = files::place_on_grid(result.graph, {});
  inputs::OwnedMesh mesh({.vertices_max = 2000, .features_max = 2000});
  EXPECT_EQ(mesh->build(result.grid.nodes, result.grid.features), Status::ok);
  result.image = files::image_of(*mesh, exterior, result.grid.holes);
  files::carry_through(result.graph, {}, result.image);
  return result;
}

TEST(Conformity, AcceptsWhatTheLibraryMakes) {
  EXPECT_EQ(meshed(plate).violation(), "");
  EXPECT_EQ(meshed(plate, Exterior::hull).violation(), "");
  EXPECT_EQ(meshed(plate, Exterior::features).violation(), "");
  // A grid with all its ties, and nodes on a line.
  std::string grid = "49 2\n";
  for (int i = 0; i < 49; ++i) {
    grid +=
        std::to_string(i + 1) + " " + std::to_string(i % 7) + " " + std::to_string(i / 7) + "\n";
  }
  EXPECT_EQ(meshed(grid + "2 0\n1 1 49\n2 7 43\n0\n").violation(), "");
  EXPECT_EQ(meshed("4 2\n1 0 0\n2 6 3\n3 2 1\n4 4 2\n1 0\n1 1 2\n0\n").violation(), "");
}

struct Damage {
  const char* name;
  std::function<void(Case&)> spoil;
  const char* message;
};
void PrintTo(const Damage& damage, std::ostream* out) { *out << damage.name; }

// Replaces the two triangles at an edge inside a strictly convex quadrilateral by the other two.
void flip(Case& c) {
  auto& triangles = c.image.triangles;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t j = 0; j < triangles.size(); ++j) {
      for (std::size_t s = 0; s < 9; ++s) {
        const std::uint32_t a = triangles[i][s % 3];
        const std::uint32_t b = triangles[i][(s + 1) % 3];
        const std::uint32_t left = triangles[i][(s + 2) % 3];
        const std::uint32_t right = triangles[j][(s / 3 + 2) % 3];
        const auto edge = files::find_edge(c.image, a, b);
        if (triangles[j][s / 3] != b || triangles[j][(s / 3 + 1) % 3] != a) continue;
        if (c.image.edges[edge].is_constrained) continue;
        const auto turn = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
          const auto at = [&](std::uint32_t v) { return c.image.vertices[v].point; };
          return static_cast<double>(at(q).x - at(p).x) * static_cast<double>(at(r).y - at(p).y) -
                 static_cast<double>(at(q).y - at(p).y) * static_cast<double>(at(r).x - at(p).x);
        };
        if (turn(right, b, left) <= 0 || turn(left, a, right) <= 0) continue;
        triangles[i] = {right, b, left};
        triangles[j] = {left, a, right};
        c.image.edges[edge].from = std::min(left, right);
        c.image.edges[edge].to = std::max(left, right);
        std::sort(c.image.edges.begin(), c.image.edges.end(), [](const auto& x, const auto& y) {
          return std::pair(x.from, x.to) < std::pair(y.from, y.to);
        });
        return;
      }
    }
  }
  ADD_FAILURE() << "nothing to flip";
}

void drop_edge(Case& c, std::size_t index) {
  c.image.edges.erase(c.image.edges.begin() + static_cast<std::ptrdiff_t>(index));
}

// Takes a triangle away, and those of its edges that no other has.
void drop_triangle(Case& c, std::size_t index) {
  const auto gone = c.image.triangles[index];
  c.image.triangles.erase(c.image.triangles.begin() + static_cast<std::ptrdiff_t>(index));
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t a = gone[i];
    const std::uint32_t b = gone[(i + 1) % 3];
    const bool is_used =
        std::any_of(c.image.triangles.begin(), c.image.triangles.end(), [&](const auto& corner) {
          return std::count(corner.begin(), corner.end(), a) +
                     std::count(corner.begin(), corner.end(), b) ==
                 2;
        });
    const std::size_t edge = files::find_edge(c.image, a, b);
    if (!is_used && !c.image.edges[edge].is_constrained) drop_edge(c, edge);
  }
}

class ConformityDamage : public ::testing::TestWithParam<Damage> {};

TEST_P(ConformityDamage, IsFound) {
  Case c = meshed(plate);
  ASSERT_EQ(c.violation(), "");
  GetParam().spoil(c);
  EXPECT_THAT(c.violation(), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    EveryRule, ConformityDamage,
    ::testing::Values(
        Damage{"NodeMovedByOneSubunit", [](Case& c) { ++c.image.vertices[3].point.x; },
               "vertex 3 stands at 200.0000000037252902984619140625 160, but the input node"},
        Damage{"NodesMissing", [](Case& c) { c.image.vertices.resize(5); },
               "the mesh has 5 vertices, the input 12"},
        Damage{"OtherBase", [](Case& c) { c.image.index_base = 1; }, "the mesh counts from 1"},
        Damage{"SteinerOffByOneSubunit", [](Case& c) { ++c.image.vertices.back().point.y; },
               "feature 9 (9-11) breaks off at vertex 9"},
        Damage{"SteinerOnNothing",
               [](Case& c) {
                 c.image.vertices.push_back({{5, 5}, true, -1});
               },
               "the added vertex 13 lies on no feature"},
        Damage{"TwoAtOnePlace", [](Case& c) { c.image.vertices.push_back(c.image.vertices[2]); },
               "vertex 2 and vertex 13 stand at the same place"},
        Damage{"FeatureCutShort", [](Case& c) { c.image.subsegments.pop_back(); },
               "feature 9 (9-11) breaks off at vertex 12"},
        Damage{"SubsegmentTwice",
               [](Case& c) { c.image.subsegments.push_back(c.image.subsegments[0]); },
               "subsegment edge 0-1 is there twice"},
        Damage{"SubsegmentOfNothing",
               [](Case& c) {
                 const auto& corner = c.image.triangles[0];
                 for (std::size_t i = 0; i < 3; ++i) {
                   const auto a = corner[i];
                   const auto b = corner[(i + 1) % 3];
                   auto& edge = c.image.edges[files::find_edge(c.image, a, b)];
                   if (edge.is_constrained) continue;
                   edge.is_constrained = true;
                   c.image.subsegments.push_back({a, b, 0, 0, true});
                   return;
                 }
               },
               "lies on no feature"},
        Damage{"SubsegmentIsNoEdge", [](Case& c) { c.image.subsegments[0].is_edge = false; },
               "subsegment edge 0-1 is no edge"},
        Damage{"EdgeMissing", [](Case& c) { drop_edge(c, 0); }, "is missing from the list"},
        Damage{"EdgeOfNothing",
               [](Case& c) {
                 c.image.edges.push_back({11, 12, false, 0});
                 drop_edge(c, 0);
                 c.image.edges.insert(c.image.edges.begin(), {0, 2, false, 0});
               },
               "belongs to no triangle"},
        Damage{
            "EdgeNotMarked",
            [](Case& c) { c.image.edges[files::find_edge(c.image, 0, 1)].is_constrained = false; },
            "edge 0-1 is part of a feature, but not marked"},
        Damage{"EdgeMarked",
               [](Case& c) {
                 for (auto& edge : c.image.edges) edge.is_constrained = true;
               },
               "is marked as part of a feature, but is none"},
        Damage{"Clockwise",
               [](Case& c) { std::swap(c.image.triangles[4][1], c.image.triangles[4][2]); },
               "is clockwise"},
        Damage{"TriangleTwice", [](Case& c) { c.image.triangles.push_back(c.image.triangles[0]); },
               "has two triangles on one side"},
        Damage{"NotDelaunay", [](Case& c) { flip(c); }, "is inside the circumcircle of triangle"},
        Damage{"TriangleMissing",
               [](Case& c) {
                 for (std::size_t i = 0; i < c.image.triangles.size(); ++i) {
                   const auto& corner = c.image.triangles[i];
                   if (std::count(corner.begin(), corner.end(), 10u) == 0) continue;
                   return drop_triangle(c, i);
                 }
               },
               "is neither on the hull nor part of a feature"},
        Damage{"HoleUnknownToTheInput", [](Case& c) { c.grid.holes.clear(); },
               "is enclosed by triangles, but the input has no hole there"},
        Damage{"HoleElsewhere",
               [](Case& c) {
                 c.grid.holes = {to_point({150, 140})};
               },
               "hole 1 of the input is covered"}),
    [](const auto& row) { return row.param.name; });

TEST(Conformity, FindsAHoleThatWasFilled) {
  Case c = meshed(plate);
  std::string filled = plate;
  filled.replace(filled.rfind("1\n0 100 80"), std::string::npos, "0\n");
  Case full = meshed(filled);
  EXPECT_EQ(full.violation(), "");
  full.grid.holes = c.grid.holes;
  EXPECT_THAT(full.violation(), HasSubstr("hole 1 of the input is covered"));
}

TEST(Conformity, FindsCocircularTrianglesThatOverlap) {
  // The square's two triangles, one of them cut along the other diagonal.
  Case c = meshed("4 2\n1 0 0\n2 2 0\n3 2 2\n4 0 2\n0\n0\n");
  ASSERT_EQ(c.violation(), "");
  c.image.triangles = {{0, 1, 2}, {0, 1, 3}};
  c.image.edges = {
      {0, 1, false, 0}, {0, 2, false, 0}, {0, 3, false, 0}, {1, 2, false, 0}, {1, 3, false, 0}};
  EXPECT_THAT(c.violation(), HasSubstr("has two triangles on one side"));
  c.image.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 2, 3}};
  c.image.edges.push_back({2, 3, false, 0});
  EXPECT_NE(c.violation(), "");
}

TEST(Conformity, FindsAMeshWithoutTriangles) {
  Case c = meshed("4 2\n1 0 0\n2 2 0\n3 2 2\n4 0 2\n0\n0\n");
  c.image.triangles.clear();
  c.image.edges.clear();
  EXPECT_EQ(c.violation(), "the mesh has no triangles");
}

}  // namespace
}  // namespace etcm::cli
