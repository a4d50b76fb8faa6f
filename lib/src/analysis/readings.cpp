// A reading between the nodes that have one.
#include "analysis/internal.h"
#include "geometry/predicates_inline.h"
#include "geometry/wide_int.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// In 2^-28 of a reading's unit; at most 2^61.
std::int64_t value_at(const MeshState& m, VertexId v,
                      std::span<const std::int32_t> readings) noexcept {
  const auto reading = [&](VertexId node) noexcept { return std::int64_t{readings[node.value]}; };
  if (m.owner(v).role() == Role::node) return reading(v) * subunits_per_unit;
  const SegmentId s = m.owner(v).segment();
  const std::int64_t from = reading(m.segment(s).from), to = reading(m.segment(s).to);
  return from * subunits_per_unit + parameter_of(m, s, v) * (to - from);
}

std::int64_t in_triangle(const MeshState& m, IdValue t, const Point& p,
                         std::span<const std::int32_t> readings) noexcept {
  const TriangleRecord& r = m.topology.triangle(t);
  Int256 weighted{};
  Int128 weights{};
  for (unsigned i = 0; i < 3; ++i) {
    // Twice the area of the triangle with p in the place of the corner.
    const Int128 weight =
        cross(between(p, m.at(r.corner[(i + 1) % 3])), between(p, m.at(r.corner[(i + 2) % 3])));
    weights = weights + weight;
    weighted = weighted + Wide::product(weight, widened(value_at(m, r.corner[i], readings)));
  }
  return rounded_quotient(weighted, weights);
}

std::int64_t on_edge(const MeshState& m, Edge e, const Point& p,
                     std::span<const std::int32_t> readings) noexcept {
  const VertexId from = m.topology.origin(e), to = m.topology.target(e);
  // p is on the line, so one coordinate says how far along it is: any in which the ends differ.
  const Vector way = between(m.at(from), m.at(to)), done = between(m.at(from), p);
  const bool by_x = way.x != 0;
  const std::int64_t whole = by_x ? way.x : way.y, part = by_x ? done.x : done.y;
  const std::int64_t sign = whole < 0 ? -1 : 1;
  const Int256 weighted =
      Wide::product(widened(sign * part), widened(value_at(m, to, readings))) +
      Wide::product(widened(sign * (whole - part)), widened(value_at(m, from, readings)));
  return rounded_quotient(weighted, widened(sign * whole));
}

}  // namespace

Status interpolate(const Mesh& mesh, const Point& place, std::span<const std::int32_t> readings,
                   Interpolated& out) noexcept {
  const MeshState& m = opened(mesh, Call::interpolate);
  if (readings.size() < m.vertex_end) return Status::buffer_too_small;
  const Location at = locate(mesh, place);
  out = {at.type, 0};
  switch (at.type) {
    case LocateType::outside:
      break;
    case LocateType::on_vertex:
      out.value = value_at(m, at.vertex, readings);
      break;
    case LocateType::inside_triangle:
      out.value = in_triangle(m, at.triangle.value, place, readings);
      break;
    case LocateType::on_edge:
      out.value = on_edge(m, Topology::edge(at.triangle.value, static_cast<unsigned>(at.side)),
                          place, readings);
      break;
  }
  return Status::ok;
}

}  // namespace ETCM_IDS
}  // namespace etcm
