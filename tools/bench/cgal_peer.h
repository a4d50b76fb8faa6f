// CGAL as the yardstick. No CGAL type leaves this header, so only one file pays for compiling it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "inputs/graph.h"

namespace etcm::bench {

// Builds the Delaunay mesh of the nodes (spatially sorted insertion) and returns its vertex count.
std::size_t cgal_delaunay(std::span<const Position> nodes);

// Builds the constrained Delaunay mesh of the graph, makes it conforming, and returns its vertex
// count: what it added is that less the nodes.
std::size_t cgal_conforming(const inputs::Graph& graph);

// A conforming mesh that nodes are inserted into.
class CgalMesh {
 public:
  explicit CgalMesh(const inputs::Graph& graph);
  ~CgalMesh();
  void insert_and_conform(Position position);

 private:
  struct Triangulation;
  std::unique_ptr<Triangulation> triangulation_;
};

}  // namespace etcm::bench
