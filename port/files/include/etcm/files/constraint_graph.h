// A constraint graph as it stands in Triangle's .poly and .node files, nothing lost: exact
// coordinates, attributes, markers, holes, regional attributes, and the line each came from.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "etcm/files/decimal.h"

namespace etcm::files {

// Most records of one kind in a file: ids are 28 bits wide.
inline constexpr std::size_t records_max = (std::size_t{1} << 28) - 2;

struct GraphNode {
  Decimal x;
  Decimal y;
  int marker = 0;
  std::size_t line_number = 0;
};

struct GraphFeature {
  std::uint32_t from = 0;  // index of a node, from 0 whatever the file's base
  std::uint32_t to = 0;
  int marker = 0;
  std::size_t line_number = 0;
};

struct GraphHole {
  Decimal x;
  Decimal y;
  std::size_t line_number = 0;
};

struct GraphRegion {
  Decimal x;
  Decimal y;
  std::vector<std::string> values;  // attribute and greatest area, as the file has them
};

struct ConstraintGraph {
  std::string node_file;  // where the nodes came from: the .poly itself or its .node
  std::string poly_file;  // empty for a lone .node
  int index_base = 1;     // number of the first node: 0 or 1
  int feature_base = 1;   // number of the first feature
  std::size_t attribute_count = 0;
  bool has_node_markers = false;
  bool has_feature_markers = false;
  std::vector<GraphNode> nodes;
  std::vector<std::string> attributes;  // attribute_count a node, as the file has them
  std::vector<GraphFeature> features;
  std::vector<GraphHole> holes;
  std::vector<GraphRegion> regions;

  // The number a node or feature has in its file.
  std::int64_t node_number(std::size_t index) const;
  std::int64_t feature_number(std::size_t index) const;
};

// Reads a .poly (with the .node of the same name, where it has no nodes itself), or a .node, which
// has no features. Which it is, the extension says. Throws InputError.
ConstraintGraph read_graph(const std::string& path);

// A feature of the graph as a person finds it: "feature 12 (4-9)".
std::string feature_name(const ConstraintGraph& graph, std::size_t feature);

// `path` without its last extension, where that is `extension` (with the dot).
std::string without_extension(const std::string& path, const std::string& extension);

}  // namespace etcm::files
