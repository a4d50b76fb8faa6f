#include "firmware/config/site_projection.h"

#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "firmware/logging/nano_text.h"

namespace etcm::firmware {

namespace {

constexpr const char* drawing_crs = "plane";
constexpr const char* no_proj =
    "this gateway was built without PROJ, and has no degrees and no crs; draw the site in the "
    "plane, "
    "and set crs = \"plane\" in [site]";

// Also as files name it that are older than RFC 7946.
bool is_wgs84(std::string_view crs) {
  return crs == "EPSG:4326" || crs == "OGC:CRS84" || crs.ends_with(":CRS84");
}

bool is_degrees(const port::PlanePoint& point) {
  return std::abs(point.x) <= 180 * site_nano && std::abs(point.y) <= 90 * site_nano;
}

// What is in degrees beside the site file.
struct InDegrees {
  std::string source;
  std::string what;
};

bool is_surveyed(const NodeSettings* node) {
  return node != nullptr && (node->x || node->longitude || node->position);
}

// The first [[bus.device]] with a unit that tells where it stands in this way; null: there is none.
const DeviceSettings* find_device(const Settings& settings, Profile::Positioning positioning) {
  for (const BusSettings& bus : settings.buses) {
    for (const DeviceSettings& device : bus.devices) {
      const Profile* const profile = find_profile(settings, device.profile);
      if (profile == nullptr || profile->positioning != positioning) continue;
      for (const UnitRange range : device.units) {
        for (const ModbusAddress unit : range) {
          if (!is_surveyed(node_at(settings, bus, unit))) return &device;
        }
      }
    }
  }
  return nullptr;
}

std::optional<InDegrees> find_in_degrees(const Settings& settings) {
  for (const NodeSettings& node : settings.nodes) {
    if (node.longitude) return InDegrees{node.source, "this [[node]] was surveyed in degrees"};
  }
  const DeviceSettings* const device = find_device(settings, Profile::Positioning::degrees);
  if (device == nullptr) return std::nullopt;
  return InDegrees{device->source,
                   "the devices of '" + device->profile + "' tell where they stand in degrees"};
}

// A place in the plane is seldom told in fractions, and one that could be degrees is near (0, 0).
bool looks_like_degrees(const SiteOrigin& origin) {
  return origin.x % site_nano != 0 && origin.y % site_nano != 0 &&
         is_degrees({.x = origin.x, .y = origin.y});
}

std::string degrees_text(const port::EarthPoint& place) {
  char text[64];
  std::snprintf(text, sizeof text, "%.9g, %.9g", static_cast<double>(place.longitude) / site_nano,
                static_cast<double>(place.latitude) / site_nano);
  return text;
}

bool has_place_in_plane(const NodeSettings& node) { return node.x && node.y; }

std::string in_degrees_instead(const NodeSettings& node) {
  return "write longitude = \"" + nano_text(*node.x) + "\" and latitude = \"" + nano_text(*node.y) +
         "\" in their place";
}

class SiteProjector {
 public:
  SiteProjector(Settings& settings, const GeoJsonFrame* file, port::ProjectionSource* source,
                std::vector<std::string>& mistakes)
      : settings_(settings),
        site_(settings.site),
        file_(file),
        source_(source),
        mistakes_(mistakes),
        in_degrees_(find_in_degrees(settings)) {}

  SiteFrame run() {
    site_.projection = nullptr;
    site_.has_origin_in_degrees = false;
    site_.projected_crs.clear();
    site_.center.reset();
    site_.lacks_center = false;
    SiteFrame frame;
    if (site_.crs == drawing_crs) {
      if (in_degrees_) {
        fail(in_degrees_->source, in_degrees_->what +
                                      ", and crs = \"plane\" in [site] says that nobody knows "
                                      "where on the earth the plane is; name its coordinate "
                                      "system, such as \"EPSG:25833\", or take crs out");
      }
      return frame;
    }
    const std::size_t before = mistakes_.size();
    if (!site_.crs.empty()) take_named();
    if (file_ != nullptr && mistakes_.size() == before) frame = read_file();
    if (mistakes_.size() == before && site_.projection == nullptr &&
        (in_degrees_ || frame.kind != SiteFrame::Kind::plane)) {
      check_plane_nodes();
      if (mistakes_.size() == before) take_local(frame);
    }
    if (site_.projection != nullptr && site_.metres != 0) {
      fail(site_.source,
           "metres in [site] is for a plane that is nowhere on the earth, and where this one is "
           "says how long a unit is; take metres out");
    }
    if (mistakes_.size() == before) check_plane_devices();
    return frame;
  }

 private:
  void fail(const std::string& source, const std::string& what) {
    mistakes_.push_back(source + ": " + what);
  }
  std::string file_place() const { return site_.path + ":" + std::to_string(file_->line_number); }

  std::shared_ptr<const port::Projection> named(const std::string& crs, const std::string& place) {
    if (source_ == nullptr) {
      fail(place, no_proj);
      return nullptr;
    }
    std::string why;
    auto made = source_->of_crs(crs, why);
    if (made == nullptr) {
      fail(place, "the coordinate system '" + crs + "' cannot be had: " + why +
                      "; write its code as \"EPSG:25833\"");
    }
    return made;
  }

  void take_named() {
    site_.projection = named(site_.crs, site_.source);
    site_.projected_crs = site_.crs;
    if (site_.projection != nullptr && site_.projection->counts_in_degrees()) {
      fail(site_.source, "crs '" + site_.crs +
                             "' counts in degrees, and a mesh is in a plane; name a projected one, "
                             "or take crs out, and the plane is metres about the site");
    }
  }

  SiteFrame read_file() {
    if (is_wgs84(file_->crs)) return {.kind = SiteFrame::Kind::degrees};
    if (!file_->crs.empty()) return read_named_file();
    if (!file_->first || is_degrees(*file_->first)) return {.kind = SiteFrame::Kind::degrees};
    // What is no degree cannot be WGS 84.
    if (site_.crs.empty()) {
      fail(file_place(),
           "these are no degrees, in which GeoJSON counts unless it says otherwise; name the "
           "coordinate system of the file as crs = \"EPSG:...\" in [site], or set crs = \"plane\" "
           "if it is a drawing");
    }
    return {};
  }

  SiteFrame read_named_file() {
    if (file_->crs == site_.crs) return {};
    auto projection = named(file_->crs, file_place());
    if (projection == nullptr) return {};
    if (site_.crs.empty() && !projection->counts_in_degrees()) {
      site_.projection = std::move(projection);
      site_.projected_crs = file_->crs;
      return {};
    }
    return {.kind = SiteFrame::Kind::other, .projection = std::move(projection)};
  }

  void take_local(const SiteFrame& frame) {
    const std::string place = in_degrees_ ? in_degrees_->source : file_place();
    if (source_ == nullptr) return fail(place, no_proj);
    site_.has_origin_in_degrees = site_.origin != SiteOrigin{};
    if (site_.has_origin_in_degrees && !is_degrees({.x = site_.origin.x, .y = site_.origin.y})) {
      return fail(place,
                  "the origin is no longitude and latitude in degrees, in which the site is; write "
                  "origin = [\"LONGITUDE\", \"LATITUDE\"] in [site], or name the crs in which it "
                  "is");
    }
    const std::optional<port::EarthPoint> center = find_center(frame);
    if (!center) {
      fail(place, (in_degrees_ ? in_degrees_->what : "the site file has no position") +
                      ", and nothing says about which place the plane is; set origin = "
                      "[\"LONGITUDE\", \"LATITUDE\"] in [site] to the middle of the site");
      site_.lacks_center = true;
    }
    std::string why;
    site_.projection = source_->about(center.value_or(port::EarthPoint{}), why);
    site_.center = center;
    if (site_.projection == nullptr) fail(place, "the plane of the site cannot be had: " + why);
  }

  // x and y of a [[node]] are of a plane, and in a site in degrees nobody has said of which; the
  // origin of one is a place that they can be metres from.
  void check_plane_nodes() {
    if (site_.origin != SiteOrigin{}) return;
    const NodeSettings* first = nullptr;
    std::size_t count = 0;
    for (const NodeSettings& node : settings_.nodes) {
      if (has_place_in_plane(node) && count++ == 0) first = &node;
    }
    if (first == nullptr) return;
    const bool can_be = is_degrees({.x = *first->x, .y = *first->y});
    fail(first->source,
         "x and y are a place in a plane, and the site is in degrees; " +
             (can_be ? in_degrees_instead(*first) + ", or if they are no degrees" : "") +
             (can_be ? " " : "") +
             "name their coordinate system as crs = \"EPSG:...\" in [site], or an `origin` in "
             "degrees, "
             "about which they are metres" +
             (count > 1 ? " (and so for " + std::to_string(count - 1) + " more [[node]])" : ""));
  }

  // Devices with x and y tell places of some plane, and nobody has said that it is this one.
  void check_plane_devices() {
    const DeviceSettings* const device = find_device(settings_, Profile::Positioning::plane);
    if (device == nullptr || !site_.crs.empty()) return;
    const std::string what = "x and y of the devices of '" + device->profile + "' ";
    constexpr const char* cure =
        "; if that is not what they tell, name their coordinate system as crs = \"EPSG:...\" in "
        "[site], or give longitude and latitude in their profile";
    if (site_.projection == nullptr) {
      if (!looks_like_degrees(site_.origin)) return;
      settings_.warnings.push_back(
          device->source + ": " + what +
          "are in a plane that is nowhere on the earth, and so is the origin in [site], though it "
          "looks like longitude and latitude" +
          cure);
    } else if (site_.has_origin_in_degrees) {
      settings_.warnings.push_back(device->source + ": " + what +
                                   "are taken as metres east and north of the origin (" +
                                   degrees_text(*site_.center) + ")" + cure);
    } else if (site_.center) {
      fail(device->source,
           what +
               "are places of a plane, and nothing says of which: the site is in degrees; name "
               "their coordinate system as crs = \"EPSG:...\" in [site], give longitude and "
               "latitude in their profile, or set origin = [\"LONGITUDE\", \"LATITUDE\"] in [site] "
               "if they are metres east and north of it");
    }
  }

  std::optional<port::EarthPoint> find_center(const SiteFrame& frame) const {
    if (site_.has_origin_in_degrees) {
      return port::EarthPoint{.longitude = site_.origin.x, .latitude = site_.origin.y};
    }
    if (frame.kind == SiteFrame::Kind::degrees && file_->first) {
      return port::EarthPoint{.longitude = file_->first->x, .latitude = file_->first->y};
    }
    if (frame.kind == SiteFrame::Kind::other && file_->first)
      return frame.projection->to_earth(*file_->first);
    for (const NodeSettings& node : settings_.nodes) {
      if (node.longitude && node.latitude) {
        return port::EarthPoint{.longitude = *node.longitude, .latitude = *node.latitude};
      }
    }
    return std::nullopt;
  }

  Settings& settings_;
  SiteSettings& site_;
  const GeoJsonFrame* file_;
  port::ProjectionSource* source_;
  std::vector<std::string>& mistakes_;
  const std::optional<InDegrees> in_degrees_;
};

}  // namespace

SiteFrame project_site(Settings& settings, const GeoJsonFrame* file, port::ProjectionSource* source,
                       std::vector<std::string>& mistakes) {
  return SiteProjector(settings, file, source, mistakes).run();
}

namespace {

void warn_of_rounding(Settings& settings, const NodeSettings& node) {
  const SitePlane plane = settings.site.plane();
  const bool is_whole = (*node.x - plane.origin_x) % plane.unit_length == 0 &&
                        (*node.y - plane.origin_y) % plane.unit_length == 0;
  if (settings.site.crs.empty() && looks_like_degrees({.x = *node.x, .y = *node.y})) {
    settings.warnings.push_back(
        node.source + ": x and y are taken as a place in the plane" +
        (settings.site.has_origin_in_degrees ? ", metres east and north of the origin" : "") +
        ", and look like degrees; if they are, " + in_degrees_instead(node));
    return;
  }
  if (is_whole || settings.site.round) return;
  settings.warnings.push_back(node.source +
                              ": x and y are no whole numbers of units; it stands at "
                              "the nearest, (" +
                              std::to_string(node.position->x) + ", " +
                              std::to_string(node.position->y) +
                              ") to the mesh; set a smaller unit in [site], or round = true if "
                              "that is meant");
}

}  // namespace

void place_nodes(Settings& settings, std::vector<std::string>& mistakes) {
  const SitePlane plane = settings.site.plane();
  for (NodeSettings& node : settings.nodes) {
    if (node.x && node.y) {
      node.position = nearest_position(plane, *node.x, *node.y);
      if (node.position) warn_of_rounding(settings, node);
    } else if (node.longitude && node.latitude) {
      node.position = nearest_position(
          plane, port::EarthPoint{.longitude = *node.longitude, .latitude = *node.latitude});
    } else {
      continue;
    }
    if (node.position) continue;
    mistakes.push_back(node.source +
                       ": it stands beyond the plane of the mesh, which goes 16777216 units from "
                       "its origin; correct where it stands, or set origin in [site] to a place of "
                       "the site, or a greater unit");
  }
}

}  // namespace etcm::firmware
