// Where nodes may stand: within the outline of the site and outside its holes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "etcm/types.h"

namespace etcm::firmware {

struct DomainEdge {
  Point from;
  Point to;
  friend bool operator==(const DomainEdge&, const DomainEdge&) = default;
};

enum class DomainPlace : std::uint8_t { inside, outside, in_hole };

class SiteDomain {
 public:
  // Edges of closed rings between whole units, in any order and direction; rings within rings
  // alternate. Every place is
  // within an outline without edges, none within holes without.
  SiteDomain() = default;
  SiteDomain(std::vector<DomainEdge> outline, std::vector<DomainEdge> holes)
      : outline_(std::move(outline)), holes_(std::move(holes)) {}

  // Exact; what stands on an edge is inside. O(edges).
  DomainPlace place_of(Position position) const { return place_of_point(to_point(position)); }
  DomainPlace place_of_point(const Point& point) const;

  std::span<const DomainEdge> outline() const { return outline_; }
  std::span<const DomainEdge> holes() const { return holes_; }
  friend bool operator==(const SiteDomain&, const SiteDomain&) = default;

 private:
  std::vector<DomainEdge> outline_;
  std::vector<DomainEdge> holes_;
};

}  // namespace etcm::firmware
