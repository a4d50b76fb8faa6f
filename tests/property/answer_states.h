// The states that a mesh can be in, each reached by calls alone.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "support/meshes.h"

namespace etcm::test {

// A mesh that has been opened and nothing else is made into the state.
struct WayToState {
  MeshConfig config;
  std::function<void(Mesh&)> make;
};

struct MeshSituation {
  std::string name;
  std::vector<WayToState> ways;
};

// Two features that meet at a node and run through others, and a Steiner vertex.
const Graph& crossing_lines();

// What build() refuses, each for a reason of its own, where there is room for what is right.
const std::vector<Graph>& wrong_graphs();

// A feature with a node so near beside it, and others on its other side, that no point of its grid
// is near enough: a policy which splits in the middle comes to the end of the grid.
inline constexpr Position beside_the_line{-position_max + 1, 0};
const Graph& needle_eye();

std::vector<MeshSituation> mesh_situations();

}  // namespace etcm::test
