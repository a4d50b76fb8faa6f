// A walk through what is no mesh any more, because others have written to its storage, ends in
// etcm_check_failed() after as many steps as there are triangles, vertices or sections: in every
// build, and never in a loop.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "etcm/analysis.h"
#include "etcm/incidence.h"
#include "etcm/locate.h"
#include "etcm/nearest.h"
#include "support/meshes.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"

extern "C" void etcm_check_failed(const char* what, const char*, int) {
  std::fprintf(stderr, "check failed: %s\n", what);
  std::_Exit(1);
}

namespace etcm::test {
namespace {

using internal::Edge;
using internal::MeshState;
using internal::SegmentId;
using internal::Topology;
using internal::TriangleRecord;

void set_link(MeshState& m, Edge e, Edge to) {
  TriangleRecord* const triangles = m.topology.triangle_memory();
  triangles[Topology::triangle_of(e)].link[Topology::side_of(e)] = to.value;
}

template <class Change>
void for_all_edges(MeshState& m, Change change) {
  for (IdValue t = 0; t < m.topology.triangle_count(); ++t) {
    for (unsigned side = 0; side < 3; ++side) change(Topology::edge(t, side));
  }
}

// Around v, the second edge is followed by itself: the first is never met again.
void spin(MeshState& m, VertexId v) {
  const Edge second = m.topology.rotate_ccw(m.topology.edge_at(v));
  set_link(m, Topology::prev(second), second);
}

// A triangle is left across its second edge into itself, over its first.
void fold(MeshState& m) {
  for_all_edges(m, [&m](Edge e) { set_link(m, Topology::next(e), e); });
}

struct Case {
  const char* name;
  std::function<void(MeshState&)> damage;
  std::function<void(const Mesh&)> question;
};

void PrintTo(const Case& each, std::ostream* out) { *out << each.name; }

std::unique_ptr<OwnedMesh> grid() {
  Graph graph{"", {}, {between_nodes(0, 15), between_nodes(5, 3)}};
  for (std::int32_t i = 0; i < 16; ++i) graph.nodes.push_back({i % 4 * 10 + i % 3, i / 4 * 10});
  return built(graph);
}

constexpr VertexId v{6};

const std::vector<Case> cases{
    {"neighbours", [](MeshState& m) { spin(m, v); },
     [](const Mesh& mesh) { static_cast<void>(mesh.neighbours(v, {})); }},
    {"neighbours_of_a_vertex_that_has_left", [](MeshState& m) { m.vertex_edges[v.value] = Edge{}; },
     [](const Mesh& mesh) { static_cast<void>(mesh.neighbours(v, {})); }},
    {"neighbours_of_a_vertex_in_another_place",
     [](MeshState& m) { m.vertex_edges[v.value] = Topology::next(m.vertex_edges[v.value]); },
     [](const Mesh& mesh) { static_cast<void>(mesh.neighbours(v, {})); }},
    {"finite_triangle_count", [](MeshState& m) { spin(m, infinite_vertex); },
     [](const Mesh& mesh) { static_cast<void>(mesh.finite_triangle_count()); }},
    {"links_at", [](MeshState& m) { spin(m, v); },
     [](const Mesh& mesh) { static_cast<void>(links_at(mesh, v, {})); }},
    {"locate", fold,
     [](const Mesh& mesh) {
       static_cast<void>(locate(mesh, to_point({1000, 1})));
     }},
    {"march",
     [](MeshState& m) { for_all_edges(m, [&m](Edge e) { set_link(m, e, Topology::prev(e)); }); },
     [](const Mesh& mesh) { internal::march(state_of(mesh), VertexId{1}, VertexId{12}); }},
    {"chain", [](MeshState& m) { m.segment(SegmentId{0}).next = SegmentId{0}; },
     [](const Mesh& mesh) { static_cast<void>(mesh.chain(FeatureId{0}, {})); }},
    {"barrier_gaps", [](MeshState& m) { m.segment(SegmentId{0}).next = SegmentId{0}; },
     [](const Mesh& mesh) { static_cast<void>(barrier_gaps(mesh, mesh, 1, {})); }},
    {"relays", [](MeshState& m) { m.segment(SegmentId{0}).next_at_from = SegmentId{0}; },
     [](const Mesh& mesh) { static_cast<void>(relays(mesh, **empty_mesh(), 1, {})); }},
    {"nearest_nodes", [](MeshState& m) { spin(m, v); },
     [](const Mesh& mesh) {
       std::vector<NearNode> nodes(mesh.node_count());
       static_cast<void>(nearest_nodes(mesh, to_point({1, 1}), nodes));
     }},
    {"features_at", [](MeshState& m) { m.segment(SegmentId{0}).next_at_from = SegmentId{0}; },
     [](const Mesh& mesh) { static_cast<void>(features_at(mesh, VertexId{1}, {})); }},
    {"coverage_holes", [](MeshState& m) { spin(m, v); },
     [](const Mesh& mesh) {
       const std::vector<Region> region(mesh.triangle_count(), Region::inside);
       static_cast<void>(coverage_holes(mesh, {.mesh = &mesh, .region = region}, 1, {}));
     }},
};

std::string name_of(const testing::TestParamInfo<Case>& info) { return info.param.name; }

class LostWalk : public testing::TestWithParam<Case> {};

TEST_P(LostWalk, Ends) {
  const auto mesh = grid();
  GetParam().question(**mesh);
  GetParam().damage(state_of(**mesh));
  EXPECT_EXIT(GetParam().question(**mesh), testing::ExitedWithCode(1),
              "check failed: a walk through the mesh ends");
}

TEST(LostWalkOnALine, Ends) {
  const auto mesh = built({"", {{0, 0}, {10, 0}, {20, 0}}, {}});
  EXPECT_EQ(locate(**mesh, to_point({30, 0})).type, LocateType::outside);
  for_all_edges(state_of(**mesh),
                [&](Edge e) { set_link(state_of(**mesh), Topology::next(e), Topology::prev(e)); });
  EXPECT_EXIT(static_cast<void>(locate(**mesh, to_point({30, 0}))), testing::ExitedWithCode(1),
              "check failed: a walk through the mesh ends");
}

INSTANTIATE_TEST_SUITE_P(Every, LostWalk, testing::ValuesIn(cases), name_of);

}  // namespace
}  // namespace etcm::test
