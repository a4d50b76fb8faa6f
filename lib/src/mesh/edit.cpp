// Changes to a standing mesh: join, leave, move, add and remove a feature. Each begins, does what
// it must in steps that can be undone, conforms, and then commits or goes back.
#include "conforming/canonical.h"
#include "conforming/conform.h"
#include "conforming/conform_features.h"
#include "conforming/detach.h"
#include "conforming/features.h"
#include "conforming/transaction.h"
#include "triangulation/change.h"
#include "triangulation/hints.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/mesh_state.h"
#include "triangulation/remove.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

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

// What any change takes.
constexpr Units work_least = 16;
// To link a segment at its ends, or to find it there.
constexpr Units work_of_link = 4;

Status report(MeshState& m, Status status, VertexId vertex) noexcept {
  m.error_detail.status = status;
  m.error_detail.vertex = vertex;
  return status;
}

// Puts node v, whose point is set, into the mesh, on its segment if it stands on one. `cut` is that
// segment and `rest` its new other part, for remove_node(). `rest` may come with a segment to take.
// Where the answer is not ok, it is not in, and the segment is at most stripped.
Status insert_node(Change& change, VertexId v, SegmentId& cut, SegmentId& rest) noexcept {
  MeshState& m = change.mesh;
  Found found = find(m, m.at(v), edge_near(m, m.at(v)), m.work.left());
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
      found = find(m, m.at(v), m.walk_start, m.work.left());
      static_cast<void>(m.work.spend(found.steps));
    }
  }
  m.owner(v) = Owner(Role::node, SegmentId::none());
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

// When the change is taken back.
void remove_node(Change& change, VertexId v, SegmentId cut, SegmentId rest) noexcept {
  MeshState& m = change.mesh;
  if (!cut.is_none()) {
    static_cast<void>(strip_segment(change, cut));
    static_cast<void>(strip_segment(change, rest));
    rejoin_segments(m, cut, rest);
    m.segment(rest).from = VertexId::none();
  }
  static_cast<void>(may_remove(change, v));
  touch_around(change, v);
  remove_vertex(m, v);
}

// The part of a feature that goes on at v where s ends; none where the feature ends there.
SegmentId continuation(const MeshState& m, SegmentId s, VertexId v) noexcept {
  return m.segment(s).to == v ? m.segment(s).next : SegmentId::none();
}

// True where a feature starts or ends at v.
bool is_endpoint(const MeshState& m, VertexId v) noexcept {
  for (SegmentId s = m.owner(v).segment(); !s.is_none(); s = next_at(m, s, v)) {
    const bool starts = m.segment(s).from == v && feature_of(m, s).value == s.value;
    if (starts || (m.segment(s).to == v && m.segment(s).next.is_none())) return true;
  }
  return false;
}

// Takes the Steiner vertices off the features that run through v, on both sides. False: there is no
// room for the work.
bool strip_segments_at(Change& change, VertexId v) noexcept {
  MeshState& m = change.mesh;
  for (SegmentId s = m.owner(v).segment(); !s.is_none(); s = next_at(m, s, v)) {
    const SegmentId rest = continuation(m, s, v);
    if (rest.is_none()) continue;
    if (!strip_segment(change, s) || !strip_segment(change, rest)) return false;
    note_incidence(change, s);
    note_incidence(change, rest);
    m.work.keep(2 * work_of_link);
    if (!m.work.spend_whole(2 * work_of_link)) return false;
  }
  return true;
}

// Makes those features pass it by: both parts of each become one. The second parts are returned as
// a list, linked by `next`, for split_segments_at().
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

// The segment that stands where a part of that list was joined to another.
SegmentId joined_section(const MeshState& m, SegmentId part) noexcept {
  const VertexId end = m.segment(part).to;
  SegmentId s = m.owner(end).segment();
  while (m.segment(s).to != end || m.segment(s).root != m.segment(part).root) {
    s = next_at(m, s, end);
  }
  return s;
}

// Puts v back where it stood, the segments that passed it by stripped.
void put_node_back(Change& change, VertexId v, SegmentId parts) noexcept {
  MeshState& m = change.mesh;
  for (SegmentId part = parts; !part.is_none(); part = m.segment(part).next) {
    static_cast<void>(strip_segment(change, joined_section(m, part)));
  }
  put_back(change, v);
}

// Makes the features run through it again.
void split_segments_at(MeshState& m, VertexId v, SegmentId parts) noexcept {
  while (!parts.is_none()) {
    const SegmentId part = parts;
    parts = m.segment(part).next;
    cut_segment(m, joined_section(m, part), v, part);
  }
}

// Unlinks all features that start or end at v. Ends early where there is no room for the work.
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

// A feature's ends after one of them has moved: the canonical direction may have turned.
void turn_features(MeshState& m, FeatureList& list) noexcept {
  for (FeatureList::Cursor at(m, list); !at.segment().is_none(); at.advance()) {
    const SegmentRecord& r = m.segment(at.segment());
    const bool reversed = (r.root & reversed_bit) != 0;
    set_ends(m, at.segment(), reversed ? r.to : r.from, reversed ? r.from : r.to);
  }
}

}  // namespace

Status Mesh::join(Position position, VertexId& id, Work limit) noexcept {
  MeshState& m = opened(*this, Call::join);
  m.work.start(limit);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!in_range(position)) return report(m, Status::bad_coordinate, VertexId::none());
  if (!m.work.spend_whole(work_least)) return report(m, Status::work_limit, VertexId::none());
  const VertexId v = allocate_vertex(m);
  if (v.is_none()) return report(m, Status::out_of_vertices, VertexId::none());
  m.points[v.value] = to_point(position);
  SegmentId cut{}, rest{};
  Status status = insert_node(change, v, cut, rest);
  const bool is_in = status == Status::ok;
  if (is_in) {
    ++m.node_count;
    status = conform(change);
  }
  if (status == Status::ok) status = commit(change);
  if (status == Status::ok) {
    note_place(change, m.at(v));
    add_hint(m, v);
    id = v;
    return status;
  }
  begin_going_back(change, status);
  if (is_in) {
    remove_node(change, v, cut, rest);
    --m.node_count;
  }
  free_vertex(m, v);
  restore_detached(change);
  return status;
}

Status Mesh::leave(VertexId node, Work limit) noexcept {
  MeshState& m = opened(*this, Call::leave);
  m.work.start(limit);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!m.is_node(node) || node == infinite_vertex) {
    return report(m, Status::unknown_vertex, node);
  }
  if (is_endpoint(m, node)) return report(m, Status::endpoint_in_use, node);
  if (!m.work.spend_whole(work_least)) return report(m, Status::work_limit, node);
  const bool is_out = strip_segments_at(change, node) && may_remove(change, node);
  Status status = is_out ? Status::ok : report(m, Status::work_limit, node);
  SegmentId parts{};
  if (is_out) {
    parts = merge_segments_at(change, node);
    touch_around(change, node);
    note_place(change, m.at(node));
    remove_hint(m, node);
    remove_vertex(m, node);
    status = conform(change);
  }
  if (status == Status::ok) status = commit(change);
  if (status == Status::ok) {
    free_vertex(m, node);
    --m.node_count;
    return status;
  }
  begin_going_back(change, status);
  if (is_out) {
    put_node_back(change, node, parts);
    split_segments_at(m, node, parts);
  }
  restore_detached(change);
  if (is_out) add_hint(m, node);
  return status;
}

namespace {

// A node that moves: what it takes with it, and how far it has come.
struct Moving {
  VertexId node{};
  SegmentId parts{};  // of the features that ran through it
  FeatureList features{};
  SegmentId cut{};  // where it comes onto a feature
  SegmentId rest{};
  bool is_out = false;
  bool is_in = false;
};

Status take_node_out(Change& change, Moving& moving) noexcept {
  MeshState& m = change.mesh;
  const VertexId node = moving.node;
  if (!strip_segments_at(change, node)) return report(m, Status::work_limit, node);
  moving.parts = merge_segments_at(change, node);
  moving.features = unlink_features_of(change, node);
  if (m.work.is_over() || !may_remove(change, node)) return report(m, Status::work_limit, node);
  touch_around(change, node);
  note_place(change, m.at(node));
  remove_hint(m, node);
  remove_vertex(m, node);
  moving.is_out = true;
  return conform(change);  // of what ran through the node
}

}  // namespace
Status Mesh::move(VertexId node, Position position, Work limit) noexcept {
  MeshState& m = opened(*this, Call::move);
  m.work.start(limit);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!m.is_node(node) || node == infinite_vertex) {
    return report(m, Status::unknown_vertex, node);
  }
  if (!in_range(position)) return report(m, Status::bad_coordinate, node);
  const Point before = m.at(node);
  if (before == to_point(position)) return Status::ok;
  if (!m.work.spend_whole(2 * work_least)) return report(m, Status::work_limit, node);

  Moving moving{.node = node};
  Status status = take_node_out(change, moving);
  // Where it comes onto a feature, it takes what it has left with another, or farther back.
  moving.rest = moving.parts;
  const SegmentRecord part = moving.parts.is_none() ? SegmentRecord{} : m.segment(moving.parts);
  if (status == Status::ok) {
    m.points[node.value] = to_point(position);
    status = insert_node(change, node, moving.cut, moving.rest);
    moving.is_in = status == Status::ok;
  }
  if (moving.is_in) status = conform(change);
  if (status == Status::ok) {
    turn_features(m, moving.features);
    status = conform_features(change, moving.features);
  }
  if (status == Status::ok) status = commit(change);
  if (status == Status::ok) {
    note_place(change, m.at(node));
    add_hint(m, node);
    return status;
  }

  begin_going_back(change, status);
  if (moving.is_in) {
    FeatureList linked = unlink_features_of(change, node);
    moving.features.append(m, linked);
    remove_node(change, node, moving.cut, moving.rest);
    m.owner(node) = Owner(Role::node, SegmentId::none());
    if (!moving.parts.is_none()) {
      m.segment(moving.parts).to = part.to;
      m.segment(moving.parts).root = part.root;
      m.segment(moving.parts).next = part.next;
    }
  }
  m.points[node.value] = before;
  turn_features(m, moving.features);
  if (moving.is_out) put_node_back(change, node, moving.parts);
  split_segments_at(m, node, moving.parts);
  FeatureList& features = moving.features;
  for (SegmentId root = features.pop(m); !root.is_none(); root = features.pop(m)) {
    link_feature(change, root, any_nodes_between);
  }
  restore_detached(change);
  if (moving.is_out) add_hint(m, node);
  return status;
}

Status Mesh::add_feature(FeatureEnds ends, FeatureId& id, Work limit) noexcept {
  MeshState& m = opened(*this, Call::add_feature);
  m.work.start(limit);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  for (const VertexId v : {ends.from, ends.to}) {
    if (!m.is_node(v) || v == infinite_vertex) return report(m, Status::unknown_vertex, v);
  }
  if (ends.from == ends.to) return report(m, Status::zero_length_feature, ends.from);
  if (!m.work.spend_whole(work_least)) return report(m, Status::work_limit, VertexId::none());
  const SegmentId root = allocate_segment(m);
  if (root.is_none()) return report(m, Status::out_of_features, VertexId::none());
  set_ends(m, root, ends.from, ends.to);
  FeatureList features;
  features.push(m, root);
  Status status = conform_features(change, features);
  if (status == Status::ok) {
    ++m.feature_count;
    status = commit(change);
    if (status == Status::ok) {
      id = FeatureId{root.value};
      return status;
    }
    --m.feature_count;
  }
  begin_going_back(change, status);
  features.clear(m);
  if (is_linked(m, root)) static_cast<void>(unlink_feature(change, root));
  touch(change, root);
  m.segment(root).from = VertexId::none();
  m.error_detail.feature = FeatureId::none();
  restore_detached(change);
  return status;
}

Status Mesh::remove_feature(FeatureId feature, Work limit) noexcept {
  MeshState& m = opened(*this, Call::remove_feature);
  m.work.start(limit);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!is_feature(feature)) {
    m.error_detail.feature = feature;
    return report(m, Status::unknown_feature, VertexId::none());
  }
  if (!m.work.spend_whole(work_least)) return report(m, Status::work_limit, VertexId::none());
  SegmentRecord& root = m.segment(SegmentId{feature.value});
  const bool is_unlinked = unlink_feature(change, SegmentId{feature.value});
  Status status = is_unlinked ? Status::ok : report(m, Status::work_limit, VertexId::none());
  const VertexId from = root.from;
  if (is_unlinked) {
    root.from = VertexId::none();
    --m.feature_count;
    status = commit(change);
  }
  if (status == Status::ok) return status;
  begin_going_back(change, status);
  if (is_unlinked) {
    ++m.feature_count;
    root.from = from;
    link_feature(change, SegmentId{feature.value}, any_nodes_between);
  }
  restore_detached(change);
  return status;
}

Work Mesh::work_done() const noexcept { return opened(*this, Call::work_done).work.result(); }

}  // namespace ETCM_IDS
}  // namespace etcm
