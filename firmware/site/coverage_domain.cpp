#include "firmware/site/coverage_domain.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "etcm/locate.h"
#include "etcm/predicates.h"

namespace etcm::firmware {

namespace {

// More Steiner vertices than this for each corner, and the outline is no line of a site.
constexpr std::uint32_t vertices_per_corner_max = 64;
constexpr std::uint32_t vertices_min = 64;

// A place strictly within the triangle; none where it is thinner than a sub-unit.
std::optional<Point> place_in(const Mesh& mesh, const Triangle& triangle) {
  std::array<Point, 3> corner;
  for (std::size_t i = 0; i < 3; ++i) corner[i] = mesh.point(triangle.corner[i]);
  const Point place{(corner[0].x + corner[1].x + corner[2].x) / 3,
                    (corner[0].y + corner[1].y + corner[2].y) / 3};
  for (std::size_t i = 0; i < 3; ++i) {
    if (orient2d(corner[i], corner[(i + 1) % 3], place) <= 0) return std::nullopt;
  }
  return place;
}

// Whether b is ahead of a on the way to c; the three are on one line.
bool is_ahead(const Point& a, const Point& b, const Point& c) {
  return a.x != c.x ? (b.x > a.x) == (c.x > a.x) && b.x != a.x
                    : (b.y > a.y) == (c.y > a.y) && b.y != a.y;
}

}  // namespace

CoverageDomain::CoverageDomain(std::uint32_t vertices_max)
    : region_(2 * std::size_t{vertices_max}),
      waiting_(region_.size()),
      around_(std::size_t{vertices_max}) {}

Status CoverageDomain::take(const SiteDomain& site) {
  corners_.clear();
  edges_.clear();
  hole_edges_.clear();
  hole_seeds_.clear();
  has_outline_ = false;
  std::map<Point, VertexId> vertex_at;
  std::set<std::pair<VertexId, VertexId>> known;
  const auto vertex = [&](const Point& place) {
    const auto [found, is_new] =
        vertex_at.emplace(place, VertexId(static_cast<IdValue>(corners_.size() + 1)));
    if (is_new) {
      corners_.push_back({static_cast<std::int32_t>(place.x / subunits_per_unit),
                          static_cast<std::int32_t>(place.y / subunits_per_unit)});
    }
    return found->second;
  };
  for (const auto edges : {site.outline(), site.holes()}) {
    for (const DomainEdge& edge : edges) {
      if (edge.from == edge.to) continue;
      const VertexId from = vertex(edge.from), to = vertex(edge.to);
      if (known.insert(std::minmax(from, to)).second) edges_.push_back({.from = from, .to = to});
    }
  }
  if (edges_.empty()) return Status::ok;
  const Status status = build();
  if (status != Status::ok) return status;
  label(site);
  has_outline_ = !site.outline().empty();
  hole_edges_.assign(site.holes().begin(), site.holes().end());
  std::erase_if(hole_edges_, [](const DomainEdge& edge) { return edge.from == edge.to; });
  return status;
}

// How many Steiner vertices it takes is known once they are there.
Status CoverageDomain::build() {
  const auto corner_count = static_cast<std::uint32_t>(corners_.size());
  Status status = Status::out_of_vertices;
  for (std::uint32_t room = 2; room <= vertices_per_corner_max; room *= 2) {
    const MeshConfig config{
        .vertices_max = std::max(vertices_min, room * corner_count),
        // An edge that runs through other corners is cut at each.
        .features_max = static_cast<std::uint32_t>(edges_.size()) + room * corner_count};
    memory_.assign(storage_bytes(config) / sizeof(std::uint64_t) + 1, 0);
    status = outline_mesh_.open(std::as_writable_bytes(std::span(memory_)), config);
    if (status == Status::ok) status = outline_mesh_.build(corners_, edges_);
    if (status != Status::out_of_vertices && status != Status::steiner_budget &&
        status != Status::out_of_features) {
      break;
    }
  }
  return status;
}

// No triangle is on both sides of the outline or of a hole, and neither are triangles that meet in
// an edge that is on neither: one place tells for all of them.
void CoverageDomain::label(const SiteDomain& site) {
  const std::uint32_t count = outline_mesh_.triangle_count();
  outline_region_.assign(count, Region::outside);
  std::vector<bool> is_known(count, false);
  std::vector<std::uint32_t> part;
  for (std::uint32_t first = 0; first < count; ++first) {
    if (is_known[first]) continue;
    is_known[first] = true;
    part.assign(1, first);
    std::optional<Point> place;
    bool is_bounded = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Triangle triangle = outline_mesh_.triangle(TriangleId{static_cast<IdValue>(part[i])});
      is_bounded = is_bounded && !triangle.is_ghost();
      if (!place && !triangle.is_ghost()) place = place_in(outline_mesh_, triangle);
      for (std::size_t side = 0; side < 3; ++side) {
        const std::uint32_t next = triangle.neighbour[side].value;
        if (triangle.constrained[side] || is_known[next]) continue;
        is_known[next] = true;
        part.push_back(next);
      }
    }
    // What reaches the vertex at infinity is outside.
    if (!is_bounded || !place) continue;
    const DomainPlace at = site.place_of_point(*place);
    if (at == DomainPlace::in_hole) hole_seeds_.push_back(*place);
    for (const std::uint32_t id : part) {
      outline_region_[id] = at == DomainPlace::inside    ? Region::inside
                            : at == DomainPlace::in_hole ? Region::hole
                                                         : Region::outside;
    }
  }
}

Domain CoverageDomain::of(const Mesh& mesh) {
  if (has_outline_) return {.mesh = &outline_mesh_, .region = outline_region_};
  // Into a hole that is open somewhere, the label would spread over the domain.
  const bool with_holes = !hole_seeds_.empty() && has_all_holes(mesh);
  static_cast<void>(
      label_domain(mesh, Exterior::automatic,
                   with_holes ? std::span<const Point>(hole_seeds_) : std::span<const Point>(),
                   region_, waiting_));
  return {.mesh = &mesh, .region = region_};
}

bool CoverageDomain::has_all_holes(const Mesh& mesh) {
  return std::all_of(hole_edges_.begin(), hole_edges_.end(),
                     [&](const DomainEdge& edge) { return has_edge(mesh, edge); });
}

// Whether features of the mesh lie all along the edge.
bool CoverageDomain::has_edge(const Mesh& mesh, const DomainEdge& edge) {
  const VertexId end = locate(mesh, edge.to).vertex;
  VertexId at = locate(mesh, edge.from).vertex;
  if (at.is_none() || end.is_none()) return false;
  while (at != end) {
    const Point place = mesh.point(at);
    const std::uint32_t degree = mesh.neighbours(at, around_);
    const auto around = std::span(around_).first(degree);
    const auto next = std::find_if(around.begin(), around.end(), [&](const Neighbour& neighbour) {
      const Point there = mesh.point(neighbour.vertex);
      return neighbour.constrained && orient2d(place, there, edge.to) == 0 &&
             is_ahead(place, there, edge.to);
    });
    if (next == around.end()) return false;
    at = next->vertex;
  }
  return true;
}

}  // namespace etcm::firmware
