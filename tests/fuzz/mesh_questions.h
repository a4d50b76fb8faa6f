// Questions of a mesh, of any history: each comes back, and what can be told otherwise agrees.
#pragma once

#include "etcm/mesh.h"
#include "fuzz_target.h"

namespace etcm::fuzz {

void ask_about_places(const Mesh& mesh, Input& input);
void ask_about_nodes(const Mesh& mesh, Input& input);
void ask_about_features(const Mesh& mesh);
// Saved and loaded again it is the same mesh.
void save_and_load(const Mesh& mesh);
// As little as possible is asked of everything there is.
void ask_everything(const Mesh& mesh, Input& input);

}  // namespace etcm::fuzz
