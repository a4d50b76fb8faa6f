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

Status report(MeshState& m, Status status, VertexId vertex) noexcept {
  m.error_detail.status = status;
  m.error_detail.vertex = vertex;
  return status;
}

// Puts node v, whose point is set, into the mesh, on its segment if it stands on one. `cut` is that
// segment and `rest` its new other part, for remove_node(). `rest` may come with a segment to take.
Status insert_node(Change& change, VertexId v, SegmentId& cut, SegmentId& rest) noexcept {
  MeshState& m = change.mesh;
  Found found = find(m, m.at(v), edge_near(m, m.at(v)));
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
    strip_segment(change, cut);
    found = find(m, m.at(v), m.walk_start);
  }
  m.owner(v) = Owner(Role::node, SegmentId::none());
  insert_vertex(change, v, found);
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
    strip_segment(change, cut);
    strip_segment(change, rest);
    rejoin_segments(m, cut, rest);
    m.segment(rest).from = VertexId::none();
  }
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

// Makes the features that run through v pass it by: both parts of each become one. The second parts
// are returned as a list, linked by `next`, for run_through_again().
SegmentId merge_segments_at(Change& change, VertexId v) noexcept {
  MeshState& m = change.mesh;
  SegmentId parts{};
  for (SegmentId s = m.owner(v).segment(); !s.is_none();) {
    const SegmentId rest = continuation(m, s, v);
    if (rest.is_none()) {
      s = next_at(m, s, v);
      continue;
    }
    strip_segment(change, s);
    strip_segment(change, rest);
    note_incidence(change, s);
    note_incidence(change, rest);
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

// Puts v back where it stood, and the features through it.
void split_segments_at(Change& change, VertexId v, SegmentId parts) noexcept {
  MeshState& m = change.mesh;
  for (SegmentId part = parts; !part.is_none(); part = m.segment(part).next) {
    strip_segment(change, joined_section(m, part));
  }
  insert_vertex(change, v, find(m, m.at(v), m.walk_start));
  while (!parts.is_none()) {
    const SegmentId part = parts;
    parts = m.segment(part).next;
    cut_segment(m, joined_section(m, part), v, part);
  }
}

// Unlinks all features that start or end at v.
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
    unlink_feature(change, root);
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

Status Mesh::join(Position position, VertexId& id) noexcept {
  MeshState& m = opened(*this, Call::join);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!in_range(position)) return report(m, Status::bad_coordinate, VertexId::none());
  const VertexId v = allocate_vertex(m);
  if (v.is_none()) return report(m, Status::out_of_vertices, VertexId::none());
  m.points[v.value] = to_point(position);
  SegmentId cut{}, rest{};
  Status status = insert_node(change, v, cut, rest);
  if (status != Status::ok) {
    free_vertex(m, v);
    forget_new_ids(change);
    return status;
  }
  ++m.node_count;
  status = conform(change);
  if (status == Status::ok) {
    commit(change);
    note_place(change, m.at(v));
    add_hint(m, v);
    id = v;
    return status;
  }
  change.dirty.clear(m);
  drop_fresh(change);
  remove_node(change, v, cut, rest);
  free_vertex(m, v);
  --m.node_count;
  restore_detached(change);
  return status;
}

Status Mesh::leave(VertexId node) noexcept {
  MeshState& m = opened(*this, Call::leave);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!m.is_node(node) || node == infinite_vertex) {
    return report(m, Status::unknown_vertex, node);
  }
  if (is_endpoint(m, node)) return report(m, Status::endpoint_in_use, node);
  const SegmentId parts = merge_segments_at(change, node);
  touch_around(change, node);
  note_place(change, m.at(node));
  remove_hint(m, node);
  remove_vertex(m, node);
  const Status status = conform(change);
  if (status == Status::ok) {
    free_vertex(m, node);
    --m.node_count;
    commit(change);
    return status;
  }
  change.dirty.clear(m);
  drop_fresh(change);
  split_segments_at(change, node, parts);
  restore_detached(change);
  add_hint(m, node);
  return status;
}

Status Mesh::move(VertexId node, Position position) noexcept {
  MeshState& m = opened(*this, Call::move);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!m.is_node(node) || node == infinite_vertex) {
    return report(m, Status::unknown_vertex, node);
  }
  if (!in_range(position)) return report(m, Status::bad_coordinate, node);
  const Point before = m.at(node);
  const Point after = to_point(position);
  if (before == after) return Status::ok;

  const SegmentId parts = merge_segments_at(change, node);
  FeatureList features = unlink_features_of(change, node);
  touch_around(change, node);
  note_place(change, m.at(node));
  remove_hint(m, node);
  remove_vertex(m, node);
  m.points[node.value] = after;
  // Where it comes onto a feature, it takes what it has left with another, or farther back.
  SegmentId cut{}, rest = parts;
  const SegmentRecord part = parts.is_none() ? SegmentRecord{} : m.segment(parts);
  Status status = conform(change);  // of what ran through the node
  bool is_in = false;
  if (status == Status::ok) {
    status = insert_node(change, node, cut, rest);
    is_in = status == Status::ok;
  }
  if (is_in) status = conform(change);
  if (status == Status::ok) {
    turn_features(m, features);
    status = conform_features(change, features);
  }
  if (status == Status::ok) {
    commit(change);
    note_place(change, m.at(node));
    add_hint(m, node);
    return status;
  }

  change.dirty.clear(m);
  drop_fresh(change);
  if (is_in) {
    FeatureList linked = unlink_features_of(change, node);
    features.append(m, linked);
    remove_node(change, node, cut, rest);
    m.owner(node) = Owner(Role::node, SegmentId::none());
    if (!parts.is_none()) {
      m.segment(parts).to = part.to;
      m.segment(parts).root = part.root;
      m.segment(parts).next = part.next;
    }
  }
  m.points[node.value] = before;
  turn_features(m, features);
  split_segments_at(change, node, parts);
  for (SegmentId root = features.pop(m); !root.is_none(); root = features.pop(m)) {
    link_feature(change, root, any_nodes_between);
  }
  restore_detached(change);
  add_hint(m, node);
  return status;
}

Status Mesh::add_feature(FeatureEnds ends, FeatureId& id) noexcept {
  MeshState& m = opened(*this, Call::add_feature);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  for (const VertexId v : {ends.from, ends.to}) {
    if (!m.is_node(v) || v == infinite_vertex) return report(m, Status::unknown_vertex, v);
  }
  if (ends.from == ends.to) return report(m, Status::zero_length_feature, ends.from);
  const SegmentId root = allocate_segment(m);
  if (root.is_none()) return report(m, Status::out_of_features, VertexId::none());
  set_ends(m, root, ends.from, ends.to);
  FeatureList features;
  features.push(m, root);
  const Status status = conform_features(change, features);
  if (status == Status::ok) {
    ++m.feature_count;
    commit(change);
    id = FeatureId{root.value};
    return status;
  }
  change.dirty.clear(m);
  drop_fresh(change);
  features.clear(m);
  if (is_linked(m, root)) unlink_feature(change, root);
  touch(change, root);
  m.segment(root).from = VertexId::none();
  m.error_detail.feature = FeatureId::none();
  restore_detached(change);
  return status;
}

Status Mesh::remove_feature(FeatureId feature) noexcept {
  MeshState& m = opened(*this, Call::remove_feature);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!is_feature(feature)) {
    m.error_detail.feature = feature;
    return report(m, Status::unknown_feature, VertexId::none());
  }
  unlink_feature(change, SegmentId{feature.value});
  m.segment(SegmentId{feature.value}).from = VertexId::none();
  --m.feature_count;
  commit(change);
  return Status::ok;
}

}  // namespace ETCM_IDS
}  // namespace etcm
