// Between degrees on the earth (WGS 84) and the plane of a site.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

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
  // None for a point that the other side cannot show. From any thread; a call may wait for another
  // one of the same projection, about a microsecond.
  virtual std::optional<PlanePoint> to_plane(EarthPoint point) const = 0;
  virtual std::optional<EarthPoint> to_earth(PlanePoint point) const = 0;

  // Whether x and y are degrees too, of longitude and latitude: a plane for no mesh.
  virtual bool counts_in_degrees() const = 0;
  // How many metres one of what the plane counts in is: 1, or 0.3048 of a plane in feet. 0 where
  // that is not known, and of degrees.
  virtual double metres() const = 0;

 protected:
  ~Projection() = default;
};

// Where projections come from. What there is none of is null; then `why` says so.
class ProjectionSource {
 public:
  // Of a coordinate reference system: "EPSG:25833".
  virtual std::shared_ptr<const Projection> of_crs(const std::string& crs, std::string& why) = 0;
  // Metres about a place: a transverse Mercator projection whose meridian goes through it, so that
  // lengths near it are true, to a millionth within 9 km east and west of it.
  virtual std::shared_ptr<const Projection> about(EarthPoint center, std::string& why) = 0;

 protected:
  ~ProjectionSource() = default;
};

}  // namespace etcm::port
