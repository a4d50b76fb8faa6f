// What the parts of the analysis share.
#pragma once

#include "analysis/arithmetic.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {

// Calls visit(edge) once for each edge between two vertices.
template <class Visit>
void for_each_edge(const MeshState& m, Visit visit) noexcept {
  const Topology& topo = m.topology;
  Pulse pulse(m);
  for (IdValue t = 0; t < topo.triangle_count(); ++t) {
    pulse.pass(6);
    for (unsigned side = 0; side < 3; ++side) {
      const Edge e = Topology::edge(t, side);
      if (e.value > topo.twin(e).value) continue;
      if (topo.origin(e) == infinite_vertex || topo.target(e) == infinite_vertex) continue;
      visit(e);
    }
  }
}

// Calls visit(segment, head, tail) for each subsegment of each feature.
template <class Visit>
void for_each_subsegment(const MeshState& m, Visit visit) noexcept {
  Pulse pulse(m);
  for (IdValue value = 0; value < m.segment_end; ++value) {
    const SegmentId s{value};
    if (!is_linked(m, s)) continue;
    const VertexId end = m.segment(s).to;
    for (VertexId head = m.segment(s).from; head != end;) {
      const Subsegment subsegment = march(m, head, end);
      const VertexId tail = subsegment.tail;
      pulse.pass(subsegment.steps + 64);
      visit(s, head, tail);
      head = tail;
    }
  }
}

// --- walk.cpp: the nearest vertex along a straight line

// Where, going from `from` in the direction `along`, `before` hands over to `after` as the nearest
// vertex: at from + along * step / scale. scale > 0.
struct Handover {
  VertexId before{};
  VertexId after{};
  Int128 step{};
  Int128 scale{};
};

class NearestWalk {
 public:
  // `nearest` is a nearest vertex at `from`; the two places are distinct.
  NearestWalk(const MeshState& m, const Point& from, const Point& to, VertexId nearest) noexcept
      : m_(m),
        origin_(from),
        along_(between(from, to)),
        nearest_(nearest),
        bound_(m.vertex_count()),
        pulse_(m) {
    enter();
  }

  // The vertex that is the nearest from here on: from the start, or from the last handover.
  VertexId nearest() const noexcept { return nearest_; }
  // Whether the distance to it falls on the first of the way; it rises otherwise.
  bool falls_at_start() const noexcept;

  // The next handover strictly between the two places; false where there is none, and `nearest` is
  // one at `to`.
  bool next() noexcept;
  const Handover& handover() const noexcept { return here_; }
  // Whether the nearest vertex is farther here than the range.
  bool is_beyond(std::uint32_t range) const noexcept;
  // Whether it is farther here than just before and just after.
  bool is_peak() noexcept;
  Point place() const noexcept;  // rounded to the nearest sub-unit

 private:
  // Of several vertices that are nearest at the start, takes the one into whose cell the way goes.
  void enter() noexcept;
  // Whether the nearest vertex, too, hands over at this place.
  bool hands_over_again() noexcept;
  // Where the way leaves the cell of the nearest vertex; false if it never does.
  bool leave_cell(Handover& out) noexcept;
  Handover candidate(VertexId after) const noexcept;
  // The sign of how far this place is ahead of the foot of v on the line.
  int sign_ahead_of(VertexId v) const noexcept;

  const MeshState& m_;
  const Point origin_;
  const Vector along_;
  VertexId nearest_;
  StepBound bound_;  // each cell is entered once
  Pulse pulse_;
  Handover here_;
};

}  // namespace etcm::internal
