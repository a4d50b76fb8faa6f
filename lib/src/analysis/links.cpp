// What is asked of single edges.
#include "analysis/internal.h"
#include "triangulation/mesh_state.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// Which sides a triangle decides on.
struct Verdict {
  bool is_gabriel = true;
  bool is_urquhart = true;
};

// What the triangle behind e says about e, whose squared length is given.
Verdict verdict(const MeshState& m, Edge e, const SquaredLength& length) noexcept {
  const VertexId apex = m.topology.apex(e);
  if (apex == infinite_vertex) return {};
  const SquaredLength one = squared_distance(m.at(m.topology.origin(e)), m.at(apex));
  const SquaredLength other = squared_distance(m.at(m.topology.target(e)), m.at(apex));
  // The half of the edge's circle on this side lies in the circumcircle, which is empty, if the
  // angle at the apex is acute; else the apex itself is in or on it.
  return {sum(one, other) > length, one >= length || other >= length};
}

Link link_of(const MeshState& m, Edge e, const SquaredLength& length) noexcept {
  const Verdict one = verdict(m, e, length);
  const Verdict other = verdict(m, m.topology.twin(e), length);
  return {m.topology.origin(e), m.topology.target(e), m.topology.is_constrained(e),
          one.is_gabriel && other.is_gabriel, one.is_urquhart && other.is_urquhart};
}

}  // namespace

std::uint32_t links(const Mesh& mesh, std::uint32_t longer_than, std::span<Link> out) noexcept {
  const MeshState& m = opened(mesh, Call::links);
  const SquaredLength limit = squared_range(longer_than, 0);
  std::uint32_t count = 0;
  for_each_edge(m, [&](Edge e) noexcept {
    const SquaredLength length =
        squared_distance(m.at(m.topology.origin(e)), m.at(m.topology.target(e)));
    if (length <= limit) return;
    if (count < out.size()) out[count] = link_of(m, e, length);
    ++count;
  });
  return count;
}

std::uint32_t links_at(const Mesh& mesh, VertexId vertex, std::span<Link> out) noexcept {
  const MeshState& m = opened(mesh, Call::links_at);
  demand(m.is_vertex(vertex), Call::links_at, Fault::no_vertex);
  if (m.topology.triangle_count() == 0) return 0;
  std::uint32_t count = 0;
  Spokes spokes(m.topology, vertex);
  do {
    const VertexId to = spokes.target();
    if (to == infinite_vertex) continue;
    if (count < out.size()) {
      out[count] = link_of(m, spokes.edge(), squared_distance(m.at(vertex), m.at(to)));
    }
    ++count;
  } while (spokes.turn());
  return count;
}

}  // namespace ETCM_IDS
}  // namespace etcm
