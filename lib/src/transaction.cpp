// All or nothing in fixed memory. The triangulation is canonical, so going back needs no record of
// flips: it is enough to know which vertices came, and to keep the ones that went. A vertex that
// goes keeps its place (detached) until the change ends; one that comes is marked fresh.
#include "mesh_internal.h"

namespace etcm::internal {

// A batch does not keep the touched sections together, so it looks at all.
void end_change(MeshState& m) noexcept {
  if (m.is_batch) {
    for (IdValue i = 0; i < m.section_end; ++i) {
      if (m.section(SectionId{i}).from.is_none()) touch(m, SectionId{i});
    }
    for (IdValue i = 1; i < m.vertex_end; ++i) {
      Owner& owner = m.owners[i];
      if (owner.role() == Role::fresh) owner = Owner(Role::steiner, owner.section());
    }
  }
  while (!m.touched.is_none()) {
    const SectionId s = m.touched;
    m.touched = m.section(s).next_touched;
    m.section(s).next_touched = not_listed;
    if (m.section(s).from.is_none() && !is_free(m, s)) free_section(m, s);
  }
  m.spare = SectionId::none();
}

void begin(MeshState& m) noexcept {
  m.trouble = Trouble{};
  m.steps = 0;
  m.is_batch = false;
}

void touch_around(MeshState& m, VertexId v) noexcept {
  if (m.topology.triangle_count() == 0) return;
  Spokes spokes(m.topology, v);
  do {
    const VertexId w = spokes.target();
    if (w != infinite_vertex && m.owner(w).role() != Role::node) {
      touch(m, m.owner(w).section(), w, w);
    }
  } while (spokes.turn());
}

void detach(MeshState& m, VertexId steiner) noexcept {
  touch_around(m, steiner);
  const Owner owner = m.owner(steiner);
  remove_steiner(m, steiner);
  --m.steiner_count;
  if (owner.role() == Role::fresh) {
    free_vertex(m, steiner);
    return;
  }
  m.owner(steiner) = Owner(Role::detached, owner.section());
  m.vertex_edges[steiner.value] = Edge{m.detached.value};
  m.detached = steiner;
}

void strip_section(MeshState& m, SectionId s) noexcept {
  touch(m, s);
  const VertexId from = m.section(s).from, to = m.section(s).to;
  for (;;) {
    const Stretch piece = march(m, from, to);
    if (piece.tail != to) {
      detach(m, piece.tail);
      continue;
    }
    if (piece.is_edge && m.topology.is_constrained(piece.edge)) release_constraint(m, piece.edge);
    return;
  }
}

void drop_fresh(MeshState& m) noexcept {
  for (SectionId s = m.touched; !s.is_none(); s = m.section(s).next_touched) {
    if (!is_laid(m, s)) continue;
    const VertexId end = m.section(s).to;
    VertexId v = m.section(s).from;
    while (v != end) {
      const VertexId w = march(m, v, end).tail;
      if (m.owner(w).role() == Role::fresh) {
        detach(m, w);
      } else {
        v = w;
      }
    }
  }
}

void restore_detached(MeshState& m) noexcept {
  while (!m.detached.is_none()) {
    const VertexId v = m.detached;
    m.detached = VertexId{m.vertex_edges[v.value].value};
    m.owner(v) = Owner(Role::steiner, m.owner(v).section());
    ++m.steiner_count;
    insert_vertex(m, v, find(m, m.at(v), m.near));
  }
  clear_dirty(m);
  for (SectionId s = m.touched; !s.is_none(); s = m.section(s).next_touched) {
    if (!is_laid(m, s)) continue;
    const VertexId end = m.section(s).to;
    VertexId v = m.section(s).from;
    while (v != end) {
      const Stretch piece = march(m, v, end);
      ETCM_VERIFY_THAT(can_be_edge(m, piece));
      settle_piece(m, piece);
      v = piece.tail;
    }
  }
  end_change(m);
}

void forget_touched(MeshState& m) noexcept {
  while (!m.touched.is_none()) {
    const SectionId s = m.touched;
    m.touched = m.section(s).next_touched;
    m.section(s).next_touched = not_listed;
  }
}

void commit(MeshState& m) noexcept {
  while (!m.detached.is_none()) {
    const VertexId v = m.detached;
    m.detached = VertexId{m.vertex_edges[v.value].value};
    free_vertex(m, v);
  }
  prune(m);
  end_change(m);
}

}  // namespace etcm::internal
