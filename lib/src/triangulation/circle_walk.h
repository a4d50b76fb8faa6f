// The vertices around a place: the nearest, and all within a circle.
#pragma once

#include <limits>

#include "etcm/nearest.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"

namespace etcm::internal {

// Any vertex, a Steiner vertex too, and how far it stands from a place.
using NearVertex = NearNode;

// The order of vertices seen from a place. Strict: no two stand at one point.
inline bool is_nearer(const MeshState& m, const NearVertex& a, const NearVertex& b) noexcept {
  return a.distance != b.distance ? a.distance < b.distance : m.at(a.node) < m.at(b.node);
}

// The first vertex in that order; none in an empty mesh. The cost of locate(), and the way along
// the hull where the place is outside.
NearVertex nearest_vertex(const MeshState& m, const Point& place) noexcept;

// Meets each vertex that is no farther from a place than a limit once, the nearest vertex first and
// the others in no order. Takes no memory. O(degrees) for each vertex that is met, where degrees
// are spread evenly, and the square of a degree at worst.
class CircleWalk {
 public:
  // `nearest` is what nearest_vertex() answers of the place.
  CircleWalk(const MeshState& m, const Point& place, const NearVertex& nearest,
             const SquaredLength& limit) noexcept;

  // On to a vertex; false where all have been met.
  bool next() noexcept;
  const NearVertex& here() const noexcept { return here_; }

  // From here on vertices farther than this are passed over. Not above the limit so far.
  void shrink(const SquaredLength& limit) noexcept { limit_ = limit; }

  // After the last vertex, if nothing has shrunk: how far the next one outside is; the greatest
  // length where there is none.
  const SquaredLength& beyond() const noexcept { return beyond_; }

 private:
  NearVertex seen(VertexId v) const noexcept { return {v, squared_distance(place_, m_.at(v))}; }
  // Whether no neighbour of the spoke's origin is nearer than its target.
  bool leads_nearest(Edge spoke, const NearVertex& target) noexcept;
  bool is_beaten(const NearVertex& target, Edge spoke) const noexcept;

  const MeshState& m_;
  const Point place_;
  SquaredLength limit_;
  SquaredLength beyond_{std::numeric_limits<std::uint64_t>::max(),
                        std::numeric_limits<std::uint64_t>::max()};
  NearVertex here_{};
  NearVertex nearest_;
  Edge spoke_{};  // of `here`, to be looked at next
  Edge last_{};   // of `nearest`, at which the walk ends
  StepBound bound_;
  Pulse pulse_;
};

}  // namespace etcm::internal
