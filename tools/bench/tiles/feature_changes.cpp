#include "bench/tiles/feature_changes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <stdexcept>
#include <vector>

#include "bench/tiles/triangle_sum.h"
#include "inputs/owned_mesh.h"
#include "inputs/random.h"

namespace etcm::bench {

namespace {

using Places = std::set<Point>;

Places steiner_except(const Mesh& mesh, FeatureId except) {
  Places places;
  for (std::uint32_t i = 1; i < mesh.vertex_id_end(); ++i) {
    const VertexId vertex{static_cast<IdValue>(i)};
    if (mesh.kind(vertex) == VertexKind::steiner && mesh.feature_of(vertex) != except) {
      places.insert(mesh.point(vertex));
    }
  }
  return places;
}

Position place_of(const Point& point) {
  return {.x = static_cast<std::int32_t>(point.x / subunits_per_unit),
          .y = static_cast<std::int32_t>(point.y / subunits_per_unit)};
}

Square box_of(Position a, Position b, std::int32_t margin) {
  return {.low = {.x = std::min(a.x, b.x) - margin, .y = std::min(a.y, b.y) - margin},
          .high = {.x = std::max(a.x, b.x) + margin, .y = std::max(a.y, b.y) + margin}};
}

double distance(const Square& box, Position place) {
  const double x = std::max({box.low.x - place.x, place.x - box.high.x, 0});
  const double y = std::max({box.low.y - place.y, place.y - box.high.y, 0});
  return std::hypot(x, y);
}

bool overlap(const Square& a, const Square& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y;
}

// The nodes around the tile, the features whose boxes come there, and their ends.
inputs::Graph known_around(const inputs::Graph& graph, const Square& tile, std::int32_t reach) {
  const Square around = box_of(tile.low, tile.high, reach);
  std::vector<bool> is_known;
  for (const Position node : graph.nodes) is_known.push_back(distance(around, node) == 0);
  std::vector<FeatureEnds> features;
  for (const FeatureEnds& ends : graph.features) {
    const std::size_t from = inputs::node_index_of(ends.from), to = inputs::node_index_of(ends.to);
    if (!overlap(box_of(graph.nodes[from], graph.nodes[to], 0), around)) continue;
    is_known[from] = is_known[to] = true;
    features.push_back(ends);
  }
  inputs::Graph known;
  std::vector<VertexId> name(graph.nodes.size());
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (!is_known[i]) continue;
    name[i] = inputs::vertex_of(known.nodes.size());
    known.nodes.push_back(graph.nodes[i]);
  }
  for (const FeatureEnds& ends : features) {
    known.features.push_back(
        {name[inputs::node_index_of(ends.from)], name[inputs::node_index_of(ends.to)]});
  }
  return known;
}

void take_out(Mesh& mesh, FeatureId feature) {
  if (mesh.remove_feature(feature) != Status::ok || mesh.canonicalize() != Status::ok) {
    throw std::runtime_error("a feature cannot be taken out");
  }
}

void put_back(Mesh& mesh, FeatureEnds ends) {
  FeatureId feature;
  if (mesh.add_feature(ends, feature) != Status::ok || mesh.canonicalize() != Status::ok) {
    throw std::runtime_error("a feature cannot be put back");
  }
}

}  // namespace

Changes changes_without(const inputs::Graph& graph, Mesh& whole, const QuadTree& tree,
                        std::size_t samples, std::int32_t spacing, std::uint64_t seed) {
  Changes changes;
  inputs::Random random(seed);
  for (std::size_t sample = 0; sample < samples; ++sample) {
    const FeatureId feature{static_cast<IdValue>(random.index(graph.features.size()))};
    const FeatureEnds ends = whole.ends(feature);
    const Position from = whole.position(ends.from), to = whole.position(ends.to);
    const Places with = steiner_except(whole, feature);
    take_out(whole, feature);
    const Places without = steiner_except(whole, FeatureId::none());
    put_back(whole, ends);
    std::vector<Point> other;
    std::set_symmetric_difference(with.begin(), with.end(), without.begin(), without.end(),
                                  std::back_inserter(other));
    std::set<std::uint32_t> tiles{tree.cell_of(morton_code(from)), tree.cell_of(morton_code(to))};
    double farthest = 0;
    for (const Point& point : other) {
      const Position place = place_of(point);
      tiles.insert(tree.cell_of(morton_code(place)));
      farthest = std::max(farthest, distance(box_of(from, to, 0), place));
    }
    changes.lone += other.empty() ? 1 : 0;
    changes.tiles.add(static_cast<double>(tiles.size()));
    changes.spacings.add(farthest / spacing);
  }
  return changes;
}

std::optional<std::int32_t> least_knowledge(const inputs::Graph& graph, const Mesh& whole,
                                            const Square& tile, std::int32_t spacing) {
  const TriangleSum right = triangles_in(whole, tile);
  std::optional<std::int32_t> least;
  for (const std::int32_t spacings : {1, 2, 3, 4, 6, 8, 12, 16, 24, 32}) {
    const inputs::Graph known = known_around(graph, tile, spacings * spacing);
    inputs::OwnedMesh mesh(inputs::config_for(known, 2 * known.nodes.size() + 1000));
    if (mesh->build(known.nodes, known.features) != Status::ok) {
      throw std::runtime_error("a tile with features fails");
    }
    const bool is_right = triangles_in(*mesh, tile) == right;
    if (!is_right) least.reset();
    if (is_right && !least) least = spacings;
  }
  return least;
}

}  // namespace etcm::bench
