// From coordinates as a site counts them, and from degrees, to the units of the mesh and back.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "etcm/port/projection.h"
#include "etcm/types.h"

namespace etcm::firmware {

// All in 10^-9 of what the site counts in.
struct SitePlane {
  std::int64_t unit_length = 0;  // of a unit of the mesh
  std::int64_t origin_x = 0;     // the mesh's (0, 0)
  std::int64_t origin_y = 0;
  // Null: where on the earth it is, nobody has said.
  std::shared_ptr<const port::Projection> projection{};
  // Without a projection: 10^-9 metres in what the site counts in; 0 where nobody has said.
  std::int64_t metres = 0;

  friend bool operator==(const SitePlane&, const SitePlane&) = default;
};

// At most 2^51: position_max is 2^24.
constexpr std::int64_t squared_distance(Position a, Position b) {
  const std::int64_t x = std::int64_t{a.x} - b.x;
  const std::int64_t y = std::int64_t{a.y} - b.y;
  return x * x + y * y;
}

// The whole number nearest to offset / unit; halves go away from zero. REQUIRES: unit > 0.
std::int64_t nearest_unit(std::int64_t offset, std::int64_t unit);

// The nearest, as above. None beyond position_max.
std::optional<Position> nearest_position(const SitePlane& plane, std::int64_t x, std::int64_t y);
// None also where the plane does not show that place, and without a projection.
std::optional<Position> nearest_position(const SitePlane& plane, port::EarthPoint place);

// How many metres a unit of the mesh is; 0 where nobody has said.
double metres_per_unit(const SitePlane& plane);

// The degrees of a place in the mesh, which come back to it: within a hundredth of a millimetre
// where the plane counts in metres. None where the earth has no such place, and without a
// projection.
std::optional<port::EarthPoint> earth_point(const SitePlane& plane, const Point& place);

}  // namespace etcm::firmware
