// Figure 1: the meshes that all systems make of one small graph, on one page.
#pragma once

#include <string>

#include "inputs/graph.h"

namespace etcm::compare {

// An SVG of three columns: the nodes' Delaunay mesh with the features it misses, then each system.
// Features are dashed and added points square, as in the paper.
std::string mesh_panels(const inputs::Graph& graph);

}  // namespace etcm::compare
