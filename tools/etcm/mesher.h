// A graph to a mesh, with room that grows until it fits, and the time that took.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>

#include "etcm/files/constraint_graph.h"
#include "etcm/files/grid.h"
#include "etcm/mesh.h"
#include "inputs/owned_mesh.h"

namespace etcm::cli {

// Room for vertices grows up to this (about 1.2 GB), or what the id width allows.
inline constexpr std::uint32_t vertices_max = std::min(std::uint32_t{1} << 24, vertices_limit);

struct MeshingPlan {
  SplitPolicy policy = split_default;
  std::uint32_t steiner_max = 0;   // as in MeshConfig
  unsigned effort = 0;             // to find fewer Steiner vertices than build(): 0 none, up to 9
  std::size_t spare_vertices = 0;  // room left for nodes that come later
  std::size_t spare_features = 0;
};

struct Meshed {
  std::unique_ptr<inputs::OwnedMesh> mesh;
  Status status = Status::ok;  // ok, or the reason why some feature is not conforming
  // Of the build that made the mesh: its nodes, then its features.
  double delaunay_us = 0;
  double conform_us = 0;
  double optimise_us = 0;
};

inline constexpr unsigned effort_most = 9;

// Builds once, and once more each time the room was too small. Throws InputError where the library
// refuses the graph.
Meshed build_mesh(const files::ConstraintGraph& graph, const files::GridGraph& grid,
                  const MeshingPlan& plan);

double microseconds_since(std::chrono::steady_clock::time_point start);

// Why conforming stopped, in one line.
std::string describe_shortfall(const files::ConstraintGraph& graph, const ErrorDetail& error_detail,
                               std::uint32_t unresolved);

}  // namespace etcm::cli
