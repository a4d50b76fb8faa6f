// audit() is what nearly all other tests trust: here a sound mesh is broken in one way after the
// other, and each time it names the rule, and the place.
#include "etcm/audit.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "support/meshes.h"
#include "triangulation/mesh_state.h"

namespace etcm::test {
namespace {

using internal::Edge;
using internal::MeshState;
using internal::Owner;
using internal::Role;
using internal::Topology;

// A ring of eight nodes, one in the middle, four on a circle beside it that a tie decides on, and a
// feature across that needs Steiner vertices.
std::unique_ptr<OwnedMesh> sound_mesh() {
  const Graph graph{"",
                    {{0, 0},
                     {100, -20},
                     {200, 0},
                     {220, 100},
                     {200, 200},
                     {100, 220},
                     {0, 200},
                     {-20, 100},
                     {90, 110},
                     {150, 50},
                     {160, 50},
                     {160, 60},
                     {150, 60}},
                    {between_nodes(0, 4), between_nodes(9, 10)}};
  return built(graph);
}

Point& place(MeshState& m, std::size_t node) { return m.points[vertex_of(node).value]; }

Edge edge_between(const MeshState& m, std::size_t from, std::size_t to) {
  Edge e;
  EXPECT_TRUE(m.topology.find_edge(vertex_of(from), vertex_of(to), e));
  return e;
}

IdValue& link_of(MeshState& m, Edge e) {
  return m.topology.triangle_memory()[Topology::triangle_of(e)].link[Topology::side_of(e)];
}

VertexId any_steiner(const MeshState& m) {
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    if (m.owners[i].role() == Role::steiner) return VertexId{i};
  }
  ADD_FAILURE() << "there is no Steiner vertex";
  return {};
}

// The tie among the last four is decided the other way.
void turn_tie(MeshState& m) {
  Edge e;
  const bool is_first = m.topology.find_edge(vertex_of(9), vertex_of(11), e);
  m.topology.flip(is_first ? e : edge_between(m, 10, 12));
}

struct Case {
  const char* name;
  Rule rule;
  std::function<void(MeshState&)> damage;
};

void PrintTo(const Case& each, std::ostream* out) { *out << each.name; }

const Case cases[]{
    {"a_node_too_many", Rule::counts, [](MeshState& m) { ++m.node_count; }},
    {"a_Steiner_vertex_too_few", Rule::counts, [](MeshState& m) { --m.steiner_count; }},
    {"a_vertex_that_is_alone", Rule::counts, [](MeshState& m) { m.only_vertex = VertexId{1}; }},
    {"a_link_out_of_the_mesh", Rule::links,
     [](MeshState& m) {
       link_of(m, edge_between(m, 0, 1)) = Topology::edge(m.topology.triangle_count(), 0).value;
     }},
    {"a_link_to_no_side", Rule::links,
     [](MeshState& m) { link_of(m, edge_between(m, 0, 1)) |= 3; }},
    {"a_link_that_does_not_lead_back", Rule::links,
     [](MeshState& m) {
       const Edge e = edge_between(m, 0, 1);
       link_of(m, e) = link_of(m, Topology::next(e));
     }},
    {"a_mark_on_one_side", Rule::links,
     [](MeshState& m) {
       const Edge e = edge_between(m, 0, 1);
       const IdValue unmarked = link_of(m, e);
       m.topology.mark(e);
       link_of(m, e) = unmarked;
     }},
    {"a_corner_of_another_vertex", Rule::links,
     [](MeshState& m) {
       const Edge e = edge_between(m, 0, 1);
       m.topology.triangle_memory()[Topology::triangle_of(e)].corner[0] = vertex_of(12);
     }},
    {"a_vertex_with_an_edge_of_another", Rule::incidence,
     [](MeshState& m) { m.vertex_edges[vertex_of(8).value] = edge_between(m, 0, 1); }},
    {"a_vertex_with_an_edge_out_of_the_mesh", Rule::incidence,
     [](MeshState& m) {
       m.vertex_edges[vertex_of(8).value] = Topology::edge(m.topology.triangle_count(), 0);
     }},
    {"a_vertex_with_an_edge_of_no_side", Rule::incidence,
     [](MeshState& m) { m.vertex_edges[vertex_of(8).value].value |= 3; }},
    {"a_vertex_beyond_its_triangles", Rule::orientation,
     [](MeshState& m) {
       place(m, 8) = to_point({400, 400});
     }},
    {"a_flat_triangle", Rule::orientation, [](MeshState& m) { place(m, 10) = place(m, 9); }},
    {"a_dent_in_the_hull", Rule::hull,
     [](MeshState& m) {
       place(m, 1) = to_point({100, 2});
     }},
    {"an_edge_that_is_not_Delaunay", Rule::delaunay,
     [](MeshState& m) {
       place(m, 8) = to_point({70, 170});
     }},
    {"a_tie_the_other_way", Rule::canonical, turn_tie},
    {"a_Steiner_vertex_beside_its_feature", Rule::on_feature,
     [](MeshState& m) { ++m.points[any_steiner(m).value].x; }},
    {"a_Steiner_vertex_of_no_feature", Rule::on_feature,
     [](MeshState& m) {
       m.owner(any_steiner(m)) = Owner(Role::steiner, internal::SegmentId{m.segment_end});
     }},
    {"a_feature_without_its_mark", Rule::conforming,
     [](MeshState& m) { m.topology.unmark(edge_between(m, 9, 10)); }},
    {"a_mark_of_no_feature", Rule::conforming,
     [](MeshState& m) { m.topology.mark(edge_between(m, 0, 1)); }},
    {"more_that_is_no_edge_than_is_counted", Rule::conforming,
     [](MeshState& m) {
       for (IdValue t = 0; t < m.topology.triangle_count(); ++t) {
         for (const unsigned side : {0U, 1U, 2U}) {
           const Edge e = Topology::edge(t, side);
           if (m.topology.is_constrained(e)) m.topology.unmark(e);
         }
       }
       m.unresolved = 1;
     }},
};

std::string name_of(const testing::TestParamInfo<Case>& info) { return info.param.name; }

class BrokenMesh : public testing::TestWithParam<Case> {};

TEST_P(BrokenMesh, IsFoundByItsRule) {
  const auto mesh = sound_mesh();
  ASSERT_TRUE(audit(**mesh));
  GetParam().damage(state_of(**mesh));
  EXPECT_EQ(to_string(audit(**mesh).broken), std::string(to_string(GetParam().rule)));
}

INSTANTIATE_TEST_SUITE_P(Audit, BrokenMesh, testing::ValuesIn(cases), name_of);

TEST(Audit, SaysWhichVertexAndWhichFeature) {
  const auto mesh = sound_mesh();
  MeshState& m = state_of(**mesh);
  const VertexId moved = any_steiner(m);
  ++m.points[moved.value].x;
  const Audit found = audit(**mesh);
  EXPECT_EQ(found.vertex, moved);
  EXPECT_EQ(found.feature, FeatureId{0});
}

// Two nodes make triangles without an inside, of which only the hull can be wrong.
TEST(Audit, OfALineKnowsATurn) {
  const auto mesh = built({"", {{0, 0}, {10, 0}, {20, 0}}, {}});
  ASSERT_TRUE(audit(**mesh));
  place(state_of(**mesh), 1) = to_point({30, 0});
  EXPECT_EQ(audit(**mesh).broken, Rule::hull);
}

TEST(Audit, HasAWordForEachRule) {
  EXPECT_EQ(to_string(Rule::none), std::string("none"));
  EXPECT_EQ(to_string(Rule{99}), std::string("unknown"));
}

}  // namespace
}  // namespace etcm::test
