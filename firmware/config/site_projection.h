// Where on the earth the plane of a site is, and what the coordinates of its file count in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "etcm/port/projection.h"
#include "firmware/config/settings.h"

namespace etcm::firmware {

// What a GeoJSON file says of its coordinates.
struct GeoJsonFrame {
  std::string crs;                        // that it names, or empty
  std::optional<port::PlanePoint> first;  // the first that it has
  std::size_t line_number = 0;            // of whichever of them decides
};

// What coordinates of a site file are.
struct SiteFrame {
  enum class Kind : std::uint8_t {
    plane,
    degrees,
    other,  // of `projection`, which is not that of the plane
  };
  Kind kind = Kind::plane;
  std::shared_ptr<const port::Projection> projection{};
};

// Sets the projection of settings.site. By this order: the plane of `crs`; that of the file, if it
// names one that counts in no degrees; if anything of the site is in degrees, metres about the
// origin, or the first position of the file, or the first [[node]] in degrees. None where nothing
// is. Without `file` the site file is none in GeoJSON, and in the plane; without `source` this is
// a gateway that has no projections. Where `mistakes` grows the answer is of no use.
SiteFrame project_site(Settings& settings, const GeoJsonFrame* file, port::ProjectionSource* source,
                       std::vector<std::string>& mistakes);

// Sets where each [[node]] stands that was surveyed: at the nearest unit, with a warning where that
// is not what it says in the plane. REQUIRES: project_site().
void place_nodes(Settings& settings, std::vector<std::string>& mistakes);

}  // namespace etcm::firmware
