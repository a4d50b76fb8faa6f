// The paper's split rule word for word.
#pragma once

#include "compare/systems/rival.h"

namespace etcm::compare {

// Steps 5 and 6 of Algorithm 2 for one missing subsegment.
void split_literally(const MissingSubsegment& missing, std::vector<Parameter>& places);

}  // namespace etcm::compare
