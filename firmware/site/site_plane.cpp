#include "firmware/site/site_plane.h"

#include <cmath>
#include <cstdlib>

namespace etcm::firmware {

namespace {

std::optional<std::int32_t> nearest(std::int64_t value, std::int64_t origin, std::int64_t unit) {
  std::int64_t offset = 0;
  if (__builtin_sub_overflow(value, origin, &offset)) return std::nullopt;
  const std::int64_t units = nearest_unit(offset, unit);
  if (units < -position_max || units > position_max) return std::nullopt;
  return static_cast<std::int32_t>(units);
}

// In 10^-9 of what the site counts in; none where that does not fit.
std::optional<std::int64_t> site_coordinate(std::int64_t subunits, std::int64_t origin,
                                            std::int64_t unit) {
  const double offset = static_cast<double>(subunits) / static_cast<double>(subunits_per_unit) *
                        static_cast<double>(unit);
  if (!(std::abs(offset) < 9e18)) return std::nullopt;
  std::int64_t sum = 0;
  if (__builtin_add_overflow(std::llround(offset), origin, &sum)) return std::nullopt;
  return sum;
}

}  // namespace

std::int64_t nearest_unit(std::int64_t offset, std::int64_t unit) {
  const std::int64_t remainder = std::abs(offset % unit);
  const bool is_up = remainder >= unit - remainder;
  return offset / unit + (!is_up ? 0 : offset < 0 ? -1 : 1);
}

std::optional<Position> nearest_position(const SitePlane& plane, std::int64_t x, std::int64_t y) {
  const auto column = nearest(x, plane.origin_x, plane.unit_length);
  const auto row = nearest(y, plane.origin_y, plane.unit_length);
  if (!column || !row) return std::nullopt;
  return Position{.x = *column, .y = *row};
}

std::optional<Position> nearest_position(const SitePlane& plane, port::EarthPoint place) {
  if (plane.projection == nullptr) return std::nullopt;
  const std::optional<port::PlanePoint> at = plane.projection->to_plane(place);
  return at ? nearest_position(plane, at->x, at->y) : std::nullopt;
}

double metres_per_unit(const SitePlane& plane) {
  const double metres = plane.projection != nullptr ? plane.projection->metres()
                                                    : static_cast<double>(plane.metres) / 1e9;
  return metres * static_cast<double>(plane.unit_length) / 1e9;
}

std::optional<port::EarthPoint> earth_point(const SitePlane& plane, const Point& place) {
  if (plane.projection == nullptr) return std::nullopt;
  const auto x = site_coordinate(place.x, plane.origin_x, plane.unit_length);
  const auto y = site_coordinate(place.y, plane.origin_y, plane.unit_length);
  if (!x || !y) return std::nullopt;
  return plane.projection->to_earth({.x = *x, .y = *y});
}

}  // namespace etcm::firmware
