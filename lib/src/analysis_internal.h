// What the parts of the analysis share.
#pragma once

#include "analysis_arithmetic.h"
#include "mesh_internal.h"

namespace etcm::internal {

// Calls visit(edge) once for each edge between two vertices.
template <class Visit>
void for_each_edge(const MeshState& m, Visit visit) noexcept {
  const Topology& topo = m.topology;
  for (IdValue t = 0; t < topo.triangle_count(); ++t) {
    for (unsigned side = 0; side < 3; ++side) {
      const Edge e = Topology::edge(t, side);
      if (e.value > topo.twin(e).value) continue;
      if (topo.origin(e) == infinite_vertex || topo.target(e) == infinite_vertex) continue;
      visit(e);
    }
  }
}

// Calls visit(section, head, tail) for each piece of each feature.
template <class Visit>
void for_each_piece(const MeshState& m, Visit visit) noexcept {
  for (IdValue value = 0; value < m.section_end; ++value) {
    const SectionId s{value};
    if (!is_laid(m, s)) continue;
    const VertexId end = m.section(s).to;
    for (VertexId head = m.section(s).from; head != end;) {
      const VertexId tail = march(m, head, end).tail;
      visit(s, head, tail);
      head = tail;
    }
  }
}

// --- analysis_walk.cpp: who is the nearest along a straight line between two vertices

// Where, going from the vertex `from` in the direction `along`, `before` hands over to `after` as
// the nearest vertex: at from + along * step / scale. scale > 0.
struct Handover {
  VertexId before{};
  VertexId after{};
  Int128 step;
  Int128 scale;
};

class NearestWalk {
 public:
  NearestWalk(const MeshState& m, VertexId from, VertexId to) noexcept
      : m_(m), to_(to), origin_(m.at(from)), along_(between(m.at(from), m.at(to))) {
    here_.after = from;
  }

  // The next handover; false once `to` is the nearest.
  bool next() noexcept;

  const Handover& handover() const noexcept { return here_; }
  // Whether the nearest vertex is farther here than the range.
  bool is_beyond(std::uint32_t range) const noexcept;
  // Whether it is farther here than just before and just after.
  bool is_peak() const noexcept;
  Point place() const noexcept;  // rounded to the nearest sub-unit

 private:
  Handover candidate(VertexId after) const noexcept;
  // The sign of how far this place is ahead of the foot of v on the line.
  int sign_ahead_of(VertexId v) const noexcept;

  const MeshState& m_;
  const VertexId to_;
  const Point origin_;
  const Vector along_;
  Handover here_;
};

}  // namespace etcm::internal
