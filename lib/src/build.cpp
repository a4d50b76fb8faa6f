// Everything at once: nodes along a Hilbert curve, then features; and the same features afresh.
#include "mesh_internal.h"

namespace etcm {

using namespace internal;

namespace {

// A build that fails on its input leaves nothing, but says what it stumbled over.
Status reject(Mesh& mesh, Status status) noexcept {
  Trouble trouble = state_of(mesh).trouble;
  trouble.status = status;
  mesh.clear();
  state_of(mesh).trouble = trouble;
  return status;
}

bool is_bad_input(Status status) noexcept {
  return status == Status::crossing_features || status == Status::overlapping_features ||
         status == Status::repeated_feature || status == Status::out_of_features;
}

Status insert_nodes(MeshState& m, std::span<const Position> nodes) noexcept {
  if (nodes.empty()) return Status::ok;
  for (std::size_t i = 0; i < nodes.size(); ++i) m.points[i + 1] = to_point(nodes[i]);
  m.vertex_end = static_cast<IdValue>(nodes.size() + 1);
  const OrderEntry* order =
      hilbert_order(nodes, m.triangle_memory, m.config.vertices_max * bytes_per_vertex_triangles);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const VertexId v{static_cast<IdValue>(order[i].vertex)};
    if (i + 8 < nodes.size()) __builtin_prefetch(&m.points[order[i + 8].vertex]);
    m.owner(v) = Owner(Role::node, SectionId::none());
    const Found found = find(m, m.at(v), m.near);
    if (found.place == Place::on_vertex) {
      m.trouble.vertex = v < found.vertex ? v : found.vertex;
      m.trouble.rejected = v < found.vertex ? found.vertex : v;
      return Status::duplicate_vertex;
    }
    insert_vertex(m, v, found);
    ++m.node_count;
  }
  spread_hints(m, nullptr);
  return Status::ok;
}

// The roots of the features, sections 0 .. count - 1, as a list.
Status enter_features(MeshState& m, std::span<const FeatureEnds> features,
                      SectionId& list) noexcept {
  for (const FeatureEnds& ends : features) {
    const SectionId root = allocate_section(m);
    if (root.is_none()) return Status::out_of_features;
    m.trouble.feature = FeatureId{root.value};
    for (const VertexId v : {ends.from, ends.to}) {
      if (v == infinite_vertex || !m.is_node(v)) {
        m.trouble.vertex = v;
        return Status::unknown_vertex;
      }
    }
    if (ends.from == ends.to) return Status::zero_length_feature;
    set_ends(m, root, ends.from, ends.to);
    m.section(root).next_dirty = list;
    list = root;
  }
  m.trouble.feature = FeatureId::none();
  return Status::ok;
}

}  // namespace

Status Mesh::build(std::span<const Position> nodes,
                   std::span<const FeatureEnds> features) noexcept {
  MeshState& m = *state_;
  begin(m);
  if (m.vertex_end != 1 || m.section_end != 0) return m.trouble.status = Status::mesh_not_empty;
  if (nodes.size() > m.config.vertices_max) return m.trouble.status = Status::out_of_vertices;
  if (features.size() > m.config.features_max) return m.trouble.status = Status::out_of_features;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (in_range(nodes[i])) continue;
    m.trouble.vertex = VertexId{static_cast<IdValue>(i + 1)};
    return m.trouble.status = Status::bad_coordinate;
  }
  Status status = insert_nodes(m, nodes);
  SectionId list{};
  if (status == Status::ok) status = enter_features(m, features, list);
  if (status != Status::ok) return reject(*this, status);
  m.feature_count = static_cast<std::uint32_t>(features.size());
  SectionId pending{};
  m.is_batch = true;
  status = conform_features(m, list, pending);
  if (is_bad_input(status)) return reject(*this, status);
  if (status != Status::ok) {
    // What stands stands. Features not begun are laid, so that their missing pieces count too.
    Trouble trouble = m.trouble;
    while (!pending.is_none()) {
      const SectionId root = pending;
      pending = m.section(root).next_dirty;
      m.section(root).next_dirty = not_listed;
      const Course course = survey(m, root);
      if (course.status != Status::ok) return reject(*this, course.status);
      lay(m, root, course.nodes_between);
    }
    m.unresolved = settle_rest(m);
    m.trouble = trouble;
    return status;
  }
  commit(m);
  return Status::ok;
}

Status Mesh::rebuild() noexcept {
  MeshState& m = *state_;
  begin(m);
  if (m.unresolved != 0) return m.trouble.status = Status::mesh_unresolved;
  SectionId list{};
  for (IdValue i = 0; i < m.section_end; ++i) {
    const SectionId s{i};
    if (!is_laid(m, s) || internal::feature_of(m, s).value != i) continue;
    take_up(m, s);
    m.section(s).next_dirty = list;
    list = s;
  }
  SectionId pending{};
  m.is_batch = true;
  const Status status = conform_features(m, list, pending);
  if (status == Status::ok) {
    commit(m);
    return status;
  }
  for (IdValue i = 0; i < m.section_end; ++i) {
    if (is_laid(m, SectionId{i})) touch(m, SectionId{i});
  }
  drop_fresh(m);
  for (IdValue i = 0; i < m.section_end; ++i) {
    const SectionId s{i};
    if (m.section(s).from.is_none() || internal::feature_of(m, s).value != i) continue;
    if (is_laid(m, s)) take_up(m, s);
  }
  clear_dirty(m);
  for (IdValue i = 0; i < m.section_end; ++i) {
    const SectionId s{i};
    if (m.section(s).from.is_none() || internal::feature_of(m, s).value != i) continue;
    m.section(s).next_dirty = not_listed;
    lay(m, s, any_nodes_between);
  }
  restore_detached(m);
  return status;
}

}  // namespace etcm
