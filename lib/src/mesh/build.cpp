// Everything at once: nodes along a Hilbert curve, then features; or with the Steiner vertices of
// an earlier mesh.
#include "conforming/canonical.h"
#include "conforming/conform.h"
#include "conforming/conform_features.h"
#include "conforming/detach.h"
#include "conforming/features.h"
#include "conforming/lone.h"
#include "conforming/transaction.h"
#include "geometry/predicates_inline.h"
#include "triangulation/change.h"
#include "triangulation/hilbert_order.h"
#include "triangulation/hints.h"
#include "triangulation/insert.h"
#include "triangulation/locate.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// Of a node or a feature that is given, to enter it and to put it in order.
constexpr Units work_of_entry = 24;

// A build that fails on its input leaves nothing, but says what it stumbled over.
Status reject(Mesh& mesh, Change& change, Status status) noexcept {
  ErrorDetail error_detail = change.mesh.error_detail;
  error_detail.status = status;
  mesh.clear();
  change.mesh.error_detail = error_detail;
  return status;
}

// Then the mesh is empty again, as before.
bool leaves_nothing(Status status) noexcept {
  return status == Status::work_limit || status == Status::crossing_features ||
         status == Status::overlapping_features || status == Status::repeated_feature ||
         status == Status::out_of_features;
}

// Not noexcept: GCC thinks that its own prefetch throws, and would provide for it.
[[gnu::nothrow]] inline void prefetch(const void* place) { __builtin_prefetch(place); }

// While they are inserted nodes go by their place along the curve, so that what lies together is
// stored together: a large mesh is built out of caches. Each one's owner holds its own id.
void number_along_curve(MeshState& m, std::span<const Position> nodes) noexcept {
  const OrderEntry* order = hilbert_order(m);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    m.work.pass_entry(i);
    if (i + 8 < nodes.size()) prefetch(&nodes[order[i + 8].vertex - 1]);
    m.points[i + 1] = to_point(nodes[order[i].vertex - 1]);
    m.owners[i + 1] = Owner(Role::node, SegmentId{static_cast<IdValue>(order[i].vertex)});
  }
}

VertexId own_id(const MeshState& m, VertexId v) noexcept {
  return v == infinite_vertex ? v : VertexId{m.owner(v).segment().value};
}

void set_nodes(MeshState& m, std::span<const Position> nodes) noexcept {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    m.work.pass_entry(i);
    m.points[i + 1] = to_point(nodes[i]);
    m.owners[i + 1] = Owner(Role::node, SegmentId::none());
  }
  m.vertex_end = static_cast<IdValue>(nodes.size() + 1);
  m.node_count = static_cast<std::uint32_t>(nodes.size());
}

void number_as_given(MeshState& m, std::span<const Position> nodes) noexcept {
  std::size_t renamed = 0;
  m.topology.rename_vertices([&](VertexId v) noexcept {
    m.work.pass_entry(renamed++);
    return own_id(m, v);
  });
  if (!m.only_vertex.is_none()) m.only_vertex = own_id(m, m.only_vertex);
  set_nodes(m, nodes);
}

Status insert_nodes(Change& change, std::span<const Position> nodes) noexcept {
  MeshState& m = change.mesh;
  if (nodes.empty()) return Status::ok;
  if (!m.work.spend_whole(work_of_entry * nodes.size())) return Status::work_limit;
  set_nodes(m, nodes);
  number_along_curve(m, nodes);
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    const VertexId v{i};
    const Found found = find(m, m.at(v), m.walk_start, m.work.walk());
    if (!m.work.spend(found.steps)) return Status::work_limit;
    if (found.type == LocateType::on_vertex) {
      const VertexId one = own_id(m, v), other = own_id(m, found.vertex);
      m.error_detail.vertex = one < other ? one : other;
      m.error_detail.rejected = one < other ? other : one;
      return Status::duplicate_vertex;
    }
    if (!insert_vertex(change, v, found)) return Status::work_limit;
  }
  number_as_given(m, nodes);
  spread_hints(m);
  return Status::ok;
}

// The roots of the features, segments 0 .. count - 1, as a list.
Status enter_features(MeshState& m, std::span<const FeatureEnds> features,
                      FeatureList& list) noexcept {
  if (!m.work.spend_whole(work_of_entry * features.size())) return Status::work_limit;
  for (const FeatureEnds& ends : features) {
    const SegmentId root = allocate_segment(m);
    if (root.is_none()) return Status::out_of_features;
    m.work.pass_entry(root.value);
    m.error_detail.feature = FeatureId{root.value};
    for (const VertexId v : {ends.from, ends.to}) {
      if (v == infinite_vertex || !m.is_node(v)) {
        m.error_detail.vertex = v;
        return Status::unknown_vertex;
      }
    }
    if (ends.from == ends.to) return Status::zero_length_feature;
    set_ends(m, root, ends.from, ends.to);
    list.push(m, root);
  }
  m.error_detail.feature = FeatureId::none();
  return Status::ok;
}

// The nodes of an empty mesh, and its features, not yet linked, as a list.
Status enter(Mesh& mesh, Change& change, std::span<const Position> nodes,
             std::span<const FeatureEnds> features, FeatureList& list) noexcept {
  MeshState& m = change.mesh;
  if (m.node_count != 0) return m.error_detail.status = Status::mesh_not_empty;
  mesh.clear();  // ids begin anew, whoever had them
  if (nodes.size() > m.config.vertices_max) return m.error_detail.status = Status::out_of_vertices;
  if (features.size() > m.config.features_max)
    return m.error_detail.status = Status::out_of_features;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    m.work.pass_entry(i);
    if (in_range(nodes[i])) continue;
    m.error_detail.vertex = VertexId{static_cast<IdValue>(i + 1)};
    return m.error_detail.status = Status::bad_coordinate;
  }
  Status status = insert_nodes(change, nodes);
  if (status == Status::ok) status = enter_features(m, features, list);
  if (status != Status::ok) return reject(mesh, change, status);
  m.feature_count = static_cast<std::uint32_t>(features.size());
  return status;
}

// Links every feature of the list and marks nothing yet.
Status link_all(Change& change, FeatureList& list) noexcept {
  MeshState& m = change.mesh;
  for (SegmentId root = list.pop(m); !root.is_none(); root = list.pop(m)) {
    const SurveyResult surveyed = survey(m, root);
    if (surveyed.status != Status::ok) return surveyed.status;
    if (!m.work.spend_whole(surveyed.steps)) return Status::work_limit;
    link_feature(change, root, surveyed.nodes_between);
  }
  clear_touched(change);
  return Status::ok;
}

// Whether p is a place for a Steiner vertex of the segment.
bool is_on_grid(const MeshState& m, SegmentId s, const Point& p) noexcept {
  const Point& from = m.at(m.segment(s).from);
  const Point& to = m.at(m.segment(s).to);
  if (!(from < p && p < to)) return false;
  // Between the ends in lexicographic order, so the quotient is a parameter.
  const bool by_x = from.x != to.x;
  const std::int64_t length = (by_x ? to.x - from.x : to.y - from.y) / subunits_per_unit;
  const std::int64_t t = (by_x ? p.x - from.x : p.y - from.y) / length;
  return t > 0 && t < parameter_end && point_at(m, s, static_cast<Parameter>(t)) == p;
}

// The segment of a feature on whose grid vertex v stands, its ends excluded; none where it does
// not. Not the first one's it is found by the vertex before it on the line, for there may be many.
// Where there is no room for the work it is over.
SegmentId segment_with(MeshState& m, SegmentId root, VertexId v) noexcept {
  const SegmentRecord& r = m.segment(root);
  const Point& p = m.at(v);
  if (!(m.at(r.from) < p) || orient2d_fast(m.at(r.from), m.at(r.to), p) != 0) {
    return SegmentId::none();
  }
  SegmentId s = root;
  if (m.at(r.to) < p) {
    const Subsegment subsegment = march(m, v, r.from, m.work.walk());
    if (!m.work.spend(subsegment.steps)) return SegmentId::none();
    const VertexId before = subsegment.tail;
    s = m.owner(before).segment();
    if (m.is_node(before)) {
      while (!s.is_none() && (m.segment(s).from != before || m.segment(s).root != r.root)) {
        if (!m.work.spend_whole(1)) return SegmentId::none();
        s = next_at(m, s, before);
      }
    }
  }
  return !s.is_none() && m.segment(s).root == r.root && is_on_grid(m, s, p) ? s : SegmentId::none();
}

Status insert_steiner(Change& change, const SteinerPlace& place) noexcept {
  MeshState& m = change.mesh;
  if (!in_range(place.point)) return Status::bad_coordinate;
  const SegmentId root{static_cast<IdValue>(place.feature)};
  const Found found = find(m, place.point, edge_near(m, place.point), m.work.walk());
  if (!m.work.spend(found.steps)) return Status::work_limit;
  if (found.type == LocateType::on_vertex) {
    if (m.is_node(found.vertex)) return Status::bad_coordinate;
    const SegmentId s = segment_with(m, root, found.vertex),
                    other = m.owner(found.vertex).segment();
    if (s.is_none()) return m.work.is_over() ? Status::work_limit : Status::bad_coordinate;
    if (other != s) return reject_meeting(m, s, other);
    m.error_detail.vertex = found.vertex;
    return Status::duplicate_vertex;
  }
  const VertexId v = allocate_vertex(m);
  if (v.is_none()) return Status::out_of_vertices;
  m.points[v.value] = place.point;
  m.owner(v) = Owner(Role::steiner, root);
  if (!insert_vertex(change, v, found)) return Status::work_limit;
  ++m.steiner_count;
  const SegmentId s = segment_with(m, root, v);
  if (s.is_none()) return m.work.is_over() ? Status::work_limit : Status::bad_coordinate;
  m.owner(v) = Owner(Role::steiner, s);
  return Status::ok;
}

// A build ends early: what it has not come to is dirty.
// Not inline, or the deepest call, a build that goes on, would have the room of this too.
[[gnu::noinline]] Status keep_what_stands(Mesh& mesh, Change& change, Status status) noexcept {
  MeshState& m = change.mesh;
  const ErrorDetail error_detail = m.error_detail;
  m.unresolved = constrain_rest(change);
  if (m.work.is_over()) return reject(mesh, change, Status::work_limit);
  ETCM_VERIFY_THAT(m.unresolved != 0);
  end_change(change);
  m.error_detail = error_detail;
  return status;
}

}  // namespace

Status Mesh::build(std::span<const Position> nodes, std::span<const FeatureEnds> features,
                   Work limit, void (*nodes_stand)(void* context) noexcept,
                   void* context) noexcept {
  MeshState& m = about_to_change(*this, Call::build);
  m.work.start_anew(limit, keep_alive_);
  Change change(m, Change::Extent::whole);
  FeatureList pending;
  Status status = enter(*this, change, nodes, features, pending);
  if (status != Status::ok) return status;
  if (nodes_stand != nullptr) m.work.call_out([&]() noexcept { nodes_stand(context); });
  status = conform_features(change, pending);
  if (status == Status::ok) status = lay_lone_again(change);
  if (leaves_nothing(status)) return reject(*this, change, status);
  if (status != Status::ok) return keep_what_stands(*this, change, status);
  status = commit(change);
  return status == Status::ok ? status : reject(*this, change, status);
}

Status Mesh::restore(std::span<const Position> nodes, std::span<const FeatureEnds> features,
                     std::span<const SteinerPlace> steiner, Work limit) noexcept {
  MeshState& m = about_to_change(*this, Call::restore);
  m.work.start_anew(limit, keep_alive_);
  Change change(m);
  FeatureList list;
  Status status = enter(*this, change, nodes, features, list);
  if (status != Status::ok) return status;
  status = link_all(change, list);
  const std::uint32_t budget = m.config.steiner_max;
  if (budget != 0 && steiner.size() > budget) status = Status::steiner_budget;
  for (const SteinerPlace& place : steiner) {
    if (status != Status::ok) break;
    m.error_detail.feature = FeatureId{static_cast<IdValue>(place.feature)};
    status =
        place.feature < features.size() ? insert_steiner(change, place) : Status::unknown_feature;
  }
  for (IdValue i = 0; i < m.segment_end && status == Status::ok; ++i) {
    m.error_detail.feature = internal::feature_of(m, SegmentId{i});
    status = constrain_segment(m, SegmentId{i});
  }
  if (status != Status::ok) return reject(*this, change, status);
  make_all_stale(m);
  m.error_detail = ErrorDetail{};
  return status;
}

}  // namespace ETCM_IDS
}  // namespace etcm
