// Changes to a standing mesh: join, leave, move, add and remove a feature. Each begins, does what
// it must in steps that can be undone, conforms, and then commits or goes back.
#include "mesh_internal.h"

namespace etcm {

using namespace internal;

namespace {

// The section that p stands on: on one of its Steiner vertices or subsegments. None: on neither.
SectionId section_under(const MeshState& m, const Found& found) noexcept {
  if (found.place == Place::on_vertex && m.owner(found.vertex).role() != Role::node) {
    return m.owner(found.vertex).section();
  }
  if (found.place == Place::on_edge && m.topology.is_constrained(found.edge)) {
    return section_of_edge(m, m.topology.origin(found.edge), m.topology.target(found.edge));
  }
  return SectionId::none();
}

Status report(MeshState& m, Status status, VertexId vertex) noexcept {
  m.trouble.status = status;
  m.trouble.vertex = vertex;
  return status;
}

// Puts node v, whose point is set, into the mesh, on its section if it stands on one. `cut` is that
// section and `rest` its new other part, for take_out().
Status put_in(MeshState& m, VertexId v, SectionId& cut, SectionId& rest) noexcept {
  Found found = find(m, m.at(v), edge_near(m, m.at(v)));
  if (found.place == Place::on_vertex && m.owner(found.vertex).role() == Role::node) {
    return report(m, Status::duplicate_vertex, found.vertex);
  }
  cut = section_under(m, found);
  if (!cut.is_none()) {
    rest = allocate_section(m);
    if (rest.is_none()) {
      m.trouble.feature = feature_of(m, cut);
      return report(m, Status::out_of_features, VertexId::none());
    }
    touch(m, rest);
    strip_section(m, cut);
    found = find(m, m.at(v), m.near);
  }
  m.owner(v) = Owner(Role::node, SectionId::none());
  insert_vertex(m, v, found);
  if (!cut.is_none()) {
    cut_section(m, cut, v, rest);
    touch(m, cut);
    make_dirty(m, cut);
    make_dirty(m, rest);
  }
  return Status::ok;
}

void take_out(MeshState& m, VertexId v, SectionId cut, SectionId rest) noexcept {
  if (!cut.is_none()) {
    strip_section(m, cut);
    strip_section(m, rest);
    rejoin_section(m, cut, rest);
    m.section(rest).from = VertexId::none();
  }
  touch_around(m, v);
  remove_vertex(m, v);
}

// The part of a feature that goes on at v where s ends; none where the feature ends there.
SectionId continuation(const MeshState& m, SectionId s, VertexId v) noexcept {
  return m.section(s).to == v ? m.section(s).next : SectionId::none();
}

// True where a feature starts or ends at v.
bool is_endpoint(const MeshState& m, VertexId v) noexcept {
  for (SectionId s = m.owner(v).section(); !s.is_none(); s = next_at(m, s, v)) {
    const bool starts = m.section(s).from == v && feature_of(m, s).value == s.value;
    if (starts || (m.section(s).to == v && m.section(s).next.is_none())) return true;
  }
  return false;
}

// Makes the features that run through v pass it by: both parts of each become one. The second parts
// are returned as a list, linked by `next`, for run_through_again().
SectionId bypass(MeshState& m, VertexId v) noexcept {
  SectionId parts{};
  for (SectionId s = m.owner(v).section(); !s.is_none();) {
    const SectionId rest = continuation(m, s, v);
    if (rest.is_none()) {
      s = next_at(m, s, v);
      continue;
    }
    strip_section(m, s);
    strip_section(m, rest);
    rejoin_section(m, s, rest);
    touch(m, s);
    make_dirty(m, s);
    m.section(rest).from = VertexId::none();
    m.section(rest).next = parts;
    parts = rest;
    s = m.owner(v).section();
  }
  return parts;
}

// The section that stands where a part of that list was joined to another.
SectionId joined_section(const MeshState& m, SectionId part) noexcept {
  const VertexId end = m.section(part).to;
  SectionId s = m.owner(end).section();
  while (m.section(s).to != end || m.section(s).root != m.section(part).root) {
    s = next_at(m, s, end);
  }
  return s;
}

// Puts v back where it stood, and the features through it.
void run_through_again(MeshState& m, VertexId v, SectionId parts) noexcept {
  for (SectionId part = parts; !part.is_none(); part = m.section(part).next) {
    strip_section(m, joined_section(m, part));
  }
  insert_vertex(m, v, find(m, m.at(v), m.near));
  while (!parts.is_none()) {
    const SectionId part = parts;
    parts = m.section(part).next;
    cut_section(m, joined_section(m, part), v, part);
  }
}

// Takes up all features that start or end at v, as a list linked by next_dirty.
SectionId take_up_features_of(MeshState& m, VertexId v) noexcept {
  SectionId list{};
  for (SectionId s = m.owner(v).section(); !s.is_none();) {
    const SectionId root{feature_of(m, s).value};
    const FeatureEnds ends = ends_of(m, root);
    if (ends.from != v && ends.to != v) {
      s = next_at(m, s, v);
      continue;
    }
    take_up(m, root);
    m.section(root).next_dirty = list;
    list = root;
    s = m.owner(v).section();
  }
  return list;
}

// A feature's ends after one of them has moved: the canonical direction may have turned.
void turn_features(MeshState& m, SectionId list) noexcept {
  for (SectionId s = list; !s.is_none(); s = m.section(s).next_dirty) {
    const SectionRecord& r = m.section(s);
    const bool reversed = (r.root & reversed_bit) != 0;
    set_ends(m, s, reversed ? r.to : r.from, reversed ? r.from : r.to);
  }
}

}  // namespace

Status Mesh::join(Position position, VertexId& id) noexcept {
  MeshState& m = *state_;
  begin(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!in_range(position)) return report(m, Status::bad_coordinate, VertexId::none());
  const VertexId v = allocate_vertex(m);
  if (v.is_none()) return report(m, Status::out_of_vertices, VertexId::none());
  m.points[v.value] = to_point(position);
  SectionId cut{}, rest{};
  Status status = put_in(m, v, cut, rest);
  if (status != Status::ok) {
    free_vertex(m, v);
    return status;
  }
  ++m.node_count;
  status = conform(m);
  if (status == Status::ok) {
    commit(m);
    remember(m, v);
    id = v;
    return status;
  }
  clear_dirty(m);
  drop_fresh(m);
  take_out(m, v, cut, rest);
  free_vertex(m, v);
  --m.node_count;
  restore_detached(m);
  return status;
}

Status Mesh::leave(VertexId node) noexcept {
  MeshState& m = *state_;
  begin(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!m.is_node(node) || node == infinite_vertex) {
    return report(m, Status::unknown_vertex, node);
  }
  if (is_endpoint(m, node)) return report(m, Status::endpoint_in_use, node);
  const SectionId parts = bypass(m, node);
  touch_around(m, node);
  forget(m, node);
  remove_vertex(m, node);
  const Status status = conform(m);
  if (status == Status::ok) {
    free_vertex(m, node);
    --m.node_count;
    commit(m);
    return status;
  }
  clear_dirty(m);
  drop_fresh(m);
  run_through_again(m, node, parts);
  restore_detached(m);
  remember(m, node);
  return status;
}

Status Mesh::move(VertexId node, Position position) noexcept {
  MeshState& m = *state_;
  begin(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!m.is_node(node) || node == infinite_vertex) {
    return report(m, Status::unknown_vertex, node);
  }
  if (!in_range(position)) return report(m, Status::bad_coordinate, node);
  const Point before = m.at(node);
  const Point after = to_point(position);
  if (before == after) return Status::ok;

  const SectionId parts = bypass(m, node);
  SectionId features = take_up_features_of(m, node);
  touch_around(m, node);
  forget(m, node);
  remove_vertex(m, node);
  m.points[node.value] = after;
  SectionId cut{}, rest{};
  Status status = conform(m);  // of what ran through the node
  bool is_in = false;
  if (status == Status::ok) {
    status = put_in(m, node, cut, rest);
    is_in = status == Status::ok;
  }
  if (is_in) status = conform(m);
  SectionId pending = features;
  if (status == Status::ok) {
    turn_features(m, features);
    status = conform_features(m, features, pending);
  }
  if (status == Status::ok) {
    commit(m);
    remember(m, node);
    return status;
  }

  clear_dirty(m);
  drop_fresh(m);
  features = pending;
  if (is_in) {
    const SectionId laid = take_up_features_of(m, node);
    SectionId* end = &features;
    while (!end->is_none()) end = &m.section(*end).next_dirty;
    *end = laid;
    take_out(m, node, cut, rest);
    m.owner(node) = Owner(Role::node, SectionId::none());
  }
  m.points[node.value] = before;
  turn_features(m, features);
  run_through_again(m, node, parts);
  while (!features.is_none()) {
    const SectionId root = features;
    features = m.section(root).next_dirty;
    m.section(root).next_dirty = not_listed;
    lay(m, root, any_nodes_between);
  }
  restore_detached(m);
  remember(m, node);
  return status;
}

Status Mesh::add_feature(FeatureEnds ends, FeatureId& id) noexcept {
  MeshState& m = *state_;
  begin(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  for (const VertexId v : {ends.from, ends.to}) {
    if (!m.is_node(v) || v == infinite_vertex) return report(m, Status::unknown_vertex, v);
  }
  if (ends.from == ends.to) return report(m, Status::zero_length_feature, ends.from);
  const SectionId root = allocate_section(m);
  if (root.is_none()) return report(m, Status::out_of_features, VertexId::none());
  set_ends(m, root, ends.from, ends.to);
  m.section(root).next_dirty = SectionId::none();
  SectionId pending{};
  const Status status = conform_features(m, root, pending);
  if (status == Status::ok) {
    ++m.feature_count;
    commit(m);
    id = FeatureId{root.value};
    return status;
  }
  clear_dirty(m);
  drop_fresh(m);
  if (is_laid(m, root)) take_up(m, root);
  touch(m, root);
  m.section(root).from = VertexId::none();
  m.trouble.feature = FeatureId::none();
  restore_detached(m);
  return status;
}

Status Mesh::remove_feature(FeatureId feature) noexcept {
  MeshState& m = *state_;
  begin(m);
  if (m.unresolved != 0) return report(m, Status::mesh_unresolved, VertexId::none());
  if (!is_feature(feature)) {
    m.trouble.feature = feature;
    return report(m, Status::unknown_feature, VertexId::none());
  }
  take_up(m, SectionId{feature.value});
  m.section(SectionId{feature.value}).from = VertexId::none();
  --m.feature_count;
  commit(m);
  return Status::ok;
}

}  // namespace etcm
