#include "etcm/files/mesh_image.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace etcm::files {

namespace {

constexpr std::uint32_t unnumbered = static_cast<std::uint32_t>(-1);

double length(const Point& a, const Point& b) {
  return std::hypot(static_cast<double>(b.x - a.x), static_cast<double>(b.y - a.y));
}

// How far along the feature from -> to the point on it lies, 0 to 1.
double fraction(const Point& from, const Point& to, const Point& point) {
  const double whole = length(from, to);
  return whole > 0 ? length(from, point) / whole : 0;
}

void carry_attributes(const ConstraintGraph& graph, MeshImage& image) {
  image.attribute_count = graph.attribute_count;
  image.attributes = graph.attributes;
  image.attributes.resize(image.vertices.size() * graph.attribute_count, "0");
  for (const ImageSubsegment& subsegment : image.subsegments) {
    if (subsegment.feature >= graph.features.size() || !image.vertices[subsegment.to].is_steiner)
      continue;
    const GraphFeature& feature = graph.features[subsegment.feature];
    const double along =
        fraction(image.vertices[feature.from].point, image.vertices[feature.to].point,
                 image.vertices[subsegment.to].point);
    for (std::size_t a = 0; a < graph.attribute_count; ++a) {
      const auto value = [&](std::size_t node) {
        return Decimal::parse(graph.attributes[node * graph.attribute_count + a])->to_double();
      };
      const double from = value(feature.from);
      std::string text;
      TextSink(text) << from + (value(feature.to) - from) * along;
      image.attributes[subsegment.to * graph.attribute_count + a] = std::move(text);
    }
  }
}

void carry_markers(const ConstraintGraph& graph, MeshImage& image) {
  int steiner_marker = -1;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    image.vertices[i].marker = graph.nodes[i].marker;
    steiner_marker = std::min(steiner_marker, graph.nodes[i].marker - 1);
  }
  for (ImageVertex& vertex : image.vertices) {
    if (vertex.is_steiner) vertex.marker = steiner_marker;
  }
  for (ImageSubsegment& subsegment : image.subsegments) {
    if (subsegment.feature >= graph.features.size()) continue;
    subsegment.marker = graph.features[subsegment.feature].marker;
    if (!subsegment.is_edge || subsegment.marker == 0) continue;
    image.edges[find_edge(image, subsegment.from, subsegment.to)].marker = subsegment.marker;
  }
}

class Imager {
 public:
  Imager(const Mesh& mesh, Exterior exterior, std::span<const Point> holes);

  MeshImage take() { return std::move(image_); }

 private:
  void add_vertex(VertexId id, bool is_steiner);
  void add_nodes();
  void add_features();
  void label(Exterior exterior, std::span<const Point> holes);
  void add_triangles();
  void mark_edges();

  const Mesh& mesh_;
  MeshImage image_;
  std::vector<std::uint32_t> index_of_;  // by vertex id
  std::vector<Region> region_;           // by triangle
};

Imager::Imager(const Mesh& mesh, Exterior exterior, std::span<const Point> holes)
    : mesh_(mesh),
      index_of_(mesh.vertex_id_end(), unnumbered),
      region_(mesh.triangle_count(), Region::outside) {
  add_nodes();
  add_features();
  label(exterior, holes);
  add_triangles();
  mark_edges();
}

void Imager::add_vertex(VertexId id, bool is_steiner) {
  index_of_[id.value] = static_cast<std::uint32_t>(image_.vertices.size());
  image_.vertices.push_back({mesh_.point(id), is_steiner, is_steiner ? -1 : 0});
}

void Imager::add_nodes() {
  for (std::uint32_t i = 1; i < mesh_.vertex_id_end(); ++i) {
    const VertexId id(static_cast<IdValue>(i));
    if (mesh_.kind(id) == VertexKind::node) add_vertex(id, false);
  }
  image_.node_count = static_cast<std::uint32_t>(image_.vertices.size());
}

void Imager::add_features() {
  std::vector<VertexId> chain;
  for (std::uint32_t f = 0; f < mesh_.feature_id_end(); ++f) {
    const FeatureId feature(static_cast<IdValue>(f));
    if (!mesh_.is_feature(feature)) continue;
    ++image_.feature_count;
    chain.resize(mesh_.chain(feature, {}));
    (void)mesh_.chain(feature, chain);
    for (std::size_t i = 0; i < chain.size(); ++i) {
      if (index_of_[chain[i].value] == unnumbered) add_vertex(chain[i], true);
      if (i == 0) continue;
      image_.subsegments.push_back(
          {index_of_[chain[i - 1].value], index_of_[chain[i].value], f, 0, false});
    }
  }
}

void Imager::label(Exterior exterior, std::span<const Point> holes) {
  if (mesh_.finite_triangle_count() == 0) return;
  std::vector<TriangleId> waiting(region_.size());
  // Both buffers have the size it asks for, so it cannot reject them.
  (void)label_domain(mesh_, exterior, holes, region_, waiting);
}

void Imager::add_triangles() {
  const bool is_flat = mesh_.finite_triangle_count() == 0;
  const auto is_inside = [&](TriangleId id) { return region_[id.value] == Region::inside; };
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    const TriangleId id(static_cast<IdValue>(t));
    const Triangle triangle = mesh_.triangle(id);
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexId from = triangle.corner[(i + 1) % 3];
      const VertexId to = triangle.corner[(i + 2) % 3];
      if (from == infinite_vertex || to == infinite_vertex) continue;
      const bool is_wanted = is_flat || triangle.constrained[i];
      // Each edge has two triangles: the first one that wants it adds it.
      const TriangleId other = triangle.neighbour[i];
      if (other.value < t && (is_wanted || is_inside(other))) continue;
      if (!is_wanted && !is_inside(id)) continue;
      const std::uint32_t a = index_of_[from.value];
      const std::uint32_t b = index_of_[to.value];
      const bool is_constrained = triangle.constrained[i];
      image_.edges.push_back({std::min(a, b), std::max(a, b), is_constrained, is_constrained});
    }
    if (!is_inside(id)) continue;
    std::array<std::uint32_t, 3> corner{};
    for (std::size_t i = 0; i < 3; ++i) corner[i] = index_of_[triangle.corner[i].value];
    std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
    image_.triangles.push_back(corner);
  }
  std::sort(image_.triangles.begin(), image_.triangles.end());
  std::sort(image_.edges.begin(), image_.edges.end(), [](const ImageEdge& a, const ImageEdge& b) {
    return std::pair(a.from, a.to) < std::pair(b.from, b.to);
  });
}

void Imager::mark_edges() {
  for (ImageSubsegment& subsegment : image_.subsegments) {
    subsegment.is_edge = find_edge(image_, subsegment.from, subsegment.to) != image_.edges.size();
  }
}

}  // namespace

std::size_t find_edge(const MeshImage& image, std::uint32_t a, std::uint32_t b) {
  const std::pair<std::uint32_t, std::uint32_t> ends(std::min(a, b), std::max(a, b));
  const auto edge = std::lower_bound(
      image.edges.begin(), image.edges.end(), ends,
      [](const ImageEdge& e, const auto& key) { return std::pair(e.from, e.to) < key; });
  const bool found = edge != image.edges.end() && std::pair(edge->from, edge->to) == ends;
  return found ? static_cast<std::size_t>(edge - image.edges.begin()) : image.edges.size();
}

std::uint32_t MeshImage::unresolved_count() const {
  return static_cast<std::uint32_t>(
      std::count_if(subsegments.begin(), subsegments.end(),
                    [](const ImageSubsegment& subsegment) { return !subsegment.is_edge; }));
}

MeshImage image_of(const Mesh& mesh, Exterior exterior, std::span<const Point> holes) {
  MeshImage image = Imager(mesh, exterior, holes).take();
  image.mesh_hash = mesh.hash();
  return image;
}

void carry_through(const ConstraintGraph& graph, const Placement& placement, MeshImage& image) {
  image.index_base = graph.index_base;
  carry_attributes(graph, image);
  carry_markers(graph, image);
  const std::optional<Decimal>& scale = placement.scale;
  const auto scaled = [&](const Decimal& value) { return scale ? value * *scale : value; };
  for (const GraphHole& hole : graph.holes) {
    image.holes.push_back({scaled(hole.x), scaled(hole.y), hole.line_number});
  }
  for (const GraphRegion& region : graph.regions) {
    image.regions.push_back({scaled(region.x), scaled(region.y), region.values});
  }
  if (scale) {
    image.unit_note = "coordinates are " + scale->to_string() + " times those of the input";
  }
  if (placement.round) {
    image.unit_note += scale ? ", rounded" : "coordinates are those of the input, rounded";
  }
}

Quality quality_of(const MeshImage& image) {
  Quality sum;
  for (const auto& triangle : image.triangles) {
    const Point& a = image.vertices[triangle[0]].point;
    const Point& b = image.vertices[triangle[1]].point;
    const Point& c = image.vertices[triangle[2]].point;
    const std::array<double, 3> side = {length(b, c), length(c, a), length(a, b)};
    const double double_area = static_cast<double>(b.x - a.x) * static_cast<double>(c.y - a.y) -
                               static_cast<double>(b.y - a.y) * static_cast<double>(c.x - a.x);
    const auto [least, most] = std::minmax_element(side.begin(), side.end());
    sum.mean_edge_ratio += *least / *most;
    // r / R = (area / half perimeter) / (abc / (4 area)).
    sum.mean_radius_ratio +=
        2 * double_area * double_area / (side[0] + side[1] + side[2]) / side[0] / side[1] / side[2];
  }
  const double count = std::max<double>(1, static_cast<double>(image.triangles.size()));
  return {sum.mean_edge_ratio / count, sum.mean_radius_ratio / count};
}

}  // namespace etcm::files
