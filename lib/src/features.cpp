// A feature on its way through the mesh: surveyed, laid as a run of sections, taken up again.
#include "mesh_internal.h"
#include "predicates_inline.h"

namespace etcm::internal {
namespace {

Status refuse(MeshState& m, Status status, SectionId root, SectionId other) noexcept {
  m.trouble.status = status;
  m.trouble.feature = feature_of(m, root);
  m.trouble.other = feature_of(m, other);
  return status;
}

SectionId section_at(const MeshState& m, Edge e) noexcept {
  return section_of_edge(m, m.topology.origin(e), m.topology.target(e));
}

// What is wrong with a feature that meets a part of another.
Status fault_of(const MeshState& m, SectionId root, SectionId other) noexcept {
  const SectionRecord& r = m.section(root);
  const FeatureEnds theirs = ends_of(m, SectionId{feature_of(m, other).value});
  if (theirs.from == r.from && theirs.to == r.to) return Status::repeated_feature;
  const bool is_along = orient2d_fast(m.at(r.from), m.at(r.to), m.at(theirs.from)) == 0 &&
                        orient2d_fast(m.at(r.from), m.at(r.to), m.at(theirs.to)) == 0;
  return is_along ? Status::overlapping_features : Status::crossing_features;
}

SectionId last_section(const MeshState& m, SectionId root) noexcept {
  SectionId s = root;
  while (!m.section(s).next.is_none()) s = m.section(s).next;
  return s;
}

// The first of the sections that an earlier lay left, or a new one. There is room: the survey saw.
SectionId next_section_for(MeshState& m, SectionId& left_over) noexcept {
  if (left_over.is_none()) return allocate_section(m);
  const SectionId s = left_over;
  left_over = m.section(s).next;
  return s;
}

// The sections that take_up() kept for this root: those it last used, then what m.spare has.
SectionId collect_left_over(MeshState& m, SectionId root) noexcept {
  SectionId first = m.section(root).next;
  SectionId* end = &first;
  while (!end->is_none()) end = &m.section(*end).next;
  for (SectionId* slot = &m.spare; !slot->is_none();) {
    const SectionId s = *slot;
    if (feature_of(m, s) == feature_of(m, root)) {
      *slot = m.section(s).next;
      m.section(s).next = SectionId::none();
      *end = s;
      end = &m.section(s).next;
    } else {
      slot = &m.section(s).next;
    }
  }
  return first;
}

}  // namespace

FeatureEnds ends_of(const MeshState& m, SectionId root) noexcept {
  // One that is not laid holds its ends itself.
  return {m.section(root).from, m.section(is_laid(m, root) ? last_section(m, root) : root).to};
}

void set_ends(MeshState& m, SectionId root, VertexId from, VertexId to) noexcept {
  SectionRecord& r = m.section(root);
  const bool reversed = m.at(to) < m.at(from);
  r.from = reversed ? to : from;
  r.to = reversed ? from : to;
  r.root = static_cast<IdValue>(root.value | (reversed ? reversed_bit : 0u));
}

Course survey(MeshState& m, SectionId root) noexcept {
  const SectionRecord& r = m.section(root);
  Course course;
  std::uint32_t& nodes_between = course.nodes_between;
  for (VertexId v = r.from; v != r.to;) {
    const Stretch piece = march(m, v, r.to);
    SectionId other{};
    if (piece.is_edge && m.topology.is_constrained(piece.edge)) {
      other = section_at(m, piece.edge);
    } else if (!piece.constrained.is_none()) {
      other = section_at(m, piece.constrained);
    } else if (m.owner(piece.tail).role() != Role::node) {
      other = m.owner(piece.tail).section();
    }
    if (!other.is_none()) {
      course.status = refuse(m, fault_of(m, root, other), root, other);
      return course;
    }
    if (course.is_present) course.is_present = can_be_edge(m, piece);
    v = piece.tail;
    if (v != r.to) ++nodes_between;
  }
  std::uint32_t room = m.config.features_max - m.section_end + m.free_section_count;
  for (SectionId s = r.next; !s.is_none() && room < nodes_between; s = m.section(s).next) ++room;
  if (room < nodes_between) {
    course.status = refuse(m, Status::out_of_features, root, SectionId::none());
  }
  return course;
}

void lay(MeshState& m, SectionId root, std::uint32_t nodes_between) noexcept {
  SectionId left_over = collect_left_over(m, root);
  m.section(root).next = SectionId::none();
  const VertexId end = m.section(root).to;
  link_section(m, root);
  SectionId s = root;
  VertexId v = m.section(root).from;
  for (; nodes_between != 0; --nodes_between) {
    v = march(m, v, end).tail;
    if (v == end) break;
    const SectionId rest = next_section_for(m, left_over);
    touch(m, rest);
    cut_section(m, s, v, rest);
    touch(m, s);
    make_dirty(m, s);
    s = rest;
  }
  touch(m, s);
  make_dirty(m, s);
  // In the order in which they were used: the next lay on the old line gives each its old place.
  SectionId* end_of_spare = &left_over;
  while (!end_of_spare->is_none()) end_of_spare = &m.section(*end_of_spare).next;
  *end_of_spare = m.spare;
  m.spare = left_over;
}

void take_up(MeshState& m, SectionId root) noexcept {
  const VertexId to = ends_of(m, root).to;
  for (SectionId s = root; !s.is_none(); s = m.section(s).next) {
    strip_section(m, s);
    unlink_section(m, s);
    if (s != root) m.section(s).from = VertexId::none();
  }
  m.section(root).to = to;
}

Status conform_features(MeshState& m, SectionId list, SectionId& pending) noexcept {
  pending = sort_sections(m, list);
  // What is an edge already, or can be by turning ties, comes first: then no split ignores it.
  for (SectionId* slot = &pending; !slot->is_none();) {
    const SectionId root = *slot;
    const Course course = survey(m, root);
    if (course.status != Status::ok) return course.status;
    if (!course.is_present) {
      slot = &m.section(root).next_dirty;
      continue;
    }
    *slot = m.section(root).next_dirty;
    m.section(root).next_dirty = not_listed;
    lay(m, root, course.nodes_between);
    const Status status = conform(m);
    if (status != Status::ok) return status;
  }
  if (m.is_batch) forget_touched(m);
  while (!pending.is_none()) {
    const SectionId root = pending;
    const Course course = survey(m, root);
    if (course.status != Status::ok) return course.status;
    pending = m.section(root).next_dirty;
    m.section(root).next_dirty = not_listed;
    lay(m, root, course.nodes_between);
    const Status status = conform(m);
    if (status != Status::ok) return status;
    // Before the next feature: what is needless is in its way too, and takes room.
    if (m.is_batch) {
      prune(m);
      forget_touched(m);
    }
  }
  return Status::ok;
}

SectionId sort_sections(MeshState& m, SectionId list) noexcept {
  // Bottom-up: runs of 1, 2, 4, ... are merged pairwise until one is left. No recursion, no memory.
  const auto next = [&m](SectionId s) -> SectionId& { return m.section(s).next_dirty; };
  for (std::uint32_t run = 1;; run *= 2) {
    SectionId rest = list;
    SectionId* end = &list;
    std::uint32_t merges = 0;
    while (!rest.is_none()) {
      ++merges;
      SectionId a = rest;
      SectionId b = a;
      std::uint32_t a_left = 0;
      while (a_left < run && !b.is_none()) {
        ++a_left;
        b = next(b);
      }
      std::uint32_t b_left = run;
      while (a_left > 0 || (b_left > 0 && !b.is_none())) {
        const bool take_b = a_left == 0 || (b_left > 0 && !b.is_none() && precedes(m, b, a));
        SectionId& taken = take_b ? b : a;
        (take_b ? b_left : a_left) -= 1;
        *end = taken;
        SectionId& link = next(taken);
        taken = link;
        end = &link;
      }
      rest = b;
    }
    *end = SectionId::none();
    if (merges <= 1) return list;
  }
}

}  // namespace etcm::internal
