// How much a call that changes a mesh may do: counted, not timed, so it is the same on every
// machine.
//
//   if (mesh.join(position, id, Work{20'000}) == Status::work_limit) ...  // nothing has changed
//
// A unit is about one triangle, edge, list entry or hint cell that is looked at or changed; what
// goes with one, a test of a circle or a few links, is in it. lib/docs/work.md has the time of a
// unit.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>

#include "etcm/id_width.h"

namespace etcm {
inline namespace ETCM_IDS {

struct Work {
  std::uint64_t units = 0;
  [[nodiscard]] static constexpr Work unlimited() noexcept {
    return {std::numeric_limits<std::uint64_t>::max()};
  }
  friend constexpr auto operator<=>(const Work&, const Work&) = default;
};

}  // namespace ETCM_IDS
}  // namespace etcm
