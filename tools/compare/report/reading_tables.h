// The tables beside the five criteria: what depends on a reading of the paper, and its sections 4
// and 5.
#pragma once

#include <string>

#include "compare/results.h"

namespace etcm::compare {

// In Markdown, each with its heading; those that nothing was measured for are left out.
std::string reading_tables(const Results& results);

}  // namespace etcm::compare
