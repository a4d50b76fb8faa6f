// Whom a place has an influence on: whom the vertex has that comes to stand there.
#include "conforming/influence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <type_traits>

#include "inputs/random.h"
#include "inputs/random_graph.h"
#include "support/meshes.h"
#include "triangulation/change.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::test {
namespace {

using internal::Change;
using internal::MeshState;
using internal::SegmentId;

// Of the last search, which has no other way to be told of.
std::set<IdValue> found_segments;

void note(Change&, SegmentId found, SegmentId) noexcept { found_segments.insert(found.value); }

// Whom it has an influence on; false: not all of them could be found.
template <class Where>
bool influenced(Mesh& mesh, const Where& where, std::set<IdValue>& out) {
  MeshState& m = state_of(mesh);
  const KeepAlive nobody;
  m.work.start(Work::unlimited(), nobody);
  Change change(m);
  found_segments.clear();
  bool is_known = false;
  if constexpr (std::is_same_v<Where, Point>) {
    is_known = find_influenced(change, where, note);
  } else {
    is_known = find_influenced(change, where, SegmentId::none(), note);
  }
  out = found_segments;
  return is_known;
}

std::set<Point> steiner_points(const Mesh& mesh) {
  std::set<Point> points;
  for (const VertexId v : steiner_vertices(mesh)) points.insert(mesh.point(v));
  return points;
}

TEST(Influence, OfAPlaceIsThatOfAVertexThere) {
  std::uint64_t compared = 0, told = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto length =
        seed % 2 == 0 ? inputs::FeatureLength::any : inputs::FeatureLength::in_reach;
    const Graph graph = inputs::random_graph(80, length, seed);
    inputs::Random random(seed);
    for (int i = 0; i < 40; ++i) {
      const auto before = built(graph), after = built(graph);
      const Position place{random.between(-50, 1050), random.between(-50, 1050)};
      VertexId v;
      if ((*after)->join(place, v) != Status::ok) continue;
      // Where it has broken something, others stand around it than before.
      if (steiner_points(**after) != steiner_points(**before)) continue;
      std::set<IdValue> of_place, of_vertex;
      const bool is_place_known = influenced(**before, to_point(place), of_place);
      const bool is_vertex_known = influenced(**after, v, of_vertex);
      if (!is_place_known || !is_vertex_known) continue;
      EXPECT_EQ(of_place, of_vertex)
          << "seed " << seed << ", {" << place.x << ", " << place.y << "}";
      ++compared;
      told += of_vertex.size();
    }
  }
  EXPECT_GT(compared, 100u);
  EXPECT_GT(told, compared / 2);
}

// Whose Steiner vertices have one on a subsegment; false: not all of them could be found.
bool influencing(Mesh& mesh, internal::Edge e, std::set<IdValue>& out) {
  MeshState& m = state_of(mesh);
  const KeepAlive nobody;
  m.work.start(Work::unlimited(), nobody);
  Change change(m);
  found_segments.clear();
  const bool is_known = find_influencing(change, e, SegmentId::none(), note);
  out = found_segments;
  return is_known;
}

TEST(Influence, OnASubsegmentIsLookedForOnBothSides) {
  using internal::Topology;
  const auto mesh = built(inputs::random_graph(80, inputs::FeatureLength::any, 3));
  const Topology& topo = state_of(**mesh).topology;
  std::uint64_t compared = 0;
  for (IdValue i = 0; i < 3 * topo.triangle_count(); ++i) {
    const internal::Edge e = Topology::edge(i / 3, i % 3);
    if (!topo.is_constrained(e)) continue;
    std::set<IdValue> from_here, from_beyond;
    if (!influencing(**mesh, e, from_here)) continue;
    ASSERT_TRUE(influencing(**mesh, topo.twin(e), from_beyond));
    EXPECT_EQ(from_here, from_beyond) << "edge " << i;
    ++compared;
  }
  EXPECT_GT(compared, 50u);
}

// How far it is from a place to a part of a line.
double distance(double x, double y, const Point& a, const Point& b) {
  const auto ax = static_cast<double>(a.x), ay = static_cast<double>(a.y);
  const double dx = static_cast<double>(b.x) - ax, dy = static_cast<double>(b.y) - ay;
  const double along = std::clamp(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(x - ax - along * dx, y - ay - along * dy);
}

// The segments of which the circle of a triangle comes to some subsegment, a little more or less
// near.
std::set<IdValue> touched_by(const MeshState& m, IdValue triangle, double nearness) {
  const auto& t = m.topology.triangle(triangle);
  const Point origin = m.at(t.corner[0]);
  const auto x = [&](int i) { return static_cast<double>(m.at(t.corner[i]).x - origin.x); };
  const auto y = [&](int i) { return static_cast<double>(m.at(t.corner[i]).y - origin.y); };
  const double doubled = 2 * (x(1) * y(2) - y(1) * x(2));
  const double one = x(1) * x(1) + y(1) * y(1), two = x(2) * x(2) + y(2) * y(2);
  const double cx = (y(2) * one - y(1) * two) / doubled, cy = (x(1) * two - x(2) * one) / doubled;
  std::set<IdValue> touched;
  for (IdValue i = 0; i < 3 * m.topology.triangle_count(); ++i) {
    const internal::Edge e = internal::Topology::edge(i / 3, i % 3);
    if (!m.topology.is_constrained(e)) continue;
    const VertexId u = m.topology.origin(e), v = m.topology.target(e);
    const double far = distance(static_cast<double>(origin.x) + cx,
                                static_cast<double>(origin.y) + cy, m.at(u), m.at(v));
    if (far <= nearness * std::hypot(cx, cy)) touched.insert(segment_of_edge(m, u, v).value);
  }
  return touched;
}

TEST(Influence, OfAVertexIsOnWhatTheCirclesAroundItTouch) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto length =
        seed % 2 == 0 ? inputs::FeatureLength::any : inputs::FeatureLength::in_reach;
    const auto mesh = built(inputs::random_graph(60, length, seed));
    const MeshState& m = state_of(**mesh);
    for (IdValue i = 1; i < m.vertex_end; ++i) {
      const VertexId v{i};
      std::set<IdValue> found, least, most;
      if (!m.is_vertex(v) || !influenced(**mesh, v, found)) continue;
      internal::Spokes spokes(m.topology, v);
      do {
        const VertexId w = spokes.target();
        if (w != infinite_vertex && !m.is_node(w)) {
          least.insert(m.owner(w).segment().value);
        }
        const IdValue t = internal::Topology::triangle_of(spokes.edge());
        if (m.topology.is_ghost(t)) continue;
        least.merge(touched_by(m, t, 0.999));
        most.merge(touched_by(m, t, 1.001));
      } while (spokes.turn());
      most.insert(least.begin(), least.end());
      // What ends at it, or what it stands on, is known without a look around.
      std::erase_if(least, [&](IdValue s) {
        const auto& r = m.segment(SegmentId{s});
        return r.from == v || r.to == v || (!m.is_node(v) && m.owner(v).segment().value == s);
      });
      EXPECT_TRUE(std::includes(found.begin(), found.end(), least.begin(), least.end()))
          << "seed " << seed << ", vertex " << i;
      EXPECT_TRUE(std::includes(most.begin(), most.end(), found.begin(), found.end()))
          << "seed " << seed << ", vertex " << i;
    }
  }
}

}  // namespace
}  // namespace etcm::test
