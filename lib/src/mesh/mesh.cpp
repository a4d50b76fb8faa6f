// The facade: storage, and what can be read.
#include "etcm/mesh.h"

#include <limits>
#include <new>
#include <type_traits>

#include "conforming/features.h"
#include "triangulation/march.h"
#include "triangulation/mesh_arrays.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

static_assert(sizeof(MeshState) <= bytes_head && bytes_head % alignof(MeshState) == 0);
static_assert(bytes_head + sizeof(Point) + sizeof(Owner) + sizeof(Edge) <= bytes_fixed);
static_assert(sizeof(Point) + 2 * sizeof(TriangleRecord) + sizeof(Owner) + sizeof(Edge) ==
              bytes_per_vertex_capacity);
static_assert(sizeof(SegmentRecord) == bytes_per_feature_capacity);
static_assert(2 * sizeof(TriangleRecord) == bytes_per_vertex_triangles);
// Taking the storage over again must not need destructors.
static_assert(std::is_trivially_destructible_v<MeshState>);

namespace {

std::uint64_t mix(std::uint64_t h) noexcept {
  h ^= h >> 32;
  h *= 0xd6e8feb86659fd93u;
  h ^= h >> 32;
  h *= 0xd6e8feb86659fd93u;
  return h ^ (h >> 32);
}

std::uint64_t mix(const Point& p) noexcept {
  return mix(mix(static_cast<std::uint64_t>(p.x)) + static_cast<std::uint64_t>(p.y));
}

}  // namespace

Status validate(const MeshConfig& config) noexcept {
  const bool good = config.vertices_max >= 1 && config.vertices_max <= vertices_limit &&
                    config.features_max <= features_limit && config.policy != nullptr &&
                    storage_bytes(config) < std::numeric_limits<std::size_t>::max();
  return good ? Status::ok : Status::bad_config;
}

Status Mesh::open(std::span<std::byte> storage, const MeshConfig& config) noexcept {
  const Status status = validate(config);
  if (status != Status::ok) return status;
  if (storage.size() < storage_bytes(config)) return Status::storage_too_small;
  demand(storage.data() != nullptr &&
             reinterpret_cast<std::uintptr_t>(storage.data()) % alignof(MeshState) == 0,
         Call::open, Fault::bad_storage);
  state_ = ::new (storage.data()) MeshState;
  state_->config = {config.vertices_max, config.features_max, config.steiner_max};
  state_->policy = config.policy;
  state_->policy_context = config.policy_context;
  clear();
  return Status::ok;
}

void Mesh::clear() noexcept {
  MeshState& m = about_to_change(*this, Call::clear);
  const KeptConfig config = m.config;
  const OwnState own = m;
  m = MeshState{};
  m.config = config;
  m.policy = own.policy;
  m.policy_context = own.policy_context;
  m.work = own.work;
  m.mesh = this;
  m.seal.bytes = storage_bytes_as<std::uint64_t>(config.vertices_max, config.features_max);
  m.hints.side_bits_most = hint_side_bits(config.vertices_max);
  static_cast<MeshArrays&>(m) = arrays_of(m, reinterpret_cast<std::byte*>(&m));
}

MeshConfig Mesh::config() const noexcept {
  const MeshState& m = opened(*this, Call::config);
  return {.vertices_max = m.config.vertices_max,
          .features_max = m.config.features_max,
          .steiner_max = m.config.steiner_max,
          .policy = m.policy,
          .policy_context = m.policy_context};
}
std::uint32_t Mesh::node_count() const noexcept {
  return opened(*this, Call::node_count).node_count;
}
std::uint32_t Mesh::steiner_count() const noexcept {
  return opened(*this, Call::steiner_count).steiner_count;
}
std::uint32_t Mesh::feature_count() const noexcept {
  return opened(*this, Call::feature_count).feature_count;
}
std::uint32_t Mesh::triangle_count() const noexcept {
  return opened(*this, Call::triangle_count).topology.triangle_count();
}
std::uint32_t Mesh::unresolved() const noexcept {
  return opened(*this, Call::unresolved).unresolved;
}
std::uint32_t Mesh::vertex_id_end() const noexcept {
  return opened(*this, Call::vertex_id_end).vertex_end;
}
std::uint32_t Mesh::feature_id_end() const noexcept {
  return opened(*this, Call::feature_id_end).segment_end;
}
const ErrorDetail& Mesh::error_detail() const noexcept {
  return opened(*this, Call::error_detail).error_detail;
}

std::uint32_t Mesh::finite_triangle_count() const noexcept {
  const Topology& topo = opened(*this, Call::finite_triangle_count).topology;
  if (topo.triangle_count() == 0) return 0;
  return topo.triangle_count() - topo.degree(infinite_vertex);
}

VertexKind Mesh::kind(VertexId vertex) const noexcept {
  const MeshState& m = opened(*this, Call::kind);
  demand(vertex.value < m.vertex_end, Call::kind, Fault::no_vertex);
  if (vertex == infinite_vertex) return VertexKind::none;
  switch (m.owner(vertex).role()) {
    case Role::node:
      return VertexKind::node;
    case Role::steiner:
    case Role::fresh:
      return VertexKind::steiner;
    default:
      return VertexKind::none;
  }
}

Point Mesh::point(VertexId vertex) const noexcept {
  const MeshState& m = opened(*this, Call::point);
  demand(m.is_vertex(vertex), Call::point, Fault::no_vertex);
  return m.at(vertex);
}

Position Mesh::position(VertexId node) const noexcept {
  const MeshState& m = opened(*this, Call::position);
  demand(m.is_vertex(node), Call::position, Fault::no_vertex);
  const Point& p = m.at(node);
  return {static_cast<std::int32_t>(p.x / subunits_per_unit),
          static_cast<std::int32_t>(p.y / subunits_per_unit)};
}

FeatureId Mesh::feature_of(VertexId steiner) const noexcept {
  const MeshState& m = opened(*this, Call::feature_of);
  demand(m.is_vertex(steiner), Call::feature_of, Fault::no_vertex);
  return internal::feature_of(m, m.owner(steiner).segment());
}

std::uint32_t Mesh::neighbours(VertexId vertex, std::span<Neighbour> out) const noexcept {
  const MeshState& m = opened(*this, Call::neighbours);
  demand(m.is_vertex(vertex), Call::neighbours, Fault::no_vertex);
  const Topology& topo = m.topology;
  if (topo.triangle_count() == 0) return 0;
  std::uint32_t count = 0;
  Spokes spokes(topo, vertex);
  do {
    // In a collinear mesh an edge has a ghost on each side and is met once; infinity may be met
    // twice.
    const VertexId v = spokes.target();
    if (v == infinite_vertex) continue;
    if (count < out.size()) out[count] = {v, topo.is_constrained(spokes.edge())};
    ++count;
  } while (spokes.turn());
  return count;
}

Triangle Mesh::triangle(TriangleId id) const noexcept {
  const Topology& topo = opened(*this, Call::triangle).topology;
  demand(id.value < topo.triangle_count(), Call::triangle, Fault::no_triangle);
  Triangle t;
  for (unsigned i = 0; i < 3; ++i) {
    const Edge e = Topology::edge(id.value, i);
    t.corner[i] = topo.apex(e);
    t.neighbour[i] = TriangleId{Topology::triangle_of(topo.twin(e))};
    t.constrained[i] = topo.is_constrained(e);
  }
  return t;
}

bool Mesh::is_feature(FeatureId feature) const noexcept {
  const MeshState& m = opened(*this, Call::is_feature);
  return internal::is_feature(m, feature);
}

FeatureEnds Mesh::ends(FeatureId feature) const noexcept {
  const MeshState& m = opened(*this, Call::ends);
  demand(internal::is_feature(m, feature), Call::ends, Fault::no_feature);
  const FeatureEnds ends = ends_of(m, SegmentId{feature.value});
  const bool reversed = (m.segment(SegmentId{feature.value}).root & reversed_bit) != 0;
  return reversed ? FeatureEnds{ends.to, ends.from} : ends;
}

std::uint32_t Mesh::chain(FeatureId feature, std::span<VertexId> out) const noexcept {
  const MeshState& m = opened(*this, Call::chain);
  demand(internal::is_feature(m, feature), Call::chain, Fault::no_feature);
  const auto for_each = [&](auto visit) noexcept {
    std::uint32_t index = 0;
    StepBound bound(m.segment_end);
    for (SegmentId s{feature.value}; !s.is_none(); s = m.segment(s).next) {
      bound.step();
      const VertexId end = m.segment(s).to;
      for (VertexId v = m.segment(s).from; v != end; v = march(m, v, end).tail) visit(index++, v);
      if (m.segment(s).next.is_none()) visit(index++, end);
    }
    return index;
  };
  const bool reversed = (m.segment(SegmentId{feature.value}).root & reversed_bit) != 0;
  const std::uint32_t last = reversed ? for_each([](std::uint32_t, VertexId) noexcept {}) - 1 : 0;
  return for_each([&](std::uint32_t index, VertexId v) noexcept {
    const std::uint32_t place = reversed ? last - index : index;
    if (place < out.size()) out[place] = v;
  });
}

std::uint64_t Mesh::hash() const noexcept {
  return hash_of(*this, opened(*this, Call::hash), nullptr);
}

}  // namespace ETCM_IDS
}  // namespace etcm

std::uint64_t etcm::internal::hash_of(const Mesh& mesh, const MeshState& m,
                                      WorkMeter* work) noexcept {
  // A sum over what there is does not depend on the order in which it is met.
  std::uint64_t sum = 0;
  Pulse pulse(m);
  const auto pass = [&](std::uint32_t units) noexcept {
    if (work != nullptr) {
      work->pass(units);
    } else {
      pulse.pass(units);
    }
  };
  for (IdValue i = 1; i < m.vertex_end; ++i) {
    pass(1);
    const VertexKind what = mesh.kind(VertexId{i});
    if (what != VertexKind::none) sum += mix(mix(m.points[i]) + static_cast<std::uint64_t>(what));
  }
  for (IdValue t = 0; t < m.topology.triangle_count(); ++t) {
    pass(2);
    for (unsigned side = 0; side < 3; ++side) {
      const Edge e = Topology::edge(t, side);
      const VertexId u = m.topology.origin(e), v = m.topology.target(e);
      if (u == infinite_vertex || v == infinite_vertex || !(m.at(u) < m.at(v))) continue;
      const std::uint64_t mark = m.topology.is_constrained(e) ? 3 : 5;
      sum += mix(mix(mix(m.at(u)) + mark) + mix(m.at(v)));
    }
  }
  return mix(sum);
}
