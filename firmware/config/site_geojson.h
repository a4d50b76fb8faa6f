// GeoJSON as a site file: lines and polygons of a map, in the plane.
#pragma once

#include <string>
#include <vector>

#include "firmware/config/settings.h"

namespace etcm::firmware {

// Adds the lines to the features: a segment from each vertex to the next, to a node where the file
// says that one stands there, to an anchor elsewhere. Vertices at one place are one, and a segment
// that several lines share is drawn once. Polygons that are the domain or a hole bound it, and are
// lines too. Each feature of the file gives at most one mistake; throws files::InputError for a
// file that cannot be read as JSON.
void read_site_geojson(Settings& settings, std::vector<std::string>& mistakes);

}  // namespace etcm::firmware
