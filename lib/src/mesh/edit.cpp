// Changes to a standing mesh: join, leave, move, add and remove a feature. Each begins, does what
// it must in steps that can be undone, conforms, and then commits or goes back.
#include "conforming/canonical.h"
#include "conforming/conform.h"
#include "conforming/conform_features.h"
#include "conforming/detach.h"
#include "conforming/features.h"
#include "conforming/nodes.h"
#include "conforming/transaction.h"
#include "triangulation/change.h"
#include "triangulation/hints.h"
#include "triangulation/mesh_state.h"
#include "triangulation/remove.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// What any change takes.
constexpr Units work_least = 16;

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
  MeshState& m = about_to_change(*this, Call::join);
  m.work.start(limit, keep_alive_);
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
    m.handles = nullptr;
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
  MeshState& m = about_to_change(*this, Call::leave);
  m.work.start(limit, keep_alive_);
  Change change(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!m.is_node(node) || node == infinite_vertex) {
    return report(m, Status::unknown_vertex, node);
  }
  if (is_endpoint(m, node)) return report(m, Status::endpoint_in_use, node);
  if (!m.work.spend_whole(work_least)) return report(m, Status::work_limit, node);
  unsigned degree = 0;
  VertexId beside{};
  const bool is_out = strip_segments_at(change, node) &&
                      may_remove_touching(change, node, degree) &&
                      keep_way_back(change, node, degree, beside);
  Status status = is_out ? Status::ok : report(m, Status::work_limit, node);
  SegmentId parts{};
  if (is_out) {
    parts = merge_segments_at(change, node);
    note_place(change, m.at(node));
    remove_hint(m, node);
    remove_vertex(m, node, degree);
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
    put_node_back(change, node, parts, beside);
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
  VertexId beside{};  // where it stood
  bool is_out = false;
  bool is_in = false;
};

Status take_node_out(Change& change, Moving& moving) noexcept {
  MeshState& m = change.mesh;
  const VertexId node = moving.node;
  if (!strip_segments_at(change, node)) return report(m, Status::work_limit, node);
  moving.parts = merge_segments_at(change, node);
  moving.features = unlink_features_of(change, node);
  unsigned degree = 0;
  if (m.work.is_over() || !may_remove_touching(change, node, degree) ||
      !keep_way_back(change, node, degree, moving.beside)) {
    return report(m, Status::work_limit, node);
  }
  note_place(change, m.at(node));
  remove_hint(m, node);
  remove_vertex(m, node, degree);
  moving.is_out = true;
  return conform(change);  // of what ran through the node
}

}  // namespace

Status Mesh::move(VertexId node, Position position, Work limit) noexcept {
  MeshState& m = about_to_change(*this, Call::move);
  m.work.start(limit, keep_alive_);
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
  if (moving.is_out) put_node_back(change, node, moving.parts, moving.beside);
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
  MeshState& m = about_to_change(*this, Call::add_feature);
  m.work.start(limit, keep_alive_);
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
      m.handles = nullptr;
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
  // Of the new one nobody has an id; it may be another that it has broken.
  if (m.error_detail.feature == FeatureId{root.value}) m.error_detail.feature = FeatureId::none();
  restore_detached(change);
  return status;
}

Status Mesh::remove_feature(FeatureId feature, Work limit) noexcept {
  MeshState& m = about_to_change(*this, Call::remove_feature);
  m.work.start(limit, keep_alive_);
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

void Mesh::keep_alive(const KeepAlive& hook) noexcept { keep_alive_ = hook; }

Work Mesh::work_used() const noexcept { return opened(*this, Call::work_used).work.used(); }
Work Mesh::work_needed() const noexcept {
  const MeshState& m = opened(*this, Call::work_needed);
  return m.error_detail.status == Status::ok ? m.work.needed() : m.work.used();
}

}  // namespace ETCM_IDS
}  // namespace etcm
