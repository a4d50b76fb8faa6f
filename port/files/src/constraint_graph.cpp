#include "etcm/files/constraint_graph.h"

#include <algorithm>
#include <filesystem>

#include "etcm/files/record_reader.h"

namespace etcm::files {

namespace {

constexpr std::size_t attributes_max = 1000;

// A count in a file promises records of at least this many bytes each; room for more than that is
// never reserved, so a lying count costs nothing.
std::size_t plausible(std::size_t count, const RecordReader& reader) {
  return std::min(count, reader.bytes_left() / 4 + 1);
}

// The first record of a list says whether the file counts from 0 or 1.
int read_base(const RecordReader& reader, const std::string& what) {
  const std::int64_t first = reader.integer(0, what + " number");
  if (first != 0 && first != 1) {
    reader.fail("the first " + what + " has number " + std::string(reader.field(0)) +
                "; it must be 0 or 1");
  }
  return static_cast<int>(first);
}

void expect_number(const RecordReader& reader, std::int64_t expected, const std::string& what) {
  if (reader.integer(0, what + " number") == expected) return;
  reader.fail(what + " number " + std::string(reader.field(0)) + " stands where " +
              std::to_string(expected) + " must; number them one by one");
}

std::string of(std::size_t index, std::size_t count) {
  return std::to_string(index + 1) + " of " + std::to_string(count);
}

// Returns the number of nodes.
std::size_t read_node_header(RecordReader& reader, ConstraintGraph& graph) {
  reader.require("its first line (nodes, dimension, attributes, markers)");
  reader.expect_fields(1, 4, "the first line");
  const std::size_t count = reader.count(0, "the number of nodes", records_max);
  if (reader.size() > 1 && reader.integer(1, "the dimension") != 2) {
    reader.fail("the dimension is " + std::string(reader.field(1)) + "; it must be 2");
  }
  if (reader.size() > 2) {
    graph.attribute_count = reader.count(2, "the number of attributes", attributes_max);
  }
  if (reader.size() > 3) {
    graph.has_node_markers = reader.count(3, "the number of boundary markers", 1) == 1;
  }
  return count;
}

void read_nodes(RecordReader& reader, std::size_t count, ConstraintGraph& graph) {
  graph.node_file = reader.path();
  graph.nodes.reserve(plausible(count, reader));
  const std::size_t fields = 3 + graph.attribute_count + (graph.has_node_markers ? 1 : 0);
  for (std::size_t i = 0; i < count; ++i) {
    reader.require("node " + of(i, count));
    reader.expect_fields(fields, fields, "this node");
    if (i == 0) graph.index_base = read_base(reader, "node");
    expect_number(reader, graph.node_number(i), "node");
    GraphNode node{reader.number(1, "x"), reader.number(2, "y"), 0, reader.line()};
    for (std::size_t a = 0; a < graph.attribute_count; ++a) {
      (void)reader.number(3 + a, "attribute");
      graph.attributes.emplace_back(reader.field(3 + a));
    }
    if (graph.has_node_markers) node.marker = reader.marker(fields - 1, "the boundary marker");
    graph.nodes.push_back(std::move(node));
  }
}

std::uint32_t read_endpoint(const RecordReader& reader, std::size_t field,
                            const ConstraintGraph& graph) {
  const std::int64_t number = reader.integer(field, "the endpoint");
  const std::int64_t index = number - graph.index_base;
  if (index < 0 || index >= static_cast<std::int64_t>(graph.nodes.size())) {
    if (graph.nodes.empty()) reader.fail("endpoint " + std::to_string(number) + ": no node exists");
    reader.fail("endpoint " + std::to_string(number) + " is no node; nodes run from " +
                std::to_string(graph.index_base) + " to " +
                std::to_string(graph.node_number(graph.nodes.size() - 1)));
  }
  return static_cast<std::uint32_t>(index);
}

void read_features(RecordReader& reader, ConstraintGraph& graph) {
  reader.require("the line that counts the segments");
  reader.expect_fields(1, 2, "the line that counts the segments");
  const std::size_t count = reader.count(0, "the number of segments", records_max);
  if (reader.size() > 1) {
    graph.has_feature_markers = reader.count(1, "the number of boundary markers", 1) == 1;
  }
  graph.features.reserve(plausible(count, reader));
  const std::size_t fields = graph.has_feature_markers ? 4 : 3;
  for (std::size_t i = 0; i < count; ++i) {
    reader.require("segment " + of(i, count));
    reader.expect_fields(fields, fields, "this segment");
    if (i == 0) graph.feature_base = read_base(reader, "segment");
    expect_number(reader, graph.feature_number(i), "segment");
    GraphFeature feature{read_endpoint(reader, 1, graph), read_endpoint(reader, 2, graph), 0,
                         reader.line()};
    if (graph.has_feature_markers) feature.marker = reader.marker(3, "the boundary marker");
    graph.features.push_back(feature);
  }
}

void read_holes(RecordReader& reader, ConstraintGraph& graph) {
  reader.require("the line that counts the holes (write 0 for none)");
  reader.expect_fields(1, 1, "the line that counts the holes");
  const std::size_t count = reader.count(0, "the number of holes", records_max);
  graph.holes.reserve(plausible(count, reader));
  std::int64_t first = 0;
  for (std::size_t i = 0; i < count; ++i) {
    reader.require("hole " + of(i, count));
    reader.expect_fields(3, 3, "this hole");
    if (i == 0) first = read_base(reader, "hole");
    expect_number(reader, first + static_cast<std::int64_t>(i), "hole");
    graph.holes.push_back({reader.number(1, "x"), reader.number(2, "y"), reader.line()});
  }
}

void read_regions(RecordReader& reader, ConstraintGraph& graph) {
  if (!reader.next()) return;
  reader.expect_fields(1, 1, "the line that counts the regional attributes");
  const std::size_t count = reader.count(0, "the number of regional attributes", records_max);
  std::int64_t first = 0;
  for (std::size_t i = 0; i < count; ++i) {
    reader.require("regional attribute " + of(i, count));
    reader.expect_fields(4, 5, "this regional attribute");
    if (i == 0) first = read_base(reader, "regional attribute");
    expect_number(reader, first + static_cast<std::int64_t>(i), "regional attribute");
    GraphRegion region{reader.number(1, "x"), reader.number(2, "y"), {}};
    for (std::size_t f = 3; f < reader.size(); ++f) {
      (void)reader.number(f, "the regional attribute");
      region.values.emplace_back(reader.field(f));
    }
    graph.regions.push_back(std::move(region));
  }
  reader.expect_end();
}

void read_node_file(const std::string& path, ConstraintGraph& graph) {
  RecordReader reader(path);
  const std::size_t count = read_node_header(reader, graph);
  read_nodes(reader, count, graph);
  reader.expect_end();
}

}  // namespace

std::int64_t ConstraintGraph::node_number(std::size_t index) const {
  return static_cast<std::int64_t>(index) + index_base;
}

std::int64_t ConstraintGraph::feature_number(std::size_t index) const {
  return static_cast<std::int64_t>(index) + feature_base;
}

ConstraintGraph read_graph(const std::string& path) {
  ConstraintGraph graph;
  if (without_extension(path, ".node") != path) {
    read_node_file(path, graph);
    return graph;
  }
  RecordReader reader(path);
  graph.poly_file = path;
  const std::size_t count = read_node_header(reader, graph);
  if (count == 0) {
    // The other three numbers of this line mean nothing then; those of the .node hold.
    graph.attribute_count = 0;
    graph.has_node_markers = false;
    const std::string node_path = without_extension(path, ".poly") + ".node";
    if (!std::filesystem::exists(node_path)) {
      reader.fail("no nodes here, so they must stand in " + node_path + ", which does not exist");
    }
    read_node_file(node_path, graph);
  } else {
    read_nodes(reader, count, graph);
  }
  read_features(reader, graph);
  read_holes(reader, graph);
  read_regions(reader, graph);
  return graph;
}

std::string feature_name(const ConstraintGraph& graph, std::size_t feature) {
  const GraphFeature& ends = graph.features[feature];
  return "feature " + std::to_string(graph.feature_number(feature)) + " (" +
         std::to_string(graph.node_number(ends.from)) + "-" +
         std::to_string(graph.node_number(ends.to)) + ")";
}

std::string without_extension(const std::string& path, const std::string& extension) {
  return path.size() > extension.size() && path.ends_with(extension)
             ? path.substr(0, path.size() - extension.size())
             : path;
}

}  // namespace etcm::files
