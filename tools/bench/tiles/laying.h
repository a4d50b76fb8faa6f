// What the laying of a feature can depend on, and what it does. lib/docs/tiles.md says why the
// first is enough.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/tiles/quad_tree.h"
#include "etcm/mesh.h"
#include "inputs/graph.h"

namespace etcm::bench {

// The triangles of a mesh whose closed circumdisks come inside of a line between two of its nodes
// (for a ghost the half-plane behind its edge). In double, and what is in doubt is counted: may
// have some that only nearly touch, and lacks none.
class Touching {
 public:
  explicit Touching(const Mesh& mesh);
  // By increasing id. O(what is found).
  std::vector<std::uint32_t> triangles(VertexId from, VertexId to);

 private:
  bool touches(const Triangle& triangle, const Point& from, const Point& to) const;

  const Mesh& mesh_;
  std::vector<std::uint32_t> triangle_at_;  // of each vertex, one of those around it
  std::vector<std::uint32_t> seen_;         // of each triangle, the call that has met it
  std::uint32_t call_ = 0;
};

// Of each feature, by its place in the graph.
struct Reads {
  // Triangles of the nodes' mesh: those whose disks touch the line, and the neighbours of these.
  // Each circle that touches the line and is empty of nodes is inside of their disks.
  std::vector<std::vector<std::uint32_t>> triangles;
  // The feature and all that its laying can depend on, sorted: with each feature those whose lines
  // come into these disks. Those that share an end with it are among them, for a circle through
  // that end comes inside of all lines that leave it within a right angle of its centre.
  std::vector<std::vector<std::uint32_t>> closed;
};
// `nodes` is the mesh of the graph's nodes alone.
Reads reads_of(const inputs::Graph& graph, const Mesh& nodes);

// Of each feature, by its place in the graph, how many are in its group by the Steiner vertices
// that stand in the end (lib/docs/one-mesh.md).
std::vector<std::uint32_t> group_sizes(const inputs::Graph& graph, const Mesh& whole);

// Whether some features, laid in a mesh of no nodes but the corners of what they read, come to the
// Steiner vertices that they have in the one mesh.
bool is_laid_alike(const inputs::Graph& graph, const Mesh& nodes, const Mesh& whole,
                   const Reads& reads, const std::vector<std::uint32_t>& features);

}  // namespace etcm::bench
