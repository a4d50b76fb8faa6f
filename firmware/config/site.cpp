#include "firmware/config/site.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "etcm/files/constraint_graph.h"
#include "etcm/files/error.h"
#include "etcm/files/json.h"
#include "firmware/config/site_geojson.h"
#include "firmware/config/site_poly.h"

namespace etcm::firmware {

bool is_drawn(const FeatureSettings& feature) {
  const std::string_view source = feature.source;
  const std::string_view file = source.substr(0, source.rfind(':'));
  return file.ends_with(".geojson") || file.ends_with(".json") || file.ends_with(".poly") ||
         file.ends_with(".node");
}

namespace {

using files::Decimal;
using files::InputError;

const Decimal nano = Decimal::of(site_nano);

// In 10^-9, the nearest where it has more digits.
std::optional<std::int64_t> nano_of(const Decimal& value) {
  return (value * nano).rounded().to_integer();
}

bool is_degree(const Decimal& value, double most) { return std::abs(value.to_double()) <= most; }

}  // namespace

std::int32_t SiteGrid::coordinate(std::size_t line, const std::string& where, const char* axis,
                                  const Decimal& given, std::int64_t origin,
                                  bool may_be_degrees) const {
  const auto fail = [&](const std::string& what) {
    throw InputError(settings_.path, line, where + axis + " " + given.to_string() + what);
  };
  const auto value = nano_of(given);
  // The greatest difference is far below what overflows.
  if (!value || *value > site_nano * 4'000'000'000 || *value < -site_nano * 4'000'000'000) {
    fail(" is too large; the site file counts in something else than the unit says");
  }
  const std::int64_t offset = *value - origin;
  if (!settings_.round && (offset % settings_.unit_length != 0 || !(given * nano).is_integer())) {
    fail(std::string(" is no whole number of units; set a smaller unit in [site], or round = true "
                     "to take the nearest") +
         (may_be_degrees
              ? " (if these are degrees: GeoJSON is read in them where [site] has no crs)"
              : ""));
  }
  const std::int64_t units = nearest_unit(offset, settings_.unit_length);
  if (units < -position_max || units > position_max) {
    fail(" is " + std::to_string(units) + " units, and they run from -16777216 to 16777216; set " +
         "origin in [site] to a corner of the site, or a greater unit");
  }
  return static_cast<std::int32_t>(units);
}

Position SiteGrid::place(std::size_t line, const std::string& where, const Decimal& x,
                         const Decimal& y) const {
  if (frame_.kind != SiteFrame::Kind::plane) return place_from_earth(line, where, x, y);
  const bool may_be_degrees = is_degree(x, 180) && is_degree(y, 90);
  return {coordinate(line, where, "x", x, plane_.origin_x, may_be_degrees),
          coordinate(line, where, "y", y, plane_.origin_y, may_be_degrees)};
}

Position SiteGrid::place_from_earth(std::size_t line, const std::string& where, const Decimal& x,
                                    const Decimal& y) const {
  const auto fail = [&](const char* what) {
    throw InputError(settings_.path, line,
                     where + "[" + x.to_string() + ", " + y.to_string() + "] " + what);
  };
  const auto east = nano_of(x), north = nano_of(y);
  if (!east || !north) fail("is far too large; correct it");
  std::optional<port::EarthPoint> place = port::EarthPoint{.longitude = *east, .latitude = *north};
  if (frame_.kind == SiteFrame::Kind::other) {
    place = frame_.projection->to_earth({.x = *east, .y = *north});
    if (!place) fail("is nowhere in the coordinate system of the file; correct it");
  } else if (!is_degree(x, 180) || !is_degree(y, 90)) {
    fail(
        "is no longitude and latitude in degrees, as the first position of the file is; correct "
        "it, "
        "or name what the file counts in by crs in [site], \"plane\" for a drawing");
  }
  const auto position = nearest_position(plane_, *place);
  if (!position) {
    fail(
        "is beyond the plane of the mesh, which goes 16777216 units from its origin; set origin in "
        "[site] to a place of the site, or a greater unit (if these are no degrees: crs = "
        "\"plane\")");
  }
  return *position;
}

Point SiteGrid::near(const Decimal& x, const Decimal& y) const {
  const auto one = [&](const Decimal& given, std::int64_t origin) {
    const double units =
        (given.to_double() * static_cast<double>(site_nano) - static_cast<double>(origin)) /
        static_cast<double>(settings_.unit_length);
    return static_cast<std::int64_t>(
        std::clamp(units, -double{position_max}, double{position_max}) *
        static_cast<double>(subunits_per_unit));
  };
  return {one(x, plane_.origin_x), one(y, plane_.origin_y)};
}

namespace {

enum class FileKind : std::uint8_t { none, unknown, poly, geojson };

FileKind kind_of(const SiteSettings& site) {
  if (site.path.empty()) return FileKind::none;
  std::string extension = std::filesystem::path(site.path).extension();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (extension == ".poly") return FileKind::poly;
  return extension == ".geojson" || extension == ".json" ? FileKind::geojson : FileKind::unknown;
}

// Or has a stand-in, of which the last mistake tells: then what else is wrong is found too.
bool is_plane_known(const Settings& settings, const std::vector<std::string>& mistakes,
                    std::size_t before) {
  return mistakes.size() == before + (settings.site.lacks_center ? 1 : 0);
}

// Throws InputError.
void read_file(FileKind kind, Settings& settings, port::ProjectionSource* projections,
               std::vector<std::string>& mistakes) {
  const std::size_t before = mistakes.size();
  if (kind == FileKind::geojson) {
    const files::JsonValue root = files::read_json(settings.site.path);
    const GeoJsonFrame said = frame_of(root, settings.site.path);
    const SiteFrame frame = project_site(settings, &said, projections, mistakes);
    if (is_plane_known(settings, mistakes, before)) {
      read_site_geojson(root, frame, settings, mistakes);
    }
    return;
  }
  project_site(settings, nullptr, projections, mistakes);
  if (kind == FileKind::poly && is_plane_known(settings, mistakes, before)) {
    read_site_poly(settings);
  }
}

}  // namespace

void read_site(Settings& settings, port::ProjectionSource* projections,
               std::vector<std::string>& mistakes) {
  const FileKind kind = kind_of(settings.site);
  std::error_code ignored;
  if (kind != FileKind::none && !std::filesystem::exists(settings.site.path, ignored)) {
    mistakes.push_back(settings.site.source + ": the site file " + settings.site.path +
                       " is not there; correct 'file'");
    return;
  }
  if (kind == FileKind::unknown) {
    mistakes.push_back(settings.site.source + ": the site file " + settings.site.path +
                       " is of no known kind; give a .poly or a .geojson");
    return;
  }
  const std::size_t before = mistakes.size();
  try {
    read_file(kind, settings, projections, mistakes);
  } catch (const InputError& error) {
    mistakes.push_back(error.what());
  }
  if (is_plane_known(settings, mistakes, before)) place_nodes(settings, mistakes);
}

}  // namespace etcm::firmware
