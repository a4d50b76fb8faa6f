#include "conforming/nodes.h"

#include "conforming/canonical.h"
#include "conforming/conform.h"
#include "conforming/detach.h"
#include "conforming/features.h"
#include "conforming/transaction.h"
#include "triangulation/hints.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/mesh_state.h"
#include "triangulation/remove.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

// The segment that p stands on: on one of its Steiner vertices or subsegments. None: on neither.
SegmentId section_under(const MeshState& m, const Found& found) noexcept {
  if (found.type == LocateType::on_vertex && m.owner(found.vertex).role() != Role::node) {
    return m.owner(found.vertex).segment();
  }
  if (found.type == LocateType::on_edge && m.topology.is_constrained(found.edge)) {
    return segment_of_edge(m, m.topology.origin(found.edge), m.topology.target(found.edge));
  }
  return SegmentId::none();
}

// To link a segment at its ends, or to find it there.
constexpr Units work_of_link = 4;

// The part of a feature that goes on at v where s ends; none where the feature ends there.
SegmentId continuation(const MeshState& m, SegmentId s, VertexId v) noexcept {
  return m.segment(s).to == v ? m.segment(s).next : SegmentId::none();
}

// The segment that stands where a part of that list was joined to another.
SegmentId joined_section(const MeshState& m, SegmentId part) noexcept {
  const VertexId end = m.segment(part).to;
  SegmentId s = m.owner(end).segment();
  while (m.segment(s).to != end || m.segment(s).root != m.segment(part).root) {
    s = next_at(m, s, end);
  }
  return s;
}

}  // namespace

Status report(MeshState& m, Status status, VertexId vertex) noexcept {
  m.error_detail.status = status;
  m.error_detail.vertex = vertex;
  return status;
}

Status insert_node(Change& change, VertexId v, SegmentId& cut, SegmentId& rest) noexcept {
  MeshState& m = change.mesh;
  Found found = find(m, m.at(v), edge_near(m, m.at(v)), m.work.walk());
  if (!m.work.spend(found.steps)) return report(m, Status::work_limit, VertexId::none());
  if (found.type == LocateType::on_vertex && m.owner(found.vertex).role() == Role::node) {
    return report(m, Status::duplicate_vertex, found.vertex);
  }
  cut = section_under(m, found);
  if (!cut.is_none()) {
    if (rest.is_none()) rest = allocate_segment(m);
    if (rest.is_none()) {
      m.error_detail.feature = feature_of(m, cut);
      return report(m, Status::out_of_features, VertexId::none());
    }
    touch(change, rest);
    if (strip_segment(change, cut)) {
      found = find(m, m.at(v), m.walk_start, m.work.walk());
      static_cast<void>(m.work.spend(found.steps));
    }
  }
  m.owner(v) = Owner(Role::node, SegmentId::none());
  change.node = v;
  if (m.work.is_over() || !insert_vertex(change, v, found)) {
    return report(m, Status::work_limit, VertexId::none());
  }
  if (!cut.is_none()) {
    cut_segment(m, cut, v, rest);
    touch(change, cut);
    note_incidence(change, cut);
    note_incidence(change, rest);
    make_dirty(change, cut);
    make_dirty(change, rest);
  }
  return Status::ok;
}

void remove_node(Change& change, VertexId v, SegmentId cut, SegmentId rest) noexcept {
  MeshState& m = change.mesh;
  if (!cut.is_none()) {
    unmark_segment(change, cut);
    unmark_segment(change, rest);
    rejoin_segments(m, cut, rest);
    m.segment(rest).from = VertexId::none();
  }
  unsigned degree = 0;
  static_cast<void>(may_remove_touching(change, v, degree));
  remove_vertex(m, v, degree);
}

bool is_endpoint(const MeshState& m, VertexId v) noexcept {
  for (SegmentId s = m.owner(v).segment(); !s.is_none(); s = next_at(m, s, v)) {
    const bool starts = m.segment(s).from == v && feature_of(m, s).value == s.value;
    if (starts || (m.segment(s).to == v && m.segment(s).next.is_none())) return true;
  }
  return false;
}

bool strip_segments_at(Change& change, VertexId v) noexcept {
  MeshState& m = change.mesh;
  for (SegmentId s = m.owner(v).segment(); !s.is_none(); s = next_at(m, s, v)) {
    const SegmentId rest = continuation(m, s, v);
    if (rest.is_none()) continue;
    if (!strip_segment(change, s) || !strip_segment(change, rest)) return false;
    if (!keep_for_unmarking(m, s) || !keep_for_unmarking(m, rest)) return false;
    note_incidence(change, s);
    note_incidence(change, rest);
    m.work.keep(2 * work_of_link);
    if (!m.work.spend_whole(2 * work_of_link)) return false;
  }
  return true;
}

SegmentId merge_segments_at(Change& change, VertexId v) noexcept {
  MeshState& m = change.mesh;
  SegmentId parts{};
  for (SegmentId s = m.owner(v).segment(); !s.is_none();) {
    const SegmentId rest = continuation(m, s, v);
    if (rest.is_none()) {
      s = next_at(m, s, v);
      continue;
    }
    rejoin_segments(m, s, rest);
    touch(change, s);
    make_dirty(change, s);
    m.segment(rest).from = VertexId::none();
    m.segment(rest).next = parts;
    parts = rest;
    s = m.owner(v).segment();
  }
  return parts;
}

namespace {

// Of the nodes beside v, but one, the first with few neighbours, else that with the fewest of no
// more than `most`, which becomes how many it has. None: there is none, or no more work.
VertexId node_beside(MeshState& m, VertexId v, VertexId but, std::uint32_t few,
                     std::uint32_t& most) noexcept {
  VertexId found{};
  Spokes spokes(m.topology, v);
  do {
    const VertexId w = spokes.target();
    if (w == infinite_vertex || w == but || m.owner(w).role() != Role::node) continue;
    const std::uint32_t left = m.work.left();
    const std::uint32_t around = m.topology.degree(w, most < left ? most : left);
    if (!m.work.spend(around)) return VertexId::none();
    if (around > most) continue;
    found = w;
    most = around;
  } while ((found.is_none() || most > few) && spokes.turn());
  return found;
}

}  // namespace

bool keep_way_back(Change& change, VertexId v, unsigned degree, VertexId& beside) noexcept {
  MeshState& m = change.mesh;
  beside = VertexId::none();
  if (m.topology.triangle_count() == 0) return true;
  // Nearly always there is one with so few neighbours, ...
  constexpr std::uint32_t few = 16;
  std::uint32_t around = few;
  beside = node_beside(m, v, v, few, around);
  Units way = 2 * Units{around};
  if (beside.is_none()) {
    // ... or behind a Steiner vertex, ...
    Spokes spokes(m.topology, v);
    do {
      const VertexId w = spokes.target();
      if (w == infinite_vertex || m.owner(w).role() == Role::node) continue;
      const std::uint32_t beyond = m.topology.degree(w, few);
      if (!m.work.spend(beyond)) return false;
      if (beyond <= few) beside = node_beside(m, w, v, few, around);
      way = 2 * (Units{beyond} + around);
    } while (beside.is_none() && spokes.turn());
  }
  if (beside.is_none()) {
    // ... else around one with many. And from anywhere no triangle is come to twice.
    around = m.topology.triangle_count() / 2;
    beside = node_beside(m, v, v, few, around);
    way = 2 * Units{around} + 1;
  }
  return !m.work.is_over() && m.work.may_keep(Units{degree} + way);
}

void put_node_back(Change& change, VertexId v, SegmentId parts, VertexId beside) noexcept {
  MeshState& m = change.mesh;
  for (SegmentId part = parts; !part.is_none(); part = m.segment(part).next) {
    unmark_segment(change, joined_section(m, part));
  }
  if (!beside.is_none() && m.topology.triangle_count() != 0) {
    m.walk_start = m.topology.edge_at(beside);
  }
  put_back(change, v);
}

void split_segments_at(MeshState& m, VertexId v, SegmentId parts) noexcept {
  while (!parts.is_none()) {
    const SegmentId part = parts;
    parts = m.segment(part).next;
    cut_segment(m, joined_section(m, part), v, part);
  }
}

FeatureList unlink_features_of(Change& change, VertexId v) noexcept {
  MeshState& m = change.mesh;
  FeatureList list;
  for (SegmentId s = m.owner(v).segment(); !s.is_none();) {
    const SegmentId root{feature_of(m, s).value};
    const FeatureEnds ends = ends_of(m, root);
    if (ends.from != v && ends.to != v) {
      s = next_at(m, s, v);
      continue;
    }
    m.work.keep(2 * work_of_link);
    if (!m.work.spend_whole(2 * work_of_link) || !unlink_feature(change, root)) break;
    list.push(m, root);
    s = m.owner(v).segment();
  }
  return list;
}

}  // namespace etcm::internal
