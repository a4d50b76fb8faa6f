// From the decimals of a file to the integer grid of the mesh, never silently.
#pragma once

#include <optional>
#include <vector>

#include "etcm/files/constraint_graph.h"
#include "etcm/mesh.h"

namespace etcm::files {

struct Placement {
  std::optional<Decimal> scale;  // multiplies every coordinate
  bool round = false;            // then takes the nearest integer
};

// What Mesh::build and label_domain take. Node and feature i are those of the graph.
struct GridGraph {
  std::vector<Position> nodes;
  std::vector<FeatureEnds> features;
  // Holes on the sub-unit grid (nearest place). Those beyond every node are left out.
  std::vector<Point> holes;
};

// Throws InputError for a coordinate that is no integer (after scaling, unless rounded) or out of
// range.
Position place_on_grid(const std::string& file, std::size_t line, const Decimal& x,
                       const Decimal& y, const Placement& placement);
GridGraph place_on_grid(const ConstraintGraph& graph, const Placement& placement);

// A coordinate of any place, scaled and taken to the nearest sub-unit. None where it is out of the
// range of positions.
std::optional<std::int64_t> subunits_of(const Decimal& coordinate, const Placement& placement);

// One line on why Mesh::build() refused the graph, with the place in its file. For the statuses
// that blame the input.
std::string describe_refusal(const ConstraintGraph& graph, const GridGraph& grid,
                             const ErrorDetail& error_detail);

}  // namespace etcm::files
