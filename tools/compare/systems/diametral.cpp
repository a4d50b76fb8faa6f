// Middles until no diametral circle of a subsegment has a vertex inside: the other reading of
// Sapidis and Perucchio, and one that was tried for Lu, Wu, Zhou.
//
// Two features that meet at a narrow angle would halve each other for ever, so a point added to a
// feature does not count against another that it meets in a node. Such a mesh is Delaunay and
// conforming all the same.
#include "compare/systems/rival.h"
#include "compare/systems/system.h"

namespace etcm::compare {
namespace {

using namespace internal;

bool meets(const MeshState& m, SegmentId a, SegmentId b) noexcept {
  const FeatureEnds p = ends_of(m, SegmentId{feature_of(m, a).value});
  const FeatureEnds q = ends_of(m, SegmentId{feature_of(m, b).value});
  return p.from == q.from || p.from == q.to || p.to == q.from || p.to == q.to;
}

// Of a Delaunay edge it is enough to ask the apexes: they see it under the greatest angles.
bool encroaches(const MeshState& m, SegmentId s, Edge subsegment, VertexId apex) noexcept {
  if (apex == infinite_vertex) return false;
  if (!m.is_node(apex) && meets(m, s, m.owner(apex).segment())) return false;
  const Point& p = m.at(apex);
  const Point& a = m.at(m.topology.origin(subsegment));
  const Point& b = m.at(m.topology.target(subsegment));
  // In double: whether to add a point here is a choice, and the mesh is exact either way.
  return static_cast<double>(a.x - p.x) * static_cast<double>(b.x - p.x) +
             static_cast<double>(a.y - p.y) * static_cast<double>(b.y - p.y) <
         0;
}

bool is_encroached(const MeshState& m, SegmentId s, Edge e) noexcept {
  return encroaches(m, s, e, m.topology.apex(e)) ||
         encroaches(m, s, e, m.topology.apex(m.topology.twin(e)));
}

// One walk along the segment; `changed` is set where something was split.
Status split_encroached_of(Change& change, const RivalRule& rule, SegmentId s, bool& changed) {
  const MeshState& m = change.mesh;
  const VertexId end = m.segment(s).to;
  for (VertexId v = m.segment(s).from; v != end;) {
    const Subsegment subsegment = march(m, v, end);
    const Parameter head = parameter_of(m, s, subsegment.head),
                    tail = parameter_of(m, s, subsegment.tail);
    if (subsegment.is_edge && tail - head > 1 && is_encroached(m, s, subsegment.edge)) {
      touch(change, s, subsegment.head, subsegment.tail);
      make_dirty(change, s);
      if (insert_on_segment(change, s, middle_of(head, tail), subsegment.edge).is_none()) {
        return Status::out_of_vertices;
      }
      const Status status = conform_by(change, rule);
      if (status != Status::ok) return status;
      changed = true;
      continue;
    }
    v = subsegment.tail;
  }
  return Status::ok;
}

Status split_encroached(Change& change, const RivalRule& rule) {
  const MeshState& m = change.mesh;
  for (bool changed = true; changed;) {
    changed = false;
    for (IdValue i = 0; i < m.segment_end; ++i) {
      const SegmentId s{i};
      if (!is_linked(m, s)) continue;
      const Status status = split_encroached_of(change, rule, s, changed);
      if (status != Status::ok) return status;
    }
  }
  return Status::ok;
}

}  // namespace

Attempt run_diametral(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.split = split_in_the_middle, .finish = split_encroached}, depth);
}

}  // namespace etcm::compare
