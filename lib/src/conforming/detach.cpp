#include "conforming/detach.h"

#include "base/linked_sort.h"
#include "conforming/canonical.h"
#include "triangulation/change.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/remove.h"
#include "triangulation/segment_store.h"
#include "triangulation/ties.h"

namespace etcm::internal {

bool keep_for_mark(MeshState& m, const Subsegment& subsegment) noexcept {
  const std::uint32_t left = m.work.left();
  const bool is_node = m.owner(subsegment.head).role() == Role::node;
  const std::uint32_t degree =
      m.topology.degree(subsegment.head, is_node && turns_few < left ? turns_few : left);
  return m.work.spend(degree) &&
         m.work.may_keep(2 * Units{degree} + 2 * Units{subsegment.steps} + 8);
}

bool keep_for_single_mark(MeshState& m, VertexId head) noexcept {
  const std::uint32_t degree = m.topology.degree(head, m.work.left());
  const Units afar = degree > turns_few ? Units{turns_few + steps_back_most} : Units{0};
  return m.work.spend(degree) && m.work.may_keep(2 * Units{degree} + afar + 8);
}

namespace {

constexpr std::uint32_t walk_back_few = 32;

}  // namespace

// Around the vertex five turns are made beside the removal; it is found by a short walk and put
// back, which turns an edge less than its degree, and its edges are looked at twice.
bool may_remove(Change& change, std::uint32_t degree) noexcept {
  MeshState& m = change.mesh;
  if (!m.work.spend(degree)) return false;
  const Units removal = removal_work(degree) + 3 * Units{degree};
  m.work.keep((work_of_flip + 2) * Units{degree} + walk_back_few);
  return m.work.spend_whole(removal);
}

bool keep_walk_back(Change& change, VertexId v) noexcept {
  MeshState& m = change.mesh;
  if (!is_taken_back_whole(change) || m.work.is_going_back()) return true;
  VertexId beside{};
  Spokes spokes(m.topology, v, m.work.left());
  do {
    const VertexId w = spokes.target();
    const bool stays = w != infinite_vertex && w != change.node && m.owner(w).role() != Role::fresh;
    if (stays) beside = w;
  } while (beside.is_none() && spokes.turn());
  if (!m.work.spend(spokes.turns())) return false;
  const auto keep = [&m](std::uint32_t steps) noexcept {
    return m.work.spend(steps) && (steps <= walk_back_few || m.work.may_keep(steps));
  };
  if (!beside.is_none() && !keep(m.topology.degree(beside, m.work.left()))) return false;
  if (!change.detached.is_none() &&
      !keep(find(m, m.at(change.detached), m.topology.edge_at(v), m.work.walk()).steps)) {
    return false;
  }
  change.beside_detached = beside;
  return true;
}

bool may_remove_touching(Change& change, VertexId v, unsigned& degree) noexcept {
  MeshState& m = change.mesh;
  degree = 0;
  if (m.topology.triangle_count() == 0) return m.work.spend(1);
  // Nothing is touched before it is known that all of it may be: what is touched is looked at again
  // when the call goes back. Then nobody prunes.
  Spokes counted(m.topology, v, m.work.left());
  while (counted.turn()) {
  }
  degree = counted.turns();
  if (!may_remove(change, degree)) return false;
  if (m.work.is_going_back()) return true;
  Spokes spokes(m.topology, v);
  do {
    const VertexId w = spokes.target();
    if (w != infinite_vertex && m.owner(w).role() != Role::node) {
      touch(change, m.owner(w).segment(), w, w);
    }
  } while (spokes.turn());
  return true;
}

namespace {

bool may_release_marks(MeshState& m, VertexId steiner) noexcept {
  if (m.work.is_going_back()) return true;
  const OwnEdges own = own_edges(m, steiner);
  for (const Edge e : {own.back, own.onward}) {
    if (!e.is_none() && !may_release(m, e)) return false;
  }
  return true;
}

}  // namespace

bool detach(Change& change, VertexId steiner) noexcept {
  MeshState& m = change.mesh;
  unsigned degree = 0;
  if (!may_release_marks(m, steiner)) return false;
  if (!may_remove_touching(change, steiner, degree)) return false;
  const Owner owner = m.owner(steiner);
  if (owner.role() == Role::steiner) {
    if (!keep_walk_back(change, steiner)) return false;
    note_place(change, m.at(steiner));
  }
  remove_steiner(m, steiner);
  --m.steiner_count;
  if (owner.role() == Role::fresh) {
    free_vertex(m, steiner);
    --change.fresh_count;
    return true;
  }
  m.owner(steiner) = Owner(Role::detached, owner.segment());
  m.vertex_edges[steiner.value] = Edge{change.detached.value};
  change.detached = steiner;
  return true;
}

namespace {

// What of a segment is not yet laid may meet another segment's vertices: there its own have ended.
bool stands_on(const MeshState& m, VertexId v, SegmentId s) noexcept {
  return m.owner(v).role() != Role::node && m.owner(v).segment() == s;
}

// What of it stays while others go is looked at again when they come back: room for that is kept
// before the first one goes.
bool keep_for_marks(MeshState& m, SegmentId s) noexcept {
  const VertexId to = m.segment(s).to;
  for (VertexId v = m.segment(s).from; v != to;) {
    const Subsegment subsegment = march(m, v, to, m.work.walk());
    if (!m.work.spend(subsegment.steps) || !keep_for_mark(m, subsegment)) return false;
    v = subsegment.tail;
    if (v != to && !stands_on(m, v, s)) break;
  }
  return m.work.fits(0);
}

// The edge between a segment's ends, if any, as it is found around the one with fewer neighbours.
struct Turns {
  Edge edge{};
  std::uint32_t turns = 0;
};
Turns turns_to_subsegment(const MeshState& m, SegmentId s, std::uint32_t most) noexcept {
  const VertexId from = m.segment(s).from, to = m.segment(s).to;
  Turns found;
  if (m.topology.triangle_count() == 0) return found;
  Spokes there(m.topology, from, most), back(m.topology, to, most);
  do {
    found.turns += 2;
    if (there.target() == to) found.edge = there.edge();
    if (back.target() == from) found.edge = m.topology.twin(back.edge());
  } while (found.edge.is_none() && found.turns <= most && there.turn() && back.turn());
  return found;
}

}  // namespace

bool strip_segment(Change& change, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  if (!m.work.is_going_back() && !keep_for_marks(m, s)) return false;
  touch(change, s);
  const VertexId to = m.segment(s).to;
  Subsegment subsegment = march(m, m.segment(s).from, to, m.work.walk());
  if (!m.work.spend(subsegment.steps)) return false;
  if (subsegment.tail == to && subsegment.is_edge && m.topology.is_constrained(subsegment.edge)) {
    if (!may_release(m, subsegment.edge)) return false;
    note_mark(change, subsegment.edge);
    release_constraint(m, subsegment.edge);
  }
  // The next one is found while this one stands: from there it is near.
  while (subsegment.tail != to && stands_on(m, subsegment.tail, s)) {
    const VertexId v = subsegment.tail;
    subsegment = march(m, v, to, m.work.walk());
    if (!m.work.spend(subsegment.steps) || !detach(change, v)) return false;
  }
  return !m.work.is_over();
}

bool keep_for_unmarking(MeshState& m, SegmentId s) noexcept {
  const std::uint32_t turns = turns_to_subsegment(m, s, m.work.left()).turns;
  return m.work.spend(turns) && m.work.may_keep(Units{turns} + 8);
}

void unmark_segment(Change& change, SegmentId s) noexcept {
  MeshState& m = change.mesh;
  touch(change, s);
  const Turns found = turns_to_subsegment(m, s, any_steps);
  m.work.add(found.turns);
  if (found.edge.is_none() || !m.topology.is_constrained(found.edge)) return;
  note_mark(change, found.edge);
  release_constraint(m, found.edge);
}

namespace {

// The next vertex of the segment: its end, where what follows is not laid.
VertexId next_on(MeshState& m, SegmentId s, VertexId v) noexcept {
  const VertexId end = m.segment(s).to;
  const Subsegment subsegment = march(m, v, end, m.work.whole_walk());
  m.work.add(subsegment.steps);
  return stands_on(m, subsegment.tail, s) ? subsegment.tail : end;
}

// A list of fresh vertices that are about to go, linked in place of their segments.
VertexId next_fresh(const MeshState& m, VertexId v) noexcept {
  return VertexId{m.owner(v).segment().value};
}
void link_fresh(MeshState& m, VertexId v, VertexId next) noexcept {
  m.owner(v) = Owner(Role::fresh, SegmentId{next.value});
}

// Lists those of a segment. They lie between the ends of what is touched, which stay.
void list_fresh_of(MeshState& m, SegmentId s, VertexId& first, std::uint32_t& count) noexcept {
  auto [v, last] = touched_part(m, s);
  ETCM_VERIFY_THAT(m.owner(v).role() != Role::fresh && m.owner(last).role() != Role::fresh);
  while (v != last && v != m.segment(s).to) {
    const VertexId next = next_on(m, s, v);
    if (m.owner(v).role() == Role::fresh) {
      link_fresh(m, v, first);
      first = v;
      ++count;
    }
    v = next;
  }
}

}  // namespace

// They go in the reverse of the order in which they came, so each has the neighbours that it had
// then, for which room is kept. A change that has not begun to prune gives out ids from the least
// on, and takes none back.
void drop_fresh(Change& change) noexcept {
  MeshState& m = change.mesh;
  VertexId fresh{};
  std::uint32_t count = 0;
  for (SegmentId s = change.touched; !s.is_none() && count != change.fresh_count;
       s = m.segment(s).next_touched) {
    if (is_linked(m, s)) list_fresh_of(m, s, fresh, count);
  }
  struct Links {
    MeshState& m;
    VertexId next(VertexId v) const noexcept { return next_fresh(m, v); }
    void link(VertexId v, VertexId next) const noexcept { link_fresh(m, v, next); }
    bool precedes(VertexId a, VertexId b) const noexcept { return a.value > b.value; }
    void step() const noexcept { m.work.add(1); }
  };
  fresh = sorted(fresh, Links{m});
  while (!fresh.is_none()) {
    const VertexId v = fresh;
    fresh = next_fresh(m, v);
    const Units degree = m.topology.degree(v);
    m.work.add(removal_work(degree) + 2 * degree);
    remove_steiner(m, v);
    free_vertex(m, v);
    --m.steiner_count;
    --change.fresh_count;
  }
}

}  // namespace etcm::internal
