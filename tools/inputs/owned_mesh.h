// A mesh with memory of its own, for programs that have a heap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "etcm/mesh.h"
#include "inputs/graph.h"

namespace etcm::inputs {

class OwnedMesh {
 public:
  explicit OwnedMesh(const MeshConfig& config);

  // What open() answered. The mesh is usable only if that was ok.
  Status opened() const noexcept { return opened_; }
  Mesh& operator*() noexcept { return mesh_; }
  const Mesh& operator*() const noexcept { return mesh_; }
  Mesh* operator->() noexcept { return &mesh_; }
  const Mesh* operator->() const noexcept { return &mesh_; }

 private:
  std::vector<std::uint64_t> storage_;  // aligned as Mesh::open() asks
  Mesh mesh_;
  Status opened_;
};

// Room for a graph and `steiner_room` Steiner vertices, within the limits of the id width.
MeshConfig config_for(const Graph& graph, std::size_t steiner_room,
                      SplitPolicy policy = split_default);

}  // namespace etcm::inputs
