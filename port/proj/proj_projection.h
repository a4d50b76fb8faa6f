// Projection by PROJ.
#pragma once

#include <memory>
#include <string>

#include "etcm/port/projection.h"

namespace etcm::port {

// A coordinate reference system of the plane: "EPSG:25833", or any other text that PROJ knows. Null
// where PROJ knows none, or none between which and WGS 84 it can go; then `why` says so.
std::unique_ptr<const Projection> make_projection(const std::string& crs, std::string& why);

// Metres about a place: a transverse Mercator projection whose meridian goes through it, so that
// lengths near it are true, to a millionth within 9 km east and west of it.
std::unique_ptr<const Projection> make_local_projection(EarthPoint center, std::string& why);

}  // namespace etcm::port
