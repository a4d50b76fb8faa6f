#include "bench/tiles/laying.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>

#include "etcm/predicates.h"
#include "inputs/owned_mesh.h"

namespace etcm::bench {

namespace {

using Numbers = std::vector<std::uint32_t>;

// What touches within this part of a circle's size is in doubt, and below this sine of an angle all
// of a triangle is.
constexpr double doubt = 1e-8;
constexpr double least_sine = 1e-5;

struct Offset {
  double x, y;
};
Offset offset(const Point& to, const Point& from) {
  return {.x = static_cast<double>(to.x - from.x), .y = static_cast<double>(to.y - from.y)};
}
double cross(Offset a, Offset b) { return a.x * b.y - a.y * b.x; }
double dot(Offset a, Offset b) { return a.x * b.x + a.y * b.y; }

void sort_out(Numbers& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

// Sets that grow together.
class Groups {
 public:
  explicit Groups(std::size_t count) : up_(count) { std::iota(up_.begin(), up_.end(), 0u); }
  std::uint32_t of(std::uint32_t i) {
    while (up_[i] != i) i = up_[i] = up_[up_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { up_[of(a)] = of(b); }

 private:
  Numbers up_;
};

// From one feature on.
Numbers closure(const std::vector<Numbers>& next, std::uint32_t first, Numbers& seen_by) {
  Numbers found{first};
  seen_by[first] = first + 1;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const std::uint32_t other : next[found[i]]) {
      if (seen_by[other] == first + 1) continue;
      seen_by[other] = first + 1;
      found.push_back(other);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<Point> steiner_on(const Mesh& mesh, FeatureId feature) {
  std::vector<VertexId> chain(mesh.chain(feature, {}));
  static_cast<void>(mesh.chain(feature, chain));
  std::vector<Point> places;
  places.reserve(chain.size());
  for (const VertexId vertex : chain) places.push_back(mesh.point(vertex));
  return places;
}

}  // namespace

Touching::Touching(const Mesh& mesh)
    : mesh_(mesh), triangle_at_(mesh.vertex_id_end()), seen_(mesh.triangle_count()) {
  for (std::uint32_t i = 0; i < mesh.triangle_count(); ++i) {
    for (const VertexId vertex : mesh.triangle(TriangleId{static_cast<IdValue>(i)}).corner) {
      triangle_at_[vertex.value] = i;
    }
  }
}

bool Touching::touches(const Triangle& triangle, const Point& from, const Point& to) const {
  std::array<Point, 3> corner{};
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexId vertex = triangle.corner[i];
    if (vertex != infinite_vertex) {
      corner[i] = mesh_.point(vertex);
      continue;
    }
    // No node is behind the edge, so a line comes there only along it.
    const Point a = mesh_.point(triangle.corner[(i + 1) % 3]);
    const Point b = mesh_.point(triangle.corner[(i + 2) % 3]);
    return orient2d(a, b, from) == 0 && orient2d(a, b, to) == 0;
  }
  const Offset b = offset(corner[1], corner[0]), c = offset(corner[2], corner[0]);
  const double bb = dot(b, b), cc = dot(c, c), area = cross(b, c);
  if (!(area * area > least_sine * least_sine * bb * cc)) return true;
  const Offset centre{.x = (bb * c.y - cc * b.y) / (2 * area),
                      .y = (cc * b.x - bb * c.x) / (2 * area)};
  const Offset start = offset(from, corner[0]), along = offset(to, from);
  const Offset way{.x = start.x - centre.x, .y = start.y - centre.y};
  // The disk has no node inside: where its centre is beside no place of the line, it meets at most
  // an end of it.
  const double length = dot(along, along), nearest = -dot(way, along), aside = cross(way, along);
  if (nearest < -doubt * length || nearest > (1 + doubt) * length) return false;
  return aside * aside <= dot(centre, centre) * length * (1 + doubt);
}

Numbers Touching::triangles(VertexId from, VertexId to) {
  const Point start = mesh_.point(from), end = mesh_.point(to);
  ++call_;
  // All around one end, as those that touch hang together but not with each of these.
  Numbers found, open{triangle_at_[from.value]};
  seen_[open.front()] = call_;
  while (!open.empty()) {
    const std::uint32_t number = open.back();
    open.pop_back();
    const Triangle triangle = mesh_.triangle(TriangleId{static_cast<IdValue>(number)});
    const bool is_touching = touches(triangle, start, end);
    if (is_touching) found.push_back(number);
    for (std::size_t i = 0; i < 3; ++i) {
      const bool is_around =
          triangle.corner[i] != from &&
          (triangle.corner[0] == from || triangle.corner[1] == from || triangle.corner[2] == from);
      const std::uint32_t next = triangle.neighbour[i].value;
      if ((!is_touching && !is_around) || seen_[next] == call_) continue;
      seen_[next] = call_;
      open.push_back(next);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

Reads reads_of(const inputs::Graph& graph, const Mesh& nodes) {
  Touching touching(nodes);
  std::vector<Numbers> touched, lines(nodes.triangle_count());
  Reads reads;
  for (std::uint32_t i = 0; i < graph.features.size(); ++i) {
    touched.push_back(touching.triangles(graph.features[i].from, graph.features[i].to));
    for (const std::uint32_t triangle : touched[i]) lines[triangle].push_back(i);
  }
  std::vector<Numbers> next(graph.features.size());
  for (std::uint32_t i = 0; i < graph.features.size(); ++i) {
    Numbers read = touched[i];
    for (const std::uint32_t triangle : touched[i]) {
      for (const TriangleId beside :
           nodes.triangle(TriangleId{static_cast<IdValue>(triangle)}).neighbour) {
        read.push_back(beside.value);
      }
    }
    sort_out(read);
    for (const std::uint32_t triangle : read) {
      next[i].insert(next[i].end(), lines[triangle].begin(), lines[triangle].end());
    }
    sort_out(next[i]);
    reads.triangles.push_back(std::move(read));
  }
  Numbers seen_by(graph.features.size());
  for (std::uint32_t i = 0; i < graph.features.size(); ++i) {
    reads.closed.push_back(closure(next, i, seen_by));
  }
  return reads;
}

Numbers group_sizes(const inputs::Graph& graph, const Mesh& whole) {
  Touching touching(whole);
  Groups groups(graph.features.size());
  for (std::uint32_t i = 0; i < graph.features.size(); ++i) {
    for (const std::uint32_t number :
         touching.triangles(graph.features[i].from, graph.features[i].to)) {
      for (const VertexId vertex :
           whole.triangle(TriangleId{static_cast<IdValue>(number)}).corner) {
        if (whole.kind(vertex) != VertexKind::steiner) continue;
        groups.join(whole.feature_of(vertex).value, i);
      }
    }
  }
  // Neighbours on different features are in one group: a disk that has both touches both lines.
  Numbers count(graph.features.size()), sizes;
  for (std::uint32_t i = 0; i < count.size(); ++i) ++count[groups.of(i)];
  for (std::uint32_t i = 0; i < count.size(); ++i) sizes.push_back(count[groups.of(i)]);
  return sizes;
}

bool is_laid_alike(const inputs::Graph& graph, const Mesh& nodes, const Mesh& whole,
                   const Reads& reads, const Numbers& features) {
  Numbers known;
  for (const std::uint32_t feature : features) {
    for (const std::uint32_t number : reads.triangles[feature]) {
      for (const VertexId vertex :
           nodes.triangle(TriangleId{static_cast<IdValue>(number)}).corner) {
        if (vertex != infinite_vertex) known.push_back(vertex.value);
      }
    }
  }
  sort_out(known);
  inputs::Graph part;
  for (const std::uint32_t node : known) part.nodes.push_back(graph.nodes[node - 1]);
  const auto vertex_in_part = [&](VertexId vertex) {
    const auto at = std::lower_bound(known.begin(), known.end(), vertex.value);
    return inputs::vertex_of(static_cast<std::size_t>(at - known.begin()));
  };
  for (const std::uint32_t feature : features) {
    const FeatureEnds ends = graph.features[feature];
    part.features.push_back({vertex_in_part(ends.from), vertex_in_part(ends.to)});
  }
  inputs::OwnedMesh mesh(inputs::config_for(part, 2 * whole.steiner_count() + std::size_t{1000}));
  if (mesh->build(part.nodes, part.features) != Status::ok) {
    throw std::runtime_error("a part with features fails");
  }
  for (std::uint32_t i = 0; i < features.size(); ++i) {
    const auto alone = steiner_on(*mesh, FeatureId{static_cast<IdValue>(i)});
    if (alone != steiner_on(whole, FeatureId{static_cast<IdValue>(features[i])})) return false;
  }
  return true;
}

}  // namespace etcm::bench
