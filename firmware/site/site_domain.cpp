#include "firmware/site/site_domain.h"

#include <algorithm>

#include "etcm/predicates.h"

namespace etcm::firmware {

namespace {

enum class Side : std::uint8_t { within, without, on };

bool is_on(Point p, const DomainEdge& edge) {
  const auto [x_low, x_high] = std::minmax(edge.from.x, edge.to.x);
  const auto [y_low, y_high] = std::minmax(edge.from.y, edge.to.y);
  return p.x >= x_low && p.x <= x_high && p.y >= y_low && p.y <= y_high &&
         orient2d(edge.from, edge.to, p) == 0;
}

// Counts the edges a ray to the right crosses; an edge has its lower end and not its upper one, so
// a corner counts once.
Side side_of(Point p, std::span<const DomainEdge> edges) {
  bool odd = false;
  for (const DomainEdge& edge : edges) {
    if (is_on(p, edge)) return Side::on;
    const auto [low, high] =
        edge.from.y < edge.to.y ? std::pair(edge.from, edge.to) : std::pair(edge.to, edge.from);
    if (low.y <= p.y && p.y < high.y && orient2d(low, high, p) > 0) odd = !odd;
  }
  return odd ? Side::within : Side::without;
}

}  // namespace

DomainPlace SiteDomain::place_of_point(const Point& point) const {
  if (side_of(point, holes_) == Side::within) return DomainPlace::in_hole;
  if (!outline_.empty() && side_of(point, outline_) == Side::without) return DomainPlace::outside;
  return DomainPlace::inside;
}

}  // namespace etcm::firmware
