// The paper's section 5 counts judgments, not time: how many a literal ETCM makes, beside its
// formulas.
#pragma once

#include <cstdint>

#include "compare/systems/attempt.h"
#include "inputs/graph.h"

namespace etcm::compare {

struct JudgmentTally {
  // Finding what a feature crosses, once each time that it is treated: whether an edge and the
  // feature intersect.
  std::uint64_t subsegments = 0;
  std::uint64_t crossed = 0;        // triangles: the paper's n, summed
  std::uint64_t around = 0;         // triangles at the endpoint, where the paper says six
  std::uint64_t intersections = 0;  // judgments until the crossed edge is found, each time
  // Finding the triangle that a new point lies in, along what is crossed: whether it contains it.
  std::uint64_t points = 0;
  std::uint64_t searched = 0;     // triangles that are crossed then: again n
  std::uint64_t containment = 0;  // judgments from the head on; the last triangle needs none

  JudgmentTally& operator+=(const JudgmentTally& other) noexcept;
};

JudgmentTally count_judgments(const inputs::Graph& graph);

}  // namespace etcm::compare
