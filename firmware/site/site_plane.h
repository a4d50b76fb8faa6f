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

// The nearest; halves go away from zero. None beyond position_max.
std::optional<Position> nearest_position(const SitePlane& plane, std::int64_t x, std::int64_t y);

// The other way; exact.
struct SitePoint {
  std::int64_t x = 0;
  std::int64_t y = 0;
};
SitePoint site_point(const SitePlane& plane, Position position);

}  // namespace etcm::firmware
