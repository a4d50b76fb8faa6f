// The records of features and vertices: allocation, incidence, the lists of work.
#include "sections.h"

#include <utility>

#include "mesh_internal.h"

namespace etcm::internal {
namespace {

SectionId& next_slot(MeshState& m, SectionId s, VertexId node) noexcept {
  SectionRecord& r = m.section(s);
  return r.from == node ? r.next_at_from : r.next_at_to;
}

void unlink_at(MeshState& m, SectionId s, VertexId node) noexcept {
  const SectionId after = next_slot(m, s, node);
  SectionId head = m.owner(node).section();
  if (head == s) {
    m.owner(node) = Owner(Role::node, after);
    return;
  }
  while (next_slot(m, head, node) != s) head = next_slot(m, head, node);
  next_slot(m, head, node) = after;
}

void link_at(MeshState& m, SectionId s, VertexId node) noexcept {
  next_slot(m, s, node) = m.owner(node).section();
  m.owner(node) = Owner(Role::node, s);
}

}  // namespace

VertexId allocate_vertex(MeshState& m) noexcept {
  if (!m.free_vertices.is_none()) {
    const VertexId v = m.free_vertices;
    m.free_vertices = VertexId{m.vertex_edges[v.value].value};
    return v;
  }
  if (m.vertex_end > m.config.vertices_max) return VertexId::none();
  const VertexId v{m.vertex_end};
  m.vertex_end = static_cast<IdValue>(m.vertex_end + 1u);
  return v;
}

void free_vertex(MeshState& m, VertexId v) noexcept {
  m.owner(v) = Owner{};
  m.vertex_edges[v.value] = Edge{m.free_vertices.value};
  m.free_vertices = v;
}

SectionId allocate_section(MeshState& m) noexcept {
  SectionId s = m.free_sections;
  if (!s.is_none()) {
    m.free_sections = m.section(s).next;
    --m.free_section_count;
  } else {
    if (m.section_end >= m.config.features_max) return SectionId::none();
    s = SectionId{m.section_end};
    m.section_end = static_cast<IdValue>(m.section_end + 1u);
  }
  m.section(s) = SectionRecord{};
  m.section(s).next_dirty = not_listed;
  m.section(s).next_touched = not_listed;
  m.section(s).next_at_from = not_listed;
  return s;
}

void free_section(MeshState& m, SectionId s) noexcept {
  m.section(s).from = VertexId::none();
  m.section(s).root = free_root;
  m.section(s).next = m.free_sections;
  m.free_sections = s;
  ++m.free_section_count;
}

void link_section(MeshState& m, SectionId s) noexcept {
  link_at(m, s, m.section(s).from);
  link_at(m, s, m.section(s).to);
}

void unlink_section(MeshState& m, SectionId s) noexcept {
  unlink_at(m, s, m.section(s).from);
  unlink_at(m, s, m.section(s).to);
  m.section(s).next_at_from = not_listed;
}

bool is_free(const MeshState& m, SectionId s) noexcept { return m.section(s).root == free_root; }

bool is_laid(const MeshState& m, SectionId s) noexcept {
  return !m.section(s).from.is_none() && m.section(s).next_at_from != not_listed;
}

SectionId next_at(const MeshState& m, SectionId s, VertexId node) noexcept {
  const SectionRecord& r = m.section(s);
  return r.from == node ? r.next_at_from : r.next_at_to;
}

SectionId section_of_edge(const MeshState& m, VertexId u, VertexId v) noexcept {
  if (m.owner(u).role() != Role::node) return m.owner(u).section();
  if (m.owner(v).role() != Role::node) return m.owner(v).section();
  for (SectionId s = m.owner(u).section(); !s.is_none(); s = next_at(m, s, u)) {
    const SectionRecord& r = m.section(s);
    if (r.from == v || r.to == v) return s;
  }
  return SectionId::none();
}

FeatureId feature_of(const MeshState& m, SectionId s) noexcept {
  if (s.is_none()) return FeatureId::none();
  return FeatureId{static_cast<IdValue>(m.section(s).root & static_cast<IdValue>(~reversed_bit))};
}

bool precedes(const MeshState& m, SectionId a, SectionId b) noexcept {
  const SectionRecord& r = m.section(a);
  const SectionRecord& s = m.section(b);
  if (r.from != s.from) return m.at(r.from) < m.at(s.from);
  return m.at(r.to) < m.at(s.to);
}

namespace {

bool list_touched(MeshState& m, SectionId s) noexcept {
  SectionRecord& r = m.section(s);
  if (r.next_touched != not_listed) return false;
  r.next_touched = m.touched;
  m.touched = s;
  return true;
}

}  // namespace

void touch(MeshState& m, SectionId s) noexcept {
  list_touched(m, s);
  m.section(s).first = m.section(s).last = VertexId::none();
}

void touch(MeshState& m, SectionId s, VertexId u, VertexId v) noexcept {
  if (m.at(v) < m.at(u)) std::swap(u, v);
  SectionRecord& r = m.section(s);
  if (list_touched(m, s) || r.first == infinite_vertex) {
    r.first = u;
    r.last = v;
  } else if (!r.first.is_none()) {
    if (m.at(u) < m.at(r.first)) r.first = u;
    if (m.at(r.last) < m.at(v)) r.last = v;
  }
}

void make_dirty(MeshState& m, SectionId s) noexcept {
  if (m.section(s).next_dirty != not_listed) return;
  // Kept in canonical order: in which order the mesh's triangles happened to break them must not
  // show in the result. The list is short.
  SectionId* slot = &m.dirty;
  while (!slot->is_none() && precedes(m, *slot, s)) slot = &m.section(*slot).next_dirty;
  m.section(s).next_dirty = *slot;
  *slot = s;
}

SectionId pop_dirty(MeshState& m) noexcept {
  const SectionId s = m.dirty;
  if (s.is_none()) return s;
  m.dirty = m.section(s).next_dirty;
  m.section(s).next_dirty = not_listed;
  return s;
}

void clear_dirty(MeshState& m) noexcept {
  while (!pop_dirty(m).is_none()) {
  }
}

void cut_section(MeshState& m, SectionId s, VertexId v, SectionId rest) noexcept {
  unlink_section(m, s);
  SectionRecord& r = m.section(s);
  SectionRecord& q = m.section(rest);
  q.from = v;
  q.to = r.to;
  q.next = r.next;
  q.root = r.root;
  r.to = v;
  r.next = rest;
  link_section(m, s);
  link_section(m, rest);
}

void rejoin_section(MeshState& m, SectionId s, SectionId rest) noexcept {
  unlink_section(m, s);
  unlink_section(m, rest);
  m.section(s).to = m.section(rest).to;
  m.section(s).next = m.section(rest).next;
  link_section(m, s);
}

Point point_at(const MeshState& m, SectionId s, Parameter t) noexcept {
  const Point& from = m.at(m.section(s).from);
  const Point& to = m.at(m.section(s).to);
  return {from.x + t * ((to.x - from.x) / subunits_per_unit),
          from.y + t * ((to.y - from.y) / subunits_per_unit)};
}

Parameter parameter_of(const MeshState& m, SectionId s, VertexId v) noexcept {
  const Point& from = m.at(m.section(s).from);
  const Point& to = m.at(m.section(s).to);
  const std::int64_t dx = (to.x - from.x) / subunits_per_unit;
  const std::int64_t dy = (to.y - from.y) / subunits_per_unit;
  const Point& p = m.at(v);
  return static_cast<Parameter>(dx != 0 ? (p.x - from.x) / dx : (p.y - from.y) / dy);
}

}  // namespace etcm::internal
