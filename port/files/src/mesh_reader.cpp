#include <algorithm>
#include <array>

#include "etcm/files/mesh_text.h"
#include "etcm/files/record_reader.h"

namespace etcm::files {

namespace {

// One of Triangle's numbered lists of index tuples (.ele, .edge).
class IndexList {
 public:
  IndexList(const std::string& path, const MeshImage& image) : reader_(path), image_(image) {}

  RecordReader& reader() { return reader_; }

  void expect_number(std::size_t row) const {
    const std::int64_t number = static_cast<std::int64_t>(row) + image_.index_base;
    if (reader_.integer(0, "the number") != number) {
      reader_.fail("number " + std::to_string(number) + " must stand here");
    }
  }

  std::uint32_t index(std::size_t field) const {
    const std::int64_t number = reader_.integer(field, "the vertex");
    const std::int64_t index = number - image_.index_base;
    if (index < 0 || index >= static_cast<std::int64_t>(image_.vertices.size())) {
      reader_.fail("vertex " + std::to_string(number) + " does not exist");
    }
    return static_cast<std::uint32_t>(index);
  }

 private:
  RecordReader reader_;
  const MeshImage& image_;
};

std::int64_t to_subunits(const Decimal& value, const std::string& file, std::size_t line) {
  const Decimal scaled = value * Decimal::of(subunits_per_unit);
  const auto subunits = scaled.to_integer();
  constexpr std::int64_t most = position_max * subunits_per_unit;
  if (!subunits || *subunits < -most || *subunits > most) {
    throw InputError(file, line,
                     "coordinate " + value.to_string() +
                         " is not on the grid of the mesh (a multiple of 2^-28 within 2^24)");
  }
  return *subunits;
}

void take_vertices(const ConstraintGraph& graph, MeshImage& image) {
  image.index_base = graph.index_base;
  image.attribute_count = graph.attribute_count;
  image.attributes = graph.attributes;
  int steiner_marker = -1;
  for (const GraphNode& node : graph.nodes) steiner_marker = std::min(steiner_marker, node.marker);
  for (const GraphNode& node : graph.nodes) {
    image.vertices.push_back({{to_subunits(node.x, graph.node_file, node.line_number),
                               to_subunits(node.y, graph.node_file, node.line_number)},
                              node.marker == steiner_marker,
                              node.marker});
  }
  image.node_count = static_cast<std::uint32_t>(
      std::count_if(image.vertices.begin(), image.vertices.end(),
                    [](const ImageVertex& vertex) { return !vertex.is_steiner; }));
}

void read_triangles(const std::string& path, MeshImage& image) {
  IndexList list(path, image);
  RecordReader& reader = list.reader();
  reader.require("the line that counts the triangles");
  reader.expect_fields(2, 3, "the line that counts the triangles");
  const std::size_t count = reader.count(0, "the number of triangles", 2 * records_max);
  if (reader.integer(1, "the number of corners") != 3) reader.fail("triangles have 3 corners here");
  for (std::size_t i = 0; i < count; ++i) {
    reader.require("triangle " + std::to_string(i + 1) + " of " + std::to_string(count));
    reader.expect_fields(4, 4, "this triangle");
    list.expect_number(i);
    image.triangles.push_back({list.index(1), list.index(2), list.index(3)});
  }
  reader.expect_end();
}

void read_edges(const std::string& path, MeshImage& image) {
  IndexList list(path, image);
  RecordReader& reader = list.reader();
  reader.require("the line that counts the edges");
  reader.expect_fields(2, 2, "the line that counts the edges");
  const std::size_t count = reader.count(0, "the number of edges", 3 * records_max);
  if (reader.integer(1, "the number of markers") != 1) reader.fail("edges have 1 marker here");
  for (std::size_t i = 0; i < count; ++i) {
    reader.require("edge " + std::to_string(i + 1) + " of " + std::to_string(count));
    reader.expect_fields(4, 4, "this edge");
    list.expect_number(i);
    const auto [from, to] = std::minmax({list.index(1), list.index(2)});
    const int marker = reader.marker(3, "the marker");
    const std::pair<std::uint32_t, std::uint32_t> ends(from, to);
    if (i > 0 && ends <= std::pair(image.edges.back().from, image.edges.back().to)) {
      reader.fail("the edges must be sorted, without repetition");
    }
    image.edges.push_back({from, to, marker != 0, marker});
  }
  reader.expect_end();
}

// The files have subsegments alone: a Steiner vertex stands between two of its feature.
std::uint32_t count_features(const MeshImage& image) {
  std::vector<std::uint32_t> degrees(image.vertices.size(), 0);
  for (const ImageSubsegment& each : image.subsegments) {
    ++degrees[each.from];
    ++degrees[each.to];
  }
  auto count = static_cast<std::uint32_t>(image.subsegments.size());
  for (std::size_t i = 0; i < degrees.size(); ++i) {
    if (image.vertices[i].is_steiner && degrees[i] > 1) count -= degrees[i] - 1;
  }
  return count;
}

}  // namespace

MeshImage read_mesh(const std::string& base) {
  const ConstraintGraph graph = read_graph(base + ".poly");
  MeshImage image;
  take_vertices(graph, image);
  read_triangles(base + ".ele", image);
  read_edges(base + ".edge", image);
  for (const GraphFeature& feature : graph.features) {
    const bool is_edge = find_edge(image, feature.from, feature.to) != image.edges.size();
    image.subsegments.push_back({feature.from, feature.to, 0, feature.marker, is_edge});
  }
  image.feature_count = count_features(image);
  image.holes = graph.holes;
  image.regions = graph.regions;
  return image;
}

}  // namespace etcm::files
