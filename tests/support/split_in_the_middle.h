// A policy that often splits in neither feasible set.
#pragma once

#include "etcm/split_site.h"

namespace etcm::test {

inline Parameter split_in_the_middle(const SplitSite& site) noexcept {
  return site.head + (site.tail - site.head) / 2;
}

}  // namespace etcm::test
