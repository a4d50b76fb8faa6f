// The predicates again, from their definitions, in integers without bounds: the oracle's own.
#pragma once

#include "etcm/types.h"

namespace etcm::test {

// As in etcm/predicates.h; slow, and sharing no code with it.
int exact_orientation(const Point& a, const Point& b, const Point& c);
int exact_incircle(const Point& a, const Point& b, const Point& c, const Point& d);
int exact_incircle_perturbed(const Point& a, const Point& b, const Point& c, const Point& d);

}  // namespace etcm::test
