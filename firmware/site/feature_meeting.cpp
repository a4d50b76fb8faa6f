#include "firmware/site/feature_meeting.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <utility>

namespace etcm::firmware {

namespace {

// Twice the area of the triangle, positive where it turns left: below 2^52.
std::int64_t area_of(Position a, Position b, Position c) {
  const std::int64_t ab_x = std::int64_t{b.x} - a.x;
  const std::int64_t ab_y = std::int64_t{b.y} - a.y;
  return ab_x * (std::int64_t{c.y} - a.y) - ab_y * (std::int64_t{c.x} - a.x);
}

bool is_opposite(std::int64_t one, std::int64_t other) {
  return (one < 0 && other > 0) || (one > 0 && other < 0);
}

using Place = std::pair<std::int32_t, std::int32_t>;

// The end that comes first, and the other.
std::pair<Place, Place> ordered(const FeatureLine& line) {
  return std::minmax(Place{line.from.x, line.from.y}, Place{line.to.x, line.to.y});
}

// What lies `part` / `whole` of the line from its begin, where that is a place in whole units.
std::optional<Position> place_at(const FeatureLine& line, std::int64_t part, std::int64_t whole) {
  const std::int64_t common = std::gcd(part, whole);
  part /= common;
  whole /= common;
  const std::int64_t dx = std::int64_t{line.to.x} - line.from.x;
  const std::int64_t dy = std::int64_t{line.to.y} - line.from.y;
  if (dx % whole != 0 || dy % whole != 0) return std::nullopt;
  return Position{static_cast<std::int32_t>(line.from.x + dx / whole * part),
                  static_cast<std::int32_t>(line.from.y + dy / whole * part)};
}

// The same to the next whole units, for a person.
Position place_near(const FeatureLine& line, std::int64_t part, std::int64_t whole) {
  const double along = static_cast<double>(part) / static_cast<double>(whole);
  const auto between = [&](std::int32_t from, std::int32_t to) {
    return static_cast<std::int32_t>(std::lround(from + along * (double(to) - double(from))));
  };
  return {between(line.from.x, line.to.x), between(line.from.y, line.to.y)};
}

// Most lines are far from each other.
bool is_apart(const FeatureLine& one, const FeatureLine& other) {
  return std::max(one.from.x, one.to.x) < std::min(other.from.x, other.to.x) ||
         std::max(other.from.x, other.to.x) < std::min(one.from.x, one.to.x) ||
         std::max(one.from.y, one.to.y) < std::min(other.from.y, other.to.y) ||
         std::max(other.from.y, other.to.y) < std::min(one.from.y, one.to.y);
}

}  // namespace

Meeting meeting_of(const FeatureLine& one, const FeatureLine& other) {
  if (is_apart(one, other)) return {};
  const auto [one_first, one_last] = ordered(one);
  const auto [other_first, other_last] = ordered(other);
  if (one_first == other_first && one_last == other_last) {
    return {.status = Status::repeated_feature};
  }
  const std::int64_t other_from = area_of(one.from, one.to, other.from);
  const std::int64_t other_to = area_of(one.from, one.to, other.to);
  if (other_from == 0 && other_to == 0) {
    const bool overlap = std::max(one_first, other_first) < std::min(one_last, other_last);
    return {.status = overlap ? Status::overlapping_features : Status::ok};
  }
  const std::int64_t one_from = area_of(other.from, other.to, one.from);
  const std::int64_t one_to = area_of(other.from, other.to, one.to);
  if (!is_opposite(other_from, other_to) || !is_opposite(one_from, one_to)) return {};
  const std::int64_t part = std::abs(one_from);
  const std::int64_t whole = part + std::abs(one_to);
  return {.status = Status::crossing_features,
          .crossing = place_at(one, part, whole),
          .near_crossing = place_near(one, part, whole)};
}

bool runs_through(const FeatureLine& line, Position place) {
  if (area_of(line.from, line.to, place) != 0) return false;
  const auto [first, last] = ordered(line);
  const Place there{place.x, place.y};
  return first < there && there < last;
}

}  // namespace etcm::firmware
