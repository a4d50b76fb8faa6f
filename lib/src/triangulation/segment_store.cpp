// The records of features and vertices: allocation, incidence, grids.
#include "triangulation/segment_store.h"

#include <cstddef>
#include <utility>

#include "topology/segments.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {
namespace {

SegmentId& next_slot(MeshState& m, SegmentId s, VertexId node) noexcept {
  SegmentRecord& r = m.segment(s);
  return r.from == node ? r.next_at_from : r.next_at_to;
}

void unlink_at(MeshState& m, SegmentId s, VertexId node) noexcept {
  const SegmentId after = next_slot(m, s, node);
  SegmentId head = m.owner(node).segment();
  if (head == s) {
    m.owner(node) = Owner(Role::node, after);
    return;
  }
  std::uint32_t steps = 1;
  for (; next_slot(m, head, node) != s; ++steps) head = next_slot(m, head, node);
  m.work.add(steps);
  next_slot(m, head, node) = after;
}

void link_at(MeshState& m, SegmentId s, VertexId node) noexcept {
  next_slot(m, s, node) = m.owner(node).segment();
  m.owner(node) = Owner(Role::node, s);
}

FreeRecords vertex_records(const MeshState& m) noexcept {
  return {reinterpret_cast<std::byte*>(m.points), sizeof(Point)};
}

// The root of a segment tells that it is free, and stays.
FreeRecords segment_records(const MeshState& m) noexcept {
  return {reinterpret_cast<std::byte*>(m.segments) + offsetof(SegmentRecord, next_at_from),
          sizeof(SegmentRecord)};
}

}  // namespace

VertexId allocate_vertex(MeshState& m) noexcept {
  if (!m.free_vertices.is_empty()) {
    const VertexId v{m.free_vertices.take(vertex_records(m))};
    ETCM_VERIFY_THAT(m.owner(v).role() == Role::free);
    return v;
  }
  if (m.vertex_end > m.config.vertices_max) return VertexId::none();
  const VertexId v{m.vertex_end};
  m.vertex_end = static_cast<IdValue>(m.vertex_end + 1u);
  return v;
}

void free_vertex(MeshState& m, VertexId v) noexcept {
  m.owner(v) = Owner{};
  m.free_vertices.add(vertex_records(m), v.value);
}

SegmentId allocate_segment(MeshState& m) noexcept {
  SegmentId s{};
  if (!m.free_segments.is_empty()) {
    s = SegmentId{m.free_segments.take(segment_records(m))};
  } else {
    if (m.segment_end >= m.config.features_max) return SegmentId::none();
    s = SegmentId{m.segment_end};
    m.segment_end = static_cast<IdValue>(m.segment_end + 1u);
  }
  m.segment(s) = SegmentRecord{};
  m.segment(s).next_listed = not_listed;
  m.segment(s).next_touched = not_listed;
  m.segment(s).next_at_from = not_listed;
  m.segment(s).next_in_group = not_listed;
  m.segment(s).next_dependent = s;
  return s;
}

void free_segment(MeshState& m, SegmentId s) noexcept {
  m.segment(s).from = VertexId::none();
  m.segment(s).root = free_root;
  m.free_segments.add(segment_records(m), s.value);
}

std::uint32_t segments_left(const MeshState& m) noexcept {
  return m.config.features_max - m.segment_end + m.free_segments.count(segment_records(m));
}

void lower_ends(MeshState& m, IdValue vertex_end, IdValue segment_end) noexcept {
  if (m.vertex_end != vertex_end) m.free_vertices.keep_below(vertex_records(m), vertex_end);
  if (m.segment_end != segment_end) m.free_segments.keep_below(segment_records(m), segment_end);
  m.vertex_end = vertex_end;
  m.segment_end = segment_end;
}

void link_segment(MeshState& m, SegmentId s) noexcept {
  link_at(m, s, m.segment(s).from);
  link_at(m, s, m.segment(s).to);
}

void unlink_segment(MeshState& m, SegmentId s) noexcept {
  unlink_at(m, s, m.segment(s).from);
  unlink_at(m, s, m.segment(s).to);
  m.segment(s).next_at_from = not_listed;
}

bool is_free(const MeshState& m, SegmentId s) noexcept { return m.segment(s).root == free_root; }

bool is_linked(const MeshState& m, SegmentId s) noexcept {
  return !m.segment(s).from.is_none() && m.segment(s).next_at_from != not_listed;
}

SegmentId next_at(const MeshState& m, SegmentId s, VertexId node) noexcept {
  const SegmentRecord& r = m.segment(s);
  return r.from == node ? r.next_at_from : r.next_at_to;
}

SegmentId segment_of_edge(const MeshState& m, VertexId u, VertexId v, SegmentId except) noexcept {
  for (const VertexId end : {u, v}) {
    if (m.owner(end).role() == Role::node) continue;
    const SegmentId s = m.owner(end).segment();
    return s == except ? SegmentId::none() : s;
  }
  // Both lists side by side: one of them may be long.
  SegmentId at_u = m.owner(u).segment(), at_v = m.owner(v).segment();
  while (!at_u.is_none() && !at_v.is_none()) {
    const SegmentRecord& r = m.segment(at_u);
    const SegmentRecord& q = m.segment(at_v);
    if ((r.from == v || r.to == v) && at_u != except) return at_u;
    if ((q.from == u || q.to == u) && at_v != except) return at_v;
    at_u = next_at(m, at_u, u);
    at_v = next_at(m, at_v, v);
  }
  return SegmentId::none();
}

bool is_feature(const MeshState& m, FeatureId feature) noexcept {
  const SegmentId s{feature.value};
  return feature.value < m.segment_end && !m.segment(s).from.is_none() &&
         feature_of(m, s) == feature;
}

FeatureId feature_of(const MeshState& m, SegmentId s) noexcept {
  if (s.is_none()) return FeatureId::none();
  return FeatureId{static_cast<IdValue>(m.segment(s).root & static_cast<IdValue>(~reversed_bit))};
}

bool precedes(const MeshState& m, SegmentId a, SegmentId b) noexcept {
  const SegmentRecord& r = m.segment(a);
  const SegmentRecord& s = m.segment(b);
  if (r.from != s.from) return m.at(r.from) < m.at(s.from);
  return m.at(r.to) < m.at(s.to);
}

void cut_segment(MeshState& m, SegmentId s, VertexId v, SegmentId rest) noexcept {
  unlink_segment(m, s);
  SegmentRecord& r = m.segment(s);
  SegmentRecord& q = m.segment(rest);
  q.from = v;
  q.to = r.to;
  q.next = r.next;
  q.root = r.root;
  r.to = v;
  r.next = rest;
  link_segment(m, s);
  link_segment(m, rest);
}

void rejoin_segments(MeshState& m, SegmentId s, SegmentId rest) noexcept {
  unlink_segment(m, s);
  unlink_segment(m, rest);
  m.segment(s).to = m.segment(rest).to;
  m.segment(s).next = m.segment(rest).next;
  link_segment(m, s);
}

Point point_at(const MeshState& m, SegmentId s, Parameter t) noexcept {
  const Point& from = m.at(m.segment(s).from);
  const Point& to = m.at(m.segment(s).to);
  return {from.x + t * ((to.x - from.x) / subunits_per_unit),
          from.y + t * ((to.y - from.y) / subunits_per_unit)};
}

Parameter parameter_of(const MeshState& m, SegmentId s, VertexId v) noexcept {
  const Point& from = m.at(m.segment(s).from);
  const Point& to = m.at(m.segment(s).to);
  const std::int64_t dx = (to.x - from.x) / subunits_per_unit;
  const std::int64_t dy = (to.y - from.y) / subunits_per_unit;
  const Point& p = m.at(v);
  return static_cast<Parameter>(dx != 0 ? (p.x - from.x) / dx : (p.y - from.y) / dy);
}

}  // namespace etcm::internal
