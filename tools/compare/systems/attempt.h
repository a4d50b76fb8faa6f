// What one system makes of one graph, once.
#pragma once

#include <cstdint>

#include "etcm/files/mesh_image.h"
#include "etcm/mesh.h"
#include "inputs/graph.h"

namespace etcm::compare {

// Whether the figures of a mesh count.
enum class Verdict : std::uint8_t {
  ok,
  not_ended,       // it ran out of time, or died
  out_of_room,     // it needed more vertices than anybody would accept, or finer coordinates
  not_delaunay,    // a vertex lies inside a circumcircle
  not_conforming,  // a feature is no union of edges
};
const char* to_string(Verdict verdict) noexcept;

enum class Depth : std::uint8_t {
  times,  // for repeated timing: no audit, no image
  whole,
};

struct Attempt {
  Verdict verdict = Verdict::ok;
  // Processor time.
  double delaunay_us = 0;  // the nodes alone
  double total_us = 0;     // nodes and features
  std::uint32_t added = 0;
  // The subsegments of features that a rival's loop has looked at.
  std::uint64_t looked_at = 0;
  // What is left of `added` after our pruning, which takes out only what no edge needs: how much of
  // a system's count is its rule. Equals `added` where pruning does not apply.
  std::uint32_t added_after_pruning = 0;
  // Equal for equal triangulations, bit for bit, whatever the order of vertices.
  std::uint64_t hash = 0;
  files::MeshImage image;
};

// What the library's audit says of a mesh of ours.
Verdict verdict_of(const Mesh& mesh) noexcept;

// Room for Steiner vertices: several times what the neediest takes on the paper's graphs, and the
// same for all.
std::size_t steiner_room(const inputs::Graph& graph) noexcept;

}  // namespace etcm::compare
