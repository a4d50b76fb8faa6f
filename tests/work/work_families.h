// Where the search begins, and how it goes on.
#pragma once

#include <functional>

#include "inputs/random.h"
#include "work_case.h"

namespace etcm::test {

enum class Family : std::uint8_t {
  random,
  grid,
  collinear,
  star,
  hub,
  parallels,
  near_touching,
  through_nodes,
  cocircular,
};
inline constexpr std::size_t family_count = 9;
// Of the mesh: what is a long way in a large one is none in a small one.
enum class Size : std::uint8_t { small, large };
const char* name_of(Family family);

// A case of the family whose last step is that call.
WorkCase case_of(Family family, Verb last, Size size, inputs::Random& random);

// Another one like it, with the same call.
WorkCase altered(const WorkCase& of, Size size, inputs::Random& random);

// What is left of a case while `is_alike` holds: fewer steps, and smaller numbers.
WorkCase smallest(WorkCase of, const std::function<bool(const WorkCase&)>& is_alike);

}  // namespace etcm::test
