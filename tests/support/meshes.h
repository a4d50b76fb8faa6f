// Meshes for tests, and ways to tell them apart.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <ostream>
#include <span>
#include <vector>

#include "etcm/mesh.h"
#include "inputs/graph.h"
#include "inputs/owned_mesh.h"

namespace etcm {

// GoogleTest prints these by argument-dependent lookup.
void PrintTo(Status status, std::ostream* out);
void PrintTo(Position position, std::ostream* out);

}  // namespace etcm

namespace etcm::test {

using inputs::between_nodes;
using inputs::Graph;
using inputs::OwnedMesh;
using inputs::vertex_of;

inline constexpr std::size_t default_steiner_room = 1500;

// Its last node is on the edge between the first two.
inline const std::vector<Position> square{{0, 0}, {10, 0}, {10, 10}, {0, 10}, {5, 0}};

// An open, empty mesh.
std::unique_ptr<OwnedMesh> empty_mesh(std::uint32_t vertices_max = 2000,
                                      std::uint32_t features_max = 500,
                                      SplitPolicy policy = split_default);

// The mesh of a graph; a test failure, and whatever then stands, if build() does not answer ok.
std::unique_ptr<OwnedMesh> built(const Graph& graph, SplitPolicy policy = split_default,
                                 std::size_t steiner_room = default_steiner_room);

// The mesh of nodes that join one by one, and features after them.
std::unique_ptr<OwnedMesh> grown(const Graph& graph, SplitPolicy policy = split_default,
                                 std::size_t steiner_room = default_steiner_room);

// Everything that a caller can tell a mesh by: ids, places, features, and the hash of the rest.
struct Picture {
  struct Standing {
    VertexId vertex;
    VertexKind kind;
    Point point;
    friend bool operator==(const Standing&, const Standing&) = default;
  };
  struct Line {
    FeatureId feature;
    VertexId from;
    VertexId to;
    friend bool operator==(const Line&, const Line&) = default;
  };
  std::uint64_t hash = 0;
  std::vector<Standing> vertices;
  std::vector<Line> features;
  friend bool operator==(const Picture&, const Picture&) = default;
};
Picture picture_of(const Mesh& mesh);

// The nodes and features that stand in a mesh, as input for a fresh one.
Graph graph_of(const Mesh& mesh);

// The same graph with its nodes and features in another order, and every other feature from its
// other end.
Graph shuffled(const Graph& graph, std::uint64_t seed);

// All Steiner vertices, in order of id.
std::vector<VertexId> steiner_vertices(const Mesh& mesh);

}  // namespace etcm::test
