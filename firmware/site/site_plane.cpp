#include "firmware/site/site_plane.h"

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

}  // namespace etcm::firmware
