#include "support/analysis_check.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

#include "etcm/locate.h"

namespace etcm::test {
namespace {

using testing::AssertionFailure;
using testing::AssertionResult;
using testing::AssertionSuccess;

// Where brute force over all pairs is still quick.
constexpr std::size_t pairs_max = 40;

SquaredLength square_of(std::uint32_t range, std::int64_t more = 0) {
  return squared_distance({0, 0}, {range * subunits_per_unit + more, 0});
}

// Where a node could still stand.
Point beside(const Point& place, std::int64_t x, std::int64_t y) {
  constexpr std::int64_t most = position_max * subunits_per_unit;
  return {std::clamp(place.x + x, -most, most), std::clamp(place.y + y, -most, most)};
}

std::vector<Point> points_of(const Mesh& mesh) {
  std::vector<Point> points;
  for (IdValue value = 1; value < mesh.vertex_id_end(); ++value) {
    if (mesh.kind(VertexId{value}) != VertexKind::none)
      points.push_back(mesh.point(VertexId{value}));
  }
  return points;
}

SquaredLength to_nearest(const std::vector<Point>& points, const Point& place) {
  SquaredLength least = squared_distance(place, points.front());
  for (const Point& point : points) least = std::min(least, squared_distance(place, point));
  return least;
}

// Into how many parts they fall where those that are at most so far apart are linked.
std::uint32_t parts_of(const std::vector<Point>& points, const SquaredLength& reach) {
  std::vector<std::size_t> part(points.size());
  std::iota(part.begin(), part.end(), std::size_t{0});
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (squared_distance(points[i], points[j]) > reach) continue;
      const std::size_t from = part[i], to = part[j];
      std::replace(part.begin(), part.end(), from, to);
    }
  }
  std::sort(part.begin(), part.end());
  return static_cast<std::uint32_t>(std::unique(part.begin(), part.end()) - part.begin());
}

// What a call counts does not depend on the room for its list.
template <class Entry, class Call>
AssertionResult lists(const char* name, Call call, std::vector<Entry>& entries) {
  const auto count = call(std::span<Entry>{});
  entries.resize(static_cast<std::size_t>(std::min<std::uint64_t>(count, 300)));
  if (call(std::span(entries)) == count) return AssertionSuccess();
  return AssertionFailure() << name << " counts differently with a list";
}

}  // namespace

AnalysisCheck::AnalysisCheck(std::uint32_t vertices_max, std::uint64_t seed)
    : random_(seed), devices_(MeshConfig{.vertices_max = vertices_max}) {}

AssertionResult AnalysisCheck::of(const Mesh& mesh) {
  take_vertices(mesh);
  place_devices(mesh);
  using Question = AssertionResult (AnalysisCheck::*)(const Mesh&);
  for (const Question question :
       {&AnalysisCheck::places, &AnalysisCheck::edges, &AnalysisCheck::network,
        &AnalysisCheck::features, &AnalysisCheck::coverage}) {
    const AssertionResult answer = (this->*question)(mesh);
    if (!answer) return answer;
  }
  return AssertionSuccess();
}

void AnalysisCheck::take_vertices(const Mesh& mesh) {
  vertices_.clear();
  points_.clear();
  for (IdValue value = 1; value < mesh.vertex_id_end(); ++value) {
    if (mesh.kind(VertexId{value}) == VertexKind::none) continue;
    vertices_.push_back(VertexId{value});
    points_.push_back(mesh.point(VertexId{value}));
  }
  parts_.resize(mesh.vertex_id_end());
  readings_.resize(mesh.vertex_id_end());
  for (IdValue value = 0; value < mesh.vertex_id_end(); ++value) {
    readings_[value] = static_cast<std::int32_t>(value * 7) - 100;
  }
}

void AnalysisCheck::place_devices(const Mesh& mesh) {
  std::vector<Position> positions;
  const std::uint64_t of_four = random_.below(6);
  for (const VertexId vertex : vertices_) {
    if (mesh.kind(vertex) == VertexKind::node && random_.below(4) < of_four) {
      positions.push_back(mesh.position(vertex));
    }
  }
  devices_->clear();
  EXPECT_EQ(devices_->build(positions, {}), Status::ok);
}

// At times near a distance that there is.
std::uint32_t AnalysisCheck::random_range() {
  if (points_.size() < 2 || random_.below(4) == 0) {
    return static_cast<std::uint32_t>(1 + random_.below(std::uint64_t{1} << random_.below(26)));
  }
  const Point& from = points_[random_.index(points_.size())];
  const std::uint32_t range =
      range_for(squared_distance(from, points_[random_.index(points_.size())]));
  return std::max(1u, range / static_cast<std::uint32_t>(1 + random_.below(3)));
}

AssertionResult AnalysisCheck::places(const Mesh& mesh) {
  Interpolated reading;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    if (locate(mesh, points_[i]).vertex != vertices_[i]) {
      return AssertionFailure() << "vertex " << vertices_[i].value << " is not found in its place";
    }
    if (interpolate(mesh, points_[i], readings_, reading) != Status::ok ||
        reading.type != LocateType::on_vertex) {
      return AssertionFailure() << "no reading at vertex " << vertices_[i].value;
    }
    if (mesh.kind(vertices_[i]) == VertexKind::node &&
        reading.value != readings_[vertices_[i].value] * subunits_per_unit) {
      return AssertionFailure() << "another reading at node " << vertices_[i].value;
    }
  }
  for (int i = 0; i < 3; ++i) {
    const Point near = points_.empty() ? Point{} : points_[random_.index(points_.size())];
    const Point place = beside(near, random_.between(-5, 5) * (subunits_per_unit / 2),
                               random_.between(-5, 5) * (subunits_per_unit / 2));
    const Location at = locate(mesh, place);
    const bool is_vertex = std::find(points_.begin(), points_.end(), place) != points_.end();
    if (is_vertex != (at.type == LocateType::on_vertex) || is_vertex == at.vertex.is_none()) {
      return AssertionFailure() << "a place is wrongly said to be a vertex or none";
    }
    if (at.type == LocateType::inside_triangle && mesh.finite_triangle_count() == 0) {
      return AssertionFailure() << "a place is in a triangle of a mesh without any";
    }
    if (interpolate(mesh, place, readings_, reading) != Status::ok || reading.type != at.type) {
      return AssertionFailure() << "a reading is not where its place is";
    }
  }
  return AssertionSuccess();
}

AssertionResult AnalysisCheck::edges(const Mesh& mesh) {
  std::vector<Link> found, at_one;
  std::vector<Neighbour> around;
  AssertionResult answer = lists(
      "links", [&](std::span<Link> out) { return links(mesh, 0, out); }, found);
  std::size_t ends = 0;
  for (const VertexId vertex : vertices_) {
    if (!answer) return answer;
    answer = lists(
        "links_at", [&](std::span<Link> out) { return links_at(mesh, vertex, out); }, at_one);
    around.resize(mesh.neighbours(vertex, {}));
    around.resize(mesh.neighbours(vertex, around));
    const bool is_same = std::equal(at_one.begin(), at_one.end(), around.begin(),
                                    around.begin() + static_cast<std::ptrdiff_t>(at_one.size()),
                                    [&](const Link& link, const Neighbour& neighbour) {
                                      return link.from == vertex && link.to == neighbour.vertex &&
                                             link.constrained == neighbour.constrained;
                                    });
    if (!is_same) return AssertionFailure() << "the links of a vertex are not its neighbours";
    ends += around.size();
  }
  if (answer && 2 * std::size_t{links(mesh, 0, {})} != ends) {
    return AssertionFailure() << "there are more or fewer links than pairs of neighbours";
  }
  return answer;
}

AssertionResult AnalysisCheck::network(const Mesh& mesh) {
  const std::uint32_t range = random_range();
  Connectivity found;
  if (connectivity(mesh, range, parts_, found) != Status::ok) {
    return AssertionFailure() << "connectivity finds its scratch too small";
  }
  const std::size_t few = std::min<std::size_t>(points_.size(), 1);
  if (found.parts < few || found.parts > points_.size()) {
    return AssertionFailure() << found.parts << " parts of " << points_.size() << " vertices";
  }
  if (points_.size() > pairs_max) return AssertionSuccess();
  const bool is_right =
      found.parts == parts_of(points_, square_of(range)) && parts_of(points_, found.least) == few &&
      (points_.size() < 2 ||
       found.least == squared_distance(mesh.point(found.from), mesh.point(found.to)));
  return is_right ? AssertionSuccess()
                  : AssertionFailure() << "connectivity is not that of all pairs";
}

AssertionResult AnalysisCheck::features(const Mesh& mesh) {
  std::vector<VertexId> chain;
  std::vector<Relay> relay;
  std::vector<Gap> gap;
  const std::uint32_t range = random_range();
  for (IdValue value = 0; value < mesh.feature_id_end(); ++value) {
    const FeatureId feature{value};
    if (!mesh.is_feature(feature)) continue;
    chain.resize(mesh.chain(feature, {}));
    chain.resize(mesh.chain(feature, chain));
    const FeatureEnds ends = mesh.ends(feature);
    if (chain.size() < 2 || chain.front() != ends.from || chain.back() != ends.to) {
      return AssertionFailure() << "feature " << value << " does not go from end to end";
    }
  }
  const AssertionResult answer = lists(
      "relays", [&](std::span<Relay> out) { return relays(mesh, *devices_, range, out); }, relay);
  if (!answer) return answer;
  if (mesh.feature_count() == 0 && relay.size() + devices_->node_count() != points_.size() &&
      relay.size() < 300) {
    return AssertionFailure()
           << "without features there is a relay for each vertex but the devices";
  }
  return lists(
      "barrier_gaps", [&](std::span<Gap> out) { return barrier_gaps(mesh, *devices_, range, out); },
      gap);
}

AssertionResult AnalysisCheck::coverage(const Mesh& mesh) {
  for (const Mesh* sensors : {&mesh, static_cast<const Mesh*>(&*devices_)}) {
    AssertionResult answer = coverage_in(*sensors, nullptr, Exterior::hull);
    for (const Exterior exterior : {Exterior::hull, Exterior::features, Exterior::automatic}) {
      if (answer) answer = coverage_in(*sensors, &mesh, exterior);
    }
    if (answer) answer = coverage_in(*sensors, &*devices_, Exterior::hull);
    if (!answer) return answer;
  }
  return AssertionSuccess();
}

AssertionResult AnalysisCheck::coverage_in(const Mesh& sensors, const Mesh* where,
                                           Exterior exterior) {
  const std::uint32_t range = random_range();
  Domain domain;
  if (where != nullptr) {
    region_.assign(where->triangle_count(), Region::hole);
    waiting_.resize(region_.size());
    const Point seed = points_.empty() ? Point{} : beside(points_.front(), 1, 1);
    const std::span<const Point> seeds(&seed, random_.below(4) == 0 ? 1 : 0);
    if (label_domain(*where, exterior, seeds, region_, waiting_) != Status::ok) {
      return AssertionFailure() << "label_domain finds its buffers too small";
    }
    domain = {.mesh = where, .region = region_};
  }
  std::vector<Hole> holes;
  const AssertionResult answer = lists(
      "coverage_holes",
      [&](std::span<Hole> out) { return coverage_holes(sensors, domain, range, out); }, holes);
  if (!answer) return answer;
  const bool is_bounded = where != nullptr && where->finite_triangle_count() != 0;
  if (!is_bounded &&
      coverage_holes(sensors, {}, range, {}) != coverage_holes(sensors, domain, range, {})) {
    return AssertionFailure() << "a domain without a triangle is not the hull of the sensors";
  }
  if (!is_bounded && sensors.node_count() < 2 && !holes.empty()) {
    return AssertionFailure() << "a sensor does not see its own place";
  }
  const std::vector<Point> points = points_of(sensors);
  for (const Hole& hole : holes) {
    // Rounded to the nearest sub-unit.
    const SquaredLength nearest = to_nearest(points, hole.position);
    if (nearest < square_of(range, -2) ||
        squared_distance(hole.position, hole.sensor) > square_of(range_for(nearest), 2)) {
      return AssertionFailure() << "a hole is seen, or by another sensor than it names";
    }
  }
  if (is_bounded && holes.empty() && !points.empty()) return is_seen(sensors, domain, range);
  return AssertionSuccess();
}

// The corners and the middle of each triangle of the domain.
AssertionResult AnalysisCheck::is_seen(const Mesh& sensors, const Domain& domain,
                                       std::uint32_t range) {
  const std::vector<Point> points = points_of(sensors);
  if (points.size() * domain.region.size() > pairs_max * pairs_max) return AssertionSuccess();
  for (IdValue value = 0; value < domain.mesh->triangle_count(); ++value) {
    if (domain.region[value] != Region::inside) continue;
    const Triangle triangle = domain.mesh->triangle(TriangleId{value});
    Point middle{};
    for (const VertexId corner : triangle.corner) {
      const Point place = domain.mesh->point(corner);
      middle = {middle.x + place.x / 3, middle.y + place.y / 3};
      if (to_nearest(points, place) > square_of(range)) {
        return AssertionFailure() << "a corner of the domain is beyond the range, and no hole";
      }
    }
    // Rounded, it may lie beside the triangle by as little.
    if (to_nearest(points, middle) > square_of(range, 3)) {
      return AssertionFailure() << "a place of the domain is beyond the range, and no hole";
    }
  }
  return AssertionSuccess();
}

}  // namespace etcm::test
