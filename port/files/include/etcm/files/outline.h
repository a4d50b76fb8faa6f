// The outline of the domain, from its triangles alone.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "etcm/files/mesh_image.h"

namespace etcm::files {

using DirectedEdge = std::pair<std::uint32_t, std::uint32_t>;

// Keeps its memory from one image to the next.
class Outline {
 public:
  // Takes the memory for images of meshes with so many vertices.
  void reserve(std::size_t vertices);

  void find(const MeshImage& image);

  // Edges of exactly one triangle, directed so that it lies on the left. Sorted.
  const std::vector<DirectedEdge>& edges() const { return edges_; }

  // The same as closed loops of vertices; each edge is in one loop. Where loops touch in a vertex,
  // which of them goes on is arbitrary, so fill them with the even-odd rule.
  std::size_t loop_count() const { return loop_ends_.size(); }
  std::span<const std::uint32_t> loop(std::size_t index) const;

 private:
  void find_loops();

  std::vector<DirectedEdge> all_;
  std::vector<DirectedEdge> edges_;
  std::vector<bool> used_;  // by edge
  std::vector<std::uint32_t> vertices_;
  std::vector<std::size_t> loop_ends_;  // in vertices_
};

std::vector<DirectedEdge> outline_edges(const MeshImage& image);

}  // namespace etcm::files
