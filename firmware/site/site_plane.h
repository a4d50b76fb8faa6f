// From coordinates as a site counts them to the units of the mesh.
#pragma once

#include <cstdint>
#include <optional>

#include "etcm/types.h"

namespace etcm::firmware {

// All in 10^-9 of what the site counts in.
struct SitePlane {
  std::int64_t unit_length = 0;  // of a unit of the mesh
  std::int64_t origin_x = 0;     // the mesh's (0, 0)
  std::int64_t origin_y = 0;
};

// The whole number nearest to offset / unit; halves go away from zero. REQUIRES: unit > 0.
std::int64_t nearest_unit(std::int64_t offset, std::int64_t unit);

// The nearest, as above. None beyond position_max.
std::optional<Position> nearest_position(const SitePlane& plane, std::int64_t x, std::int64_t y);

}  // namespace etcm::firmware
