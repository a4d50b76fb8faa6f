// A mesh as plain data, in the order in which it is written: what every writer takes, whether it
// comes from a live Mesh or from files.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "etcm/domain.h"
#include "etcm/files/constraint_graph.h"
#include "etcm/files/grid.h"
#include "etcm/mesh.h"

namespace etcm::files {

struct ImageVertex {
  Point point;
  bool is_steiner = false;
  int marker = 0;
  friend bool operator==(const ImageVertex&, const ImageVertex&) = default;
};

struct ImageEdge {
  std::uint32_t from = 0;  // the lower index
  std::uint32_t to = 0;
  bool is_constrained = false;
  int marker = 0;
  friend bool operator==(const ImageEdge&, const ImageEdge&) = default;
};

struct ImageSubsegment {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::uint32_t feature = 0;  // the FeatureId
  int marker = 0;
  bool is_edge = true;  // false: unresolved
  friend bool operator==(const ImageSubsegment&, const ImageSubsegment&) = default;
};

// Where a vertex is on the earth, in 10^-9 of a degree (WGS 84).
struct ImageDegrees {
  std::int64_t longitude = 0;
  std::int64_t latitude = 0;
  friend bool operator==(const ImageDegrees&, const ImageDegrees&) = default;
};

// Something else that is known of a vertex.
struct ImageValue {
  std::uint32_t vertex = 0;
  std::uint32_t name = 0;              // into MeshImage::value_names
  std::optional<std::int64_t> nano{};  // in 10^-9; none: there is no value
  friend bool operator==(const ImageValue&, const ImageValue&) = default;
};

// Indices run from 0. Equal meshes give equal images, whatever the history of the mesh: nodes stand
// in the order of their ids, Steiner vertices along the features, triangles and edges sorted.
struct MeshImage {
  std::string name{};           // what people call it, or empty: UTF-8 without control characters
  double metres_per_unit = 0;   // of the grid; 0: nobody has said
  std::uint64_t mesh_hash = 0;  // of the mesh that it is of; 0: of one that was read from files
  int index_base = 1;
  std::vector<ImageVertex> vertices;  // nodes, then Steiner vertices
  std::uint32_t node_count = 0;
  std::uint32_t feature_count = 0;
  // Those inside the domain; counter-clockwise, the lowest index first.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  // Those of the triangles, and every subsegment that is an edge.
  std::vector<ImageEdge> edges;
  std::vector<ImageSubsegment> subsegments;
  std::size_t attribute_count = 0;
  std::vector<std::string> attributes;  // attribute_count a vertex
  // UTF-8 without control characters.
  std::vector<std::string> value_names{};
  std::vector<ImageValue> values{};     // by vertex
  std::vector<ImageDegrees> degrees{};  // of each vertex; empty where nobody knows
  std::vector<GraphHole> holes;         // in grid units, like everything here
  std::vector<GraphRegion> regions;
  std::string unit_note;  // how grid units relate to those of the input, empty where they agree

  std::uint32_t steiner_count() const {
    return static_cast<std::uint32_t>(vertices.size()) - node_count;
  }
  std::uint32_t unresolved_count() const;
};

// The index of the edge between two vertices; edges.size() without one. The edges must be sorted.
std::size_t find_edge(const MeshImage& image, std::uint32_t a, std::uint32_t b);

MeshImage image_of(const Mesh& mesh, Exterior exterior, std::span<const Point> holes);

// Gives the image what the graph it was built from says beside geometry: index base, attributes
// (linear between a feature's endpoints for Steiner vertices), markers, holes, regions. Steiner
// vertices are marked with a negative marker that no node has: -1, if it is free.
void carry_through(const ConstraintGraph& graph, const Placement& placement, MeshImage& image);

// Means over the triangles of the image; 0 without any.
struct Quality {
  double mean_edge_ratio = 0;    // shortest edge / longest edge
  double mean_radius_ratio = 0;  // radius of the incircle / of the circumcircle
};
Quality quality_of(const MeshImage& image);

}  // namespace etcm::files
