// How few Steiner vertices any mesh of a graph can have.
#pragma once

#include <cstdint>
#include <string>

#include "etcm/files/grid.h"
#include "etcm/mesh.h"

namespace etcm::cli {

// The sum over the features of what each needs alone (etcm/bound.h). Makes a mesh of the nodes for
// it. The graph must be one that can be meshed.
std::uint64_t least_steiner_of(const files::GridGraph& grid);
// The same of what a mesh is of.
std::uint64_t least_steiner_of(const Mesh& mesh);

// "no mesh has fewer than 760", or that none has fewer than these `steiner`.
std::string describe_bound(std::uint64_t least, std::uint64_t steiner);

}  // namespace etcm::cli
