// The inputs that every measurement of the library goes over: one list, for tests, bench and
// comparison alike.
#pragma once

#include <string>
#include <vector>

#include "inputs/graph.h"

namespace etcm::inputs {

struct CorpusEntry {
  std::string family;
  Graph graph;
};

// Made afresh at each call, in under a second; the same on every machine.
std::vector<CorpusEntry> corpus();

}  // namespace etcm::inputs
