// Does a written mesh keep what was promised? From the data of the files alone, with exact
// predicates and none of the library's meshing.
#pragma once

#include <optional>
#include <string>

#include "etcm/files/constraint_graph.h"
#include "etcm/files/grid.h"
#include "etcm/files/mesh_image.h"

namespace etcm::cli {

// The input a mesh claims to be of.
struct Claim {
  const files::ConstraintGraph& graph;
  const files::GridGraph& grid;
  const files::MeshImage& image;

  std::string vertex(std::size_t index) const;               // "vertex 17"
  std::string triangle(std::size_t index) const;             // "triangle 5 (1 2 3)"
  std::string edge(std::size_t from, std::size_t to) const;  // "edge 1-2"
};

// In words, the first rule that is broken, or none:
// nodes are there and unmoved; no two vertices stand at one place; each feature is a chain of
// subsegments that lie exactly on it, and those are all subsegments and hold every added vertex;
// the edges are those of the triangles and subsegments; and, in coverage.h, the triangles.
std::optional<std::string> first_violation(const Claim& claim);

}  // namespace etcm::cli
