// Between degrees on the earth (WGS 84) and the plane of a site.
#pragma once

#include <cstdint>
#include <optional>

namespace etcm::port {

// In 10^-9 of what the plane counts in, or of degrees.
struct PlanePoint {
  std::int64_t x = 0;
  std::int64_t y = 0;
};
struct EarthPoint {
  std::int64_t longitude = 0;  // east is positive
  std::int64_t latitude = 0;   // north is positive
};

class Projection {
 public:
  // None for a point that the plane cannot show. May be called from any thread, one at a time.
  virtual std::optional<PlanePoint> to_plane(EarthPoint point) const = 0;
  virtual std::optional<EarthPoint> to_earth(PlanePoint point) const = 0;

 protected:
  ~Projection() = default;
};

}  // namespace etcm::port
