// What a policy is told of the surroundings of a split, against a look at all of the mesh.
#include "etcm/surroundings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "etcm/policy.h"
#include "inputs/patterns.h"
#include "inputs/random_graph.h"
#include "support/exact.h"
#include "support/meshes.h"
#include "triangulation/mesh_state.h"

namespace etcm::test {
namespace {

using internal::Edge;
using internal::MeshState;
using internal::Topology;

struct Tally {
  std::uint64_t places = 0;
  std::uint64_t broken = 0;           // by a look at all
  std::uint64_t broken_at_least = 0;  // by those that are watched
  std::uint64_t wrong = 0;
  std::uint64_t too_many_watched = 0;
};

bool holds(const MeshState& m, IdValue triangle, const Point& p) {
  const auto& t = m.topology.triangle(triangle);
  return exact_incircle(m.at(t.corner[0]), m.at(t.corner[1]), m.at(t.corner[2]), p) > 0;
}

unsigned broken_by(const MeshState& m, const Point& p) {
  const Topology& topo = m.topology;
  unsigned count = 0;
  for (IdValue t = 0; t < topo.triangle_count(); ++t) {
    if (topo.is_ghost(t)) continue;
    for (unsigned side = 0; side < 3; ++side) {
      const Edge e = Topology::edge(t, side);
      const IdValue other = Topology::triangle_of(topo.twin(e));
      if (t < other && topo.is_constrained(e) && !topo.is_ghost(other)) {
        count += holds(m, t, p) && holds(m, other, p);
      }
    }
  }
  return count;
}

Parameter looks_around(const SplitSite& site) noexcept {
  Tally& tally = *static_cast<Tally*>(site.context);
  const MeshState& m = state_of(*site.mesh);
  Surroundings around(site);
  Surroundings::Beside beside;
  for (const auto end : {Surroundings::End::head, Surroundings::End::tail}) {
    around.start(end);
    while (around.next(beside)) {
    }
  }
  constexpr Parameter parts = 9;
  if (site.tail - site.head <= parts) return split_default(site);
  for (Parameter part = 1; part < parts; ++part) {
    const Parameter t = site.head + (site.tail - site.head) / parts * part;
    const unsigned at_least = around.encroachments_at_least(t);
    const unsigned all = broken_by(m, site.at(t));
    ++tally.places;
    tally.broken += all;
    tally.broken_at_least += at_least;
    tally.wrong += around.encroachments(t, 1000) != all;
    tally.too_many_watched += at_least > all;
  }
  return split_default(site);
}

// Of all places that a policy is asked about.
Tally tally_of(const Graph& graph) {
  MeshConfig config = inputs::config_for(graph, 2000);
  Tally tally;
  config.policy = looks_around;
  config.policy_context = &tally;
  OwnedMesh mesh(config);
  EXPECT_EQ(mesh->build(graph.nodes, graph.features), Status::ok);
  return tally;
}

TEST(Surroundings, TellWhatAVertexWouldBreak) {
  for (const Graph& graph : {inputs::random_graph(250, inputs::FeatureLength::any, 3),
                             inputs::parallels(12, 6, 300, 30, 1)}) {
    const Tally tally = tally_of(graph);
    EXPECT_GT(tally.broken, 100u) << graph.name;
    EXPECT_EQ(tally.wrong, 0u) << "of " << tally.places;
    EXPECT_EQ(tally.too_many_watched, 0u) << "of " << tally.places;
    EXPECT_GT(tally.broken_at_least, tally.broken / 2) << "hardly any is watched";
  }
}

// A row of triangles across a ring that is nearly round: a place at its end is in the circle of
// each, one behind the other.
TEST(Surroundings, TellItAcrossAlmostAsManyTrianglesAsAreLookedAt) {
  constexpr int count = 42;
  constexpr double radius = 1'000'000, flatness = 0.995;
  Graph graph{.name = "ring",
              .nodes = {{-1'200'000, 0}, {1'200'000, 0}},
              .features = {{VertexId{1}, VertexId{2}}}};
  for (int i = 0; i < count; ++i) {
    const double angle = (i + 0.5) * 2 * std::numbers::pi / count;
    graph.nodes.push_back(
        {static_cast<std::int32_t>(std::lround(radius * std::cos(angle))),
         static_cast<std::int32_t>(std::lround(flatness * radius * std::sin(angle)))});
  }
  const Tally tally = tally_of(graph);
  EXPECT_GT(tally.places, 0u);
  EXPECT_EQ(tally.wrong, 0u) << "of " << tally.places;
}

}  // namespace
}  // namespace etcm::test
