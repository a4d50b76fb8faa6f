// GeoJSON as a site file: lines and polygons of a map.
#pragma once

#include <string>
#include <vector>

#include "etcm/files/json.h"
#include "firmware/config/settings.h"
#include "firmware/config/site_projection.h"

namespace etcm::firmware {

// Adds the lines to the features: a segment from each vertex to the next, to a node where the file
// says that one stands there, to an anchor elsewhere. Vertices at one place are one, and a segment
// that several lines share is drawn once. Polygons that are the domain or a hole bound it, and are
// lines too. A point with the unit of a device says where that was surveyed. Each feature of the
// file gives at most one mistake.
void read_site_geojson(const files::JsonValue& root, const SiteFrame& frame, Settings& settings,
                       std::vector<std::string>& mistakes);

// What the file says of its coordinates. Throws files::InputError for a "crs" that is none.
GeoJsonFrame frame_of(const files::JsonValue& root, const std::string& path);

}  // namespace etcm::firmware
