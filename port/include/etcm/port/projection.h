// Between degrees on the earth (WGS 84) and the plane of a site.
#pragma once

#include <cstdint>
#include <optional>

namespace etcm::port {

// In 10^-9 of a degree.
struct EarthPoint {
  std::int64_t longitude = 0;  // east is positive, within 180
  std::int64_t latitude = 0;   // north is positive, within 90
  friend constexpr bool operator==(const EarthPoint&, const EarthPoint&) = default;
};
// In 10^-9 of what the plane counts in.
struct PlanePoint {
  std::int64_t x = 0;
  std::int64_t y = 0;
  friend constexpr bool operator==(const PlanePoint&, const PlanePoint&) = default;
};

class Projection {
 public:
  virtual ~Projection() = default;

  // None for a point that the other side cannot show. One call at a time, from any thread.
  virtual std::optional<PlanePoint> to_plane(EarthPoint point) const = 0;
  virtual std::optional<EarthPoint> to_earth(PlanePoint point) const = 0;
};

}  // namespace etcm::port
