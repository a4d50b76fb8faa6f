#include "etcm/nearest.h"

#include "geometry/lengths.h"
#include "mesh/least_entries.h"
#include "triangulation/circle_walk.h"
#include "triangulation/mesh_state.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

auto nearest_first(const MeshState& m) noexcept {
  return [&m](const NearNode& a, const NearNode& b) noexcept { return is_nearer(m, a, b); };
}

SquaredLength four_times(const SquaredLength& length) noexcept {
  return {(length.high << 2) | (length.low >> 62), length.low << 2};
}

// How many nodes a circle must hold cannot be told beforehand, so its radius is doubled until they
// are enough: all circles together cost little more than the last one, and what is met there first
// makes it smaller again.
std::uint32_t write_nearest(const MeshState& m, const Point& place,
                            std::span<NearNode> out) noexcept {
  const std::span<NearNode> wanted =
      out.first(out.size() < m.node_count ? out.size() : m.node_count);
  if (wanted.empty()) return 0;
  const NearVertex nearest = nearest_vertex(m, place);
  SquaredLength limit = nearest.distance;
  // Each circle holds a vertex more than the last one.
  for (StepBound bound(m.vertex_count());; bound.step()) {
    LeastEntries found(wanted, nearest_first(m));
    CircleWalk walk(m, place, nearest, limit);
    while (walk.next()) {
      if (!m.is_node(walk.here().node)) continue;
      found.offer(walk.here());
      if (found.is_full()) walk.shrink(found.greatest().distance);
    }
    if (found.is_full()) {
      found.sort();
      return static_cast<std::uint32_t>(wanted.size());
    }
    limit = four_times(limit);
    if (limit < walk.beyond()) limit = walk.beyond();
  }
}

}  // namespace

VertexId nearest_node(const Mesh& mesh, Point place) noexcept {
  const MeshState& m = opened(mesh, Call::nearest_node);
  NearNode nearest;
  static_cast<void>(write_nearest(m, place, {&nearest, 1}));
  return nearest.node;
}

std::uint32_t nearest_nodes(const Mesh& mesh, Point place, std::span<NearNode> out) noexcept {
  return write_nearest(opened(mesh, Call::nearest_nodes), place, out);
}

std::uint32_t nodes_within(const Mesh& mesh, Point place, std::uint32_t range,
                           std::span<NearNode> out) noexcept {
  const MeshState& m = opened(mesh, Call::nodes_within);
  LeastEntries found(out, nearest_first(m));
  CircleWalk walk(m, place, nearest_vertex(m, place), squared_range(range, 0));
  std::uint32_t count = 0;
  while (walk.next()) {
    if (!m.is_node(walk.here().node)) continue;
    found.offer(walk.here());
    ++count;
  }
  found.sort();
  return count;
}

}  // namespace ETCM_IDS
}  // namespace etcm
