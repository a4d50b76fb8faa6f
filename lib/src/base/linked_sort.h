// The order of a list that is linked through its entries.
#pragma once

#include <cstdint>

namespace etcm::internal {

// Bottom-up: runs of 1, 2, 4, ... are merged pairwise until one is left. No recursion, no memory.
// `links` tells next(entry) and precedes(a, b), sets link(entry, next), and is told of each step.
template <class Entry, class Links>
Entry sorted(Entry first, const Links& links) noexcept {
  for (std::uint32_t run = 1;; run *= 2) {
    Entry rest = first, last{};
    std::uint32_t merges = 0;
    while (!rest.is_none()) {
      ++merges;
      Entry a = rest, b = rest;
      std::uint32_t a_left = 0;
      while (a_left < run && !b.is_none()) {
        ++a_left;
        b = links.next(b);
      }
      std::uint32_t b_left = run;
      while (a_left > 0 || (b_left > 0 && !b.is_none())) {
        const bool take_b = a_left == 0 || (b_left > 0 && !b.is_none() && links.precedes(b, a));
        links.step();
        Entry& taken = take_b ? b : a;
        (take_b ? b_left : a_left) -= 1;
        if (last.is_none()) {
          first = taken;
        } else {
          links.link(last, taken);
        }
        last = taken;
        taken = links.next(taken);
      }
      rest = b;
    }
    if (!last.is_none()) links.link(last, Entry::none());
    if (merges <= 1) return first;
  }
}

}  // namespace etcm::internal
