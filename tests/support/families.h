// Small inputs of every family, for tests that live through many.
#pragma once

#include "inputs/random.h"
#include "support/meshes.h"

namespace etcm::test {

// Family and size are drawn too.
Graph graph_of_some_family(inputs::Random& random);

}  // namespace etcm::test
