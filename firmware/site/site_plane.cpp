#include "firmware/site/site_plane.h"

#include <cstdlib>

namespace etcm::firmware {

namespace {

std::optional<std::int32_t> nearest(std::int64_t value, std::int64_t origin, std::int64_t unit) {
  std::int64_t offset = 0;
  if (__builtin_sub_overflow(value, origin, &offset)) return std::nullopt;
  const std::int64_t remainder = std::abs(offset % unit);
  std::int64_t units = offset / unit;
  if (remainder >= unit - remainder) units += offset < 0 ? -1 : 1;
  if (units < -position_max || units > position_max) return std::nullopt;
  return static_cast<std::int32_t>(units);
}

}  // namespace

std::optional<Position> nearest_position(const SitePlane& plane, std::int64_t x, std::int64_t y) {
  const auto column = nearest(x, plane.origin_x, plane.unit_length);
  const auto row = nearest(y, plane.origin_y, plane.unit_length);
  if (!column || !row) return std::nullopt;
  return Position{.x = *column, .y = *row};
}

SitePoint site_point(const SitePlane& plane, Position position) {
  return {.x = plane.origin_x + position.x * plane.unit_length,
          .y = plane.origin_y + position.y * plane.unit_length};
}

}  // namespace etcm::firmware
