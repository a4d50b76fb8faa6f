// etcm/analysis.h against brute force, on small graphs where much is collinear and cocircular, and
// on the same graphs far out and far apart, where the numbers are longest.
#include "etcm/analysis.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "analysis_oracle.h"
#include "any_graph.h"
#include "support/big_integer.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

// any_graph() as it is, or blown up to the limits of the coordinates.
Graph any_graph_of_any_size() {
  Graph graph = any_graph();
  const std::int32_t scale = *rc::gen::element(1, 1, 1000, position_max / 8);
  for (Position& node : graph.nodes) {
    node = {node.x * scale, node.y * scale};
    // Off the lattice by a little, so that few things are equal but many almost are.
    if (scale == 1000 && node.x > 0) node.x -= node.y / 1000 % 3;
  }
  if (scale == 1000 && !graph.features.empty()) {
    inputs::Placer placer(graph.nodes, 100);
    for (const FeatureEnds& feature : graph.features) {
      placer.try_add(inputs::node_index_of(feature.from), inputs::node_index_of(feature.to));
    }
    graph.features = placer.features();
  }
  return graph;
}

// Devices at some of the nodes, and at places that are none: in the mesh, on it or outside.
std::vector<Position> any_devices(const std::vector<Position>& nodes) {
  const std::uint64_t seed = *rc::gen::inRange<std::uint64_t>(0, 1000);
  const std::size_t more = *rc::gen::inRange<std::size_t>(0, 4);
  const std::size_t of_eight = *rc::gen::inRange<std::size_t>(0, 9);
  inputs::Random random(seed);
  std::vector<Position> devices;
  for (const Position& node : nodes) {
    if (random.index(8) < of_eight) devices.push_back(node);
  }
  for (std::size_t i = 0; i < more && !nodes.empty(); ++i) {
    const auto near = [&](std::int32_t coordinate) {
      const auto off = static_cast<std::int32_t>(random.index(7)) - 3;
      return std::clamp(coordinate + off, -position_max, position_max);
    };
    devices.push_back(
        {near(nodes[random.index(nodes.size())].x), near(nodes[random.index(nodes.size())].y)});
  }
  const auto is_before = [](const Position& a, const Position& b) {
    return std::pair(a.x, a.y) < std::pair(b.x, b.y);
  };
  std::sort(devices.begin(), devices.end(), is_before);
  devices.erase(std::unique(devices.begin(), devices.end()), devices.end());
  return devices;
}

// A range that some of the distances are just within and some just beyond.
std::uint32_t any_range(const std::vector<Point>& points) {
  if (points.size() < 2 || *rc::gen::inRange(0, 8) == 0) return *rc::gen::inRange(1u, 1u << 26);
  const auto a = *rc::gen::elementOf(points), b = *rc::gen::elementOf(points);
  const std::uint32_t range = range_for(squared_distance(a, b));
  return std::max(1u, range / *rc::gen::inRange(1u, 4u) - *rc::gen::inRange(0u, 2u));
}

template <class Entry, class Call>
std::vector<Entry> listed(Call call) {
  std::vector<Entry> entries(static_cast<std::size_t>(call(std::span<Entry>{})));
  RC_ASSERT(call(std::span(entries)) == entries.size());
  return entries;
}

bool is_vertex(const std::vector<Point>& points, const Point& p) {
  return std::find(points.begin(), points.end(), p) != points.end();
}

RC_GTEST_PROP(Analysis, LinksHaveTheirFlagsByDefinition, ()) {
  const auto mesh = any_mesh_of(any_graph_of_any_size());
  const auto points = points_of(**mesh);
  const std::uint32_t limit = *rc::gen::inRange(0, 2) == 0 ? 0 : any_range(points);
  const auto found = listed<Link>([&](std::span<Link> out) { return links(**mesh, limit, out); });
  std::size_t expected = 0;
  for (IdValue value = 1; value < (*mesh)->vertex_id_end(); ++value) {
    const VertexId from{value};
    if ((*mesh)->kind(from) == VertexKind::none) continue;
    std::vector<Neighbour> around((*mesh)->neighbours(from, {}));
    around.resize((*mesh)->neighbours(from, around));
    for (const Neighbour& to : around) {
      const mpq_class length =
          squared(rational((*mesh)->point(from)), rational((*mesh)->point(to.vertex)));
      if (from < to.vertex && length > squared_range(limit)) ++expected;
    }
  }
  RC_ASSERT(found.size() == expected);
  for (const Link& link : found) {
    const Point from = (*mesh)->point(link.from), to = (*mesh)->point(link.to);
    const mpq_class length = squared(rational(from), rational(to));
    const bool is_gabriel = std::none_of(points.begin(), points.end(), [&](const Point& p) {
      return p != from && p != to &&
             squared(rational(from), rational(p)) + squared(rational(to), rational(p)) <= length;
    });
    RC_ASSERT(link.gabriel == is_gabriel);
    bool is_urquhart = true;
    for (IdValue t = 0; t < (*mesh)->triangle_count(); ++t) {
      const Triangle triangle = (*mesh)->triangle(TriangleId{t});
      if (triangle.is_ghost()) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const VertexId a = triangle.corner[(i + 1) % 3], b = triangle.corner[(i + 2) % 3];
        if (!((a == link.from && b == link.to) || (a == link.to && b == link.from))) continue;
        const RationalPoint apex = rational((*mesh)->point(triangle.corner[i]));
        RC_ASSERT(triangle.constrained[i] == link.constrained);
        if (squared(rational(from), apex) < length && squared(rational(to), apex) < length) {
          is_urquhart = false;
        }
      }
    }
    RC_ASSERT(link.urquhart == is_urquhart);
  }
}

RC_GTEST_PROP(Analysis, ConnectivityIsThatOfAllPairs, ()) {
  const auto mesh = any_mesh_of(any_graph_of_any_size());
  const auto points = points_of(**mesh);
  const std::uint32_t range = any_range(points);
  std::vector<ConnectivityScratch> scratch((*mesh)->vertex_id_end());
  Connectivity found;
  RC_ASSERT(connectivity(**mesh, range, scratch, found) == Status::ok);
  RC_ASSERT(integer(found.least) == least_range_squared(points));
  RC_ASSERT(found.parts == parts_at(points, range));
  if (points.size() > 1) {
    const Point from = (*mesh)->point(found.from), to = (*mesh)->point(found.to);
    RC_ASSERT(squared_distance(from, to) == found.least);
    const std::uint32_t enough = range_for(found.least);
    RC_ASSERT(connectivity(**mesh, enough, scratch, found) == Status::ok);
    RC_ASSERT(found.parts == 1u);
    if (enough == 1) return;  // no range is shorter
    RC_ASSERT(connectivity(**mesh, enough - 1, scratch, found) == Status::ok);
    RC_ASSERT(found.parts > 1u);
  }
}

RC_GTEST_PROP(Analysis, RelaysAreAsFewAsTheRangeAllows, ()) {
  const Graph graph = any_graph_of_any_size();
  const auto mesh = any_mesh_of(graph);
  const auto devices = any_mesh_of({"", any_devices(graph.nodes), {}});
  const std::vector<Point> places_of_devices = points_of(**devices);
  const std::uint32_t range = std::max(any_range(points_of(**mesh)), 4u);
  const std::vector<Point> vertices = points_of(**mesh);
  auto expected = static_cast<std::uint64_t>(
      std::count_if(vertices.begin(), vertices.end(),
                    [&](const Point& p) { return !is_vertex(places_of_devices, p); }));
  const std::uint64_t at_vertices = expected;
  for (IdValue value = 0; value < (*mesh)->feature_id_end(); ++value) {
    if (!(*mesh)->is_feature(FeatureId{value})) continue;
    const auto chain = chain_of(**mesh, FeatureId{value});
    for (std::size_t i = 1; i < chain.size(); ++i) {
      const mpz_class length =
          squared(rational((*mesh)->point(chain[i - 1])), rational((*mesh)->point(chain[i])))
              .get_num();
      const mpz_class step = squared_range(range).get_num();
      mpz_class hops = sqrt(mpz_class(length / step));
      while (hops * hops * step < length) ++hops;
      const Point from = (*mesh)->point(chain[i - 1]), to = (*mesh)->point(chain[i]);
      const mpz_class across = (integer(std::abs(to.x - from.x)) + hops - 1) / hops;
      const mpz_class up = (integer(std::abs(to.y - from.y)) + hops - 1) / hops;
      if (across * across + up * up > step) ++hops;
      expected += hops.get_ui() - 1;
    }
  }
  RC_PRE(expected < 200'000u);
  const auto found =
      listed<Relay>([&](std::span<Relay> out) { return relays(**mesh, **devices, range, out); });
  RC_ASSERT(found.size() == expected);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Relay& relay = found[i];
    RC_ASSERT(relay.vertex.is_none() == (i >= at_vertices));
    if (relay.vertex.is_none()) continue;
    RC_ASSERT(relay.position == (*mesh)->point(relay.vertex));
    RC_ASSERT(!is_vertex(places_of_devices, relay.position));
    bool is_on_one = false, is_on_that = false;
    for (IdValue value = 0; value < (*mesh)->feature_id_end(); ++value) {
      if (!(*mesh)->is_feature(FeatureId{value})) continue;
      const auto chain = chain_of(**mesh, FeatureId{value});
      if (std::find(chain.begin(), chain.end(), relay.vertex) == chain.end()) continue;
      is_on_one = true;
      is_on_that |= relay.feature == FeatureId{value};
    }
    RC_ASSERT(relay.feature.is_none() == !is_on_one);
    RC_ASSERT(is_on_that == is_on_one);
  }
  // With them no hop is longer than the range.
  for (IdValue value = 0; value < (*mesh)->feature_id_end(); ++value) {
    const FeatureId feature{value};
    if (!(*mesh)->is_feature(feature)) continue;
    std::vector<Point> places;
    for (const VertexId v : chain_of(**mesh, feature)) places.push_back((*mesh)->point(v));
    for (const Relay& relay : found) {
      if (relay.feature == feature && relay.vertex.is_none()) places.push_back(relay.position);
    }
    // Along the feature: by the coordinate that changes most.
    const FeatureEnds ends = (*mesh)->ends(feature);
    const Point from = (*mesh)->point(ends.from), to = (*mesh)->point(ends.to);
    const bool by_x = std::abs(to.x - from.x) >= std::abs(to.y - from.y);
    std::sort(places.begin(), places.end(),
              [&](const Point& a, const Point& b) { return by_x ? a.x < b.x : a.y < b.y; });
    for (std::size_t i = 1; i < places.size(); ++i) {
      RC_ASSERT(squared(rational(places[i - 1]), rational(places[i])) <= squared_range(range));
    }
  }
}

RC_GTEST_PROP(Analysis, GapsAreWhatSensorsOnTheFeatureDoNotSee, ()) {
  const Graph graph = any_graph_of_any_size();
  const auto mesh = any_mesh_of(graph);
  const bool all_sense = *rc::gen::inRange(0, 4) == 0;
  const auto devices = any_mesh_of({"", any_devices(graph.nodes), {}});
  const Mesh& sensors = all_sense ? **mesh : **devices;
  const auto points = points_of(sensors);
  const std::uint32_t range = any_range(points);
  const auto found =
      listed<Gap>([&](std::span<Gap> out) { return barrier_gaps(**mesh, sensors, range, out); });
  std::size_t expected = 0;
  for (IdValue value = 0; value < (*mesh)->feature_id_end(); ++value) {
    if (!(*mesh)->is_feature(FeatureId{value})) continue;
    const auto chain = chain_of(**mesh, FeatureId{value});
    std::vector<VertexId> stops;
    for (const VertexId v : chain) {
      if (v == chain.front() || v == chain.back() || is_vertex(points, (*mesh)->point(v))) {
        stops.push_back(v);
      }
    }
    for (std::size_t i = 1; i < stops.size(); ++i) {
      const Point from = (*mesh)->point(stops[i - 1]), to = (*mesh)->point(stops[i]);
      const int sensing = (is_vertex(points, from) ? 1 : 0) + (is_vertex(points, to) ? 1 : 0);
      if (squared(rational(from), rational(to)) <= sensing * sensing * squared_range(range)) {
        continue;
      }
      ++expected;
      const auto same = [&](const Gap& gap) {
        return gap.feature == FeatureId{value} &&
               ((gap.from == stops[i - 1] && gap.to == stops[i]) ||
                (gap.to == stops[i - 1] && gap.from == stops[i]));
      };
      const auto gap = std::find_if(found.begin(), found.end(), same);
      RC_ASSERT(gap != found.end());
      const auto places = candidates_on({from, to}, points);
      const bool watched = std::all_of(places.begin(), places.end(), [&](const RationalPoint& p) {
        return !points.empty() && squared_distance_to(points, p) <= squared_range(range);
      });
      RC_ASSERT(gap->watched == watched);
    }
  }
  RC_ASSERT(found.size() == expected);
}

// Where there is no triangle, the domain is the hull of the sensors: that may be a line, or
// nothing.
std::vector<RationalPoint> candidates_of(const Mesh& where, std::span<const Region> region,
                                         const Mesh& sensors, const std::vector<Point>& points) {
  if (points.empty()) return {};
  if (where.finite_triangle_count() > 0) return candidates_in(where, region, points);
  if (sensors.finite_triangle_count() > 0) {
    return candidates_in(sensors, std::vector(sensors.triangle_count(), Region::inside), points);
  }
  const auto [first, last] = std::minmax_element(points.begin(), points.end());
  return candidates_on({*first, *last}, points);
}

// The greatest distance from a place of the domain to its nearest sensor decides, exactly; sensors
// stand at all vertices, at the nodes, or somewhere.
RC_GTEST_PROP(Analysis, NoHolesExactlyIfAllIsCovered, ()) {
  Graph graph = any_graph_of_any_size();
  if (graph.nodes.size() > 12) {
    graph.nodes.resize(12);
    std::erase_if(graph.features, [](const FeatureEnds& feature) {
      return feature.from.value > 12 || feature.to.value > 12;
    });
  }
  const int kind = *rc::gen::inRange(0, 4);
  const auto devices = any_mesh_of({"", kind == 1 ? graph.nodes : any_devices(graph.nodes), {}});
  // At times too few nodes for a triangle.
  const auto few = *rc::gen::inRange<std::size_t>(0, 12);
  if (few < 3 && graph.nodes.size() > few) {
    graph.nodes.resize(few);
    graph.features.clear();
  }
  const auto mesh = any_mesh_of(graph);
  const Mesh& sensors = kind == 0 ? **mesh : **devices;
  const auto points = points_of(sensors);
  // What the domain is: the hull of the sensors, of the mesh, or closed features less holes.
  const int bound = *rc::gen::inRange(0, 3);
  const Mesh& where = bound == 0 ? sensors : **mesh;
  std::vector<Region> region(where.triangle_count());
  std::vector<TriangleId> waiting(region.size());
  std::vector<Point> seeds;
  if (bound == 2 && (*mesh)->node_count() > 3) {
    seeds.push_back(to_point({*rc::gen::inRange(-8, 9), *rc::gen::inRange(-8, 9)}));
  }
  RC_ASSERT(label_domain(where, bound == 2 ? Exterior::features : Exterior::hull, seeds, region,
                         waiting) == Status::ok);
  Domain domain;
  if (bound != 0) domain = {.mesh = &where, .region = region};
  mpq_class greatest = 0;
  for (const RationalPoint& place : candidates_of(where, region, sensors, points)) {
    greatest = std::max(greatest, squared_distance_to(points, place));
  }

  const auto holes_at = [&](std::uint32_t range) {
    return listed<Hole>(
        [&](std::span<Hole> out) { return coverage_holes(sensors, domain, range, out); });
  };
  // The least whole range that covers everything.
  mpz_class exact = sqrt(mpz_class(greatest.get_num() / greatest.get_den())) >> subunit_bits;
  auto enough = static_cast<std::uint32_t>(exact.get_ui());
  while (squared_range(enough) < greatest) ++enough;
  RC_ASSERT(holes_at(std::max(enough, 1u)).empty());
  if (enough > 1) {
    const auto holes = holes_at(enough - 1);
    RC_ASSERT(!holes.empty());
    mpq_class worst = 0;
    for (const Hole& hole : holes) {
      RC_ASSERT(is_vertex(points, hole.sensor));
      worst = std::max(worst, squared(rational(hole.position), rational(hole.sensor)));
    }
    // The worst of them is the worst place there is, up to the rounding of its coordinates.
    const mpz_class seen = sqrt(mpz_class(worst.get_num() / worst.get_den()));
    const mpz_class true_one = sqrt(mpz_class(greatest.get_num() / greatest.get_den()));
    RC_ASSERT(abs(seen - true_one) <= 2);
  }
  const std::uint32_t range = any_range(points);
  for (const Hole& hole : holes_at(range)) {
    // Nobody is nearer than the sensor it names, and that one is out of range.
    const mpq_class nearest = squared_distance_to(points, rational(hole.position));
    const mpz_class distance = sqrt(mpz_class(nearest.get_num()));
    const mpz_class named =
        sqrt(mpz_class(squared(rational(hole.position), rational(hole.sensor)).get_num()));
    RC_ASSERT(abs(named - distance) <= 2);
    RC_ASSERT(distance + 2 >= (mpz_class(range) << subunit_bits));
  }
}

RC_GTEST_PROP(Analysis, ReadingsAreLinearBetweenTheCorners, ()) {
  const auto mesh = any_mesh_of(any_graph_of_any_size());
  std::vector<std::int32_t> readings((*mesh)->vertex_id_end());
  for (std::int32_t& reading : readings) reading = *rc::gen::arbitrary<std::int32_t>();
  // The value at a vertex: at a Steiner vertex between the neighbouring nodes on the feature.
  std::vector<mpq_class> values(readings.begin(), readings.end());
  for (IdValue value = 0; value < (*mesh)->feature_id_end(); ++value) {
    if (!(*mesh)->is_feature(FeatureId{value})) continue;
    const auto chain = chain_of(**mesh, FeatureId{value});
    for (std::size_t i = 0, from = 0; i < chain.size(); ++i) {
      if ((*mesh)->kind(chain[i]) != VertexKind::node) continue;
      const RationalPoint start = rational((*mesh)->point(chain[from]));
      const RationalPoint end = rational((*mesh)->point(chain[i]));
      for (std::size_t k = from + 1; k < i; ++k) {
        const RationalPoint p = rational((*mesh)->point(chain[k]));
        const mpq_class t = start.x != end.x ? mpq_class((p.x - start.x) / (end.x - start.x))
                                             : mpq_class((p.y - start.y) / (end.y - start.y));
        values[chain[k].value] =
            readings[chain[from].value] +
            t * (mpq_class(readings[chain[i].value]) - mpq_class(readings[chain[from].value]));
      }
      from = i;
    }
  }
  const auto check = [&](const Point& place, const mpq_class& expected) {
    Interpolated found;
    RC_ASSERT(interpolate(**mesh, place, readings, found) == Status::ok);
    RC_ASSERT(found.type != LocateType::outside);
    const mpq_class scaled = expected * (mpz_class(1) << subunit_bits) + mpq_class(1, 2);
    mpz_class rounded;
    mpz_fdiv_q(rounded.get_mpz_t(), scaled.get_num_mpz_t(), scaled.get_den_mpz_t());
    RC_ASSERT(integer(found.value) == rounded);
  };
  for (IdValue t = 0; t < (*mesh)->triangle_count(); ++t) {
    const Triangle triangle = (*mesh)->triangle(TriangleId{t});
    if (triangle.is_ghost()) continue;
    std::array<Point, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) corner[i] = (*mesh)->point(triangle.corner[i]);
    const Point place{(corner[0].x + corner[1].x + corner[2].x) / 3,
                      (corner[0].y + corner[1].y + corner[2].y) / 3};
    mpq_class total = 0, weights = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const RationalPoint p = rational(place), a = rational(corner[(i + 1) % 3]),
                          b = rational(corner[(i + 2) % 3]);
      const mpq_class weight = (a.x - p.x) * (b.y - p.y) - (a.y - p.y) * (b.x - p.x);
      RC_PRE(weight >= 0);  // a triangle so thin that no point of the grid is in it
      weights += weight;
      total += weight * values[triangle.corner[i].value];
    }
    check(place, mpq_class(total / weights));
  }
  for (IdValue value = 1; value < (*mesh)->vertex_id_end(); ++value) {
    if ((*mesh)->kind(VertexId{value}) == VertexKind::none) continue;
    check((*mesh)->point(VertexId{value}), values[value]);
  }
}

}  // namespace
}  // namespace etcm::test
