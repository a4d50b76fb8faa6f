// The page's tables, in Markdown.
#pragma once

#include <string>

#include "compare/results.h"

namespace etcm::compare {

// One table of the five criteria for each feature length, one of pruning, one of linearity.
std::string experiment_tables(const Results& results);

// The five criteria of one graph, a row for each system. `measured` as in `systems`; the AAR per
// point needs the constrained mesh among them.
std::string graph_table(std::span<const System> systems, std::span<const Measurement> measured);

}  // namespace etcm::compare
