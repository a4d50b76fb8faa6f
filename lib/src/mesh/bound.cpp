#include "etcm/bound.h"

#include <utility>

#include "conforming/conform.h"
#include "conforming/feasible_parameter.h"
#include "etcm/split_site.h"
#include "geometry/predicates_inline.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

Position position_of(const MeshState& m, VertexId node) noexcept {
  return {static_cast<std::int32_t>(m.at(node).x / subunits_per_unit),
          static_cast<std::int32_t>(m.at(node).y / subunits_per_unit)};
}

// A vertex that goes along a segment from node to node. Its star is never made: what matters of it
// is the edge by which the way on leaves it.
class Traveller {
 public:
  // `missing` is no edge; its head is lexicographically before its tail.
  Traveller(const MeshState& m, const Subsegment& missing) noexcept
      : m_(m), to_(missing.tail), edge_(missing.head_edge), bound_(m.topology.triangle_count()) {
    site_.from = position_of(m, missing.head);
    site_.to = position_of(m, missing.tail);
  }

  // Goes as far as an edge from here can, rounded up. False: that is the other end.
  bool go_on() noexcept {
    site_.head_right = m_.at(m_.topology.origin(edge_));
    site_.head_left = m_.at(m_.topology.target(edge_));
    const Parameter reach = feasible_from_head(site_);
    if (reach >= parameter_end - 1) return false;
    site_.head = static_cast<Parameter>(reach + 1);
    return true;
  }

  // Finds the edge by which the way on leaves the star. False: the other end is a neighbour.
  bool look_ahead() noexcept {
    const Topology& topo = m_.topology;
    const Point here = site_.at(site_.head);
    for (;;) {
      const Edge beyond = topo.twin(edge_);
      const VertexId apex = topo.apex(beyond);
      const bool is_in_circle = incircle_fast(m_.at(topo.origin(beyond)),
                                              m_.at(topo.target(beyond)), m_.at(apex), here) > 0;
      // Where the vertex has gone past the triangle, its circle says nothing.
      const bool has_passed =
          orient2d_fast(m_.at(topo.origin(edge_)), m_.at(topo.target(edge_)), here) < 0;
      if (!is_in_circle && !has_passed) return true;
      if (apex == to_) return false;
      const int side = orient2d_fast(to_point(site_.from), to_point(site_.to), m_.at(apex));
      edge_ = side > 0 ? Topology::next(beyond) : Topology::prev(beyond);
      bound_.step();
    }
  }

 private:
  const MeshState& m_;
  const VertexId to_;
  Edge edge_;  // crossed by the way, from its right to its left
  SplitSite site_;
  StepBound bound_;
};

std::uint32_t least_between(const MeshState& m, const Subsegment& missing) noexcept {
  Traveller vertex(m, missing);
  std::uint32_t count = 0;
  while (vertex.go_on()) {
    ++count;
    if (!vertex.look_ahead()) break;
  }
  return count;
}

}  // namespace

std::uint32_t least_steiner(const Mesh& nodes, FeatureEnds feature) noexcept {
  const MeshState& m = opened(nodes, Call::least_steiner);
  demand(m.feature_count == 0, Call::least_steiner, Fault::has_features);
  demand(m.is_node(feature.from) && m.is_node(feature.to) && feature.from != feature.to,
         Call::least_steiner, Fault::no_vertex);
  VertexId v = feature.from, to = feature.to;
  if (m.at(to) < m.at(v)) std::swap(v, to);
  std::uint32_t count = 0;
  while (v != to) {
    const Subsegment subsegment = march(m, v, to);
    if (!subsegment.is_edge && !can_be_edge(m, subsegment)) count += least_between(m, subsegment);
    v = subsegment.tail;
  }
  return count;
}

}  // namespace ETCM_IDS
}  // namespace etcm
