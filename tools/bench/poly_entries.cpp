#include "bench/poly_entries.h"

#include <filesystem>
#include <optional>

#include "etcm/files/constraint_graph.h"
#include "etcm/files/error.h"

namespace etcm::bench {
namespace {

std::int32_t whole_units(const files::Decimal& value, const files::ConstraintGraph& file,
                         std::size_t line) {
  const std::optional<std::int64_t> units = value.to_integer();
  if (!units || *units < -position_max || *units > position_max) {
    throw files::InputError(file.node_file, line,
                            "coordinate " + value.to_string() +
                                " is no whole number within 2^24; scale the input first");
  }
  return static_cast<std::int32_t>(*units);
}

inputs::Graph read_poly(const std::string& path) {
  const files::ConstraintGraph file = files::read_graph(path);
  inputs::Graph graph;
  graph.name = std::filesystem::path(path).filename().string();
  for (const files::GraphNode& node : file.nodes) {
    graph.nodes.push_back(
        {whole_units(node.x, file, node.line_number), whole_units(node.y, file, node.line_number)});
  }
  for (const files::GraphFeature& feature : file.features) {
    graph.features.push_back(inputs::between_nodes(feature.from, feature.to));
  }
  return graph;
}

}  // namespace

std::vector<inputs::CorpusEntry> read_entries(const std::vector<std::string>& poly_paths) {
  std::vector<inputs::CorpusEntry> entries;
  for (const std::string& path : poly_paths) entries.push_back({"file", read_poly(path)});
  return entries;
}

}  // namespace etcm::bench
