#include "firmware/config/site_scale.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>

namespace etcm::firmware {

namespace {

// Of UTM at the rim of its zone it is a tenth of this; one zone farther four times as much.
constexpr double off_max = 0.005;

// The radii of curvature of WGS 84, along the meridian and across it.
struct Radii {
  double meridian;
  double normal;
};
Radii radii_at(double latitude) {
  constexpr double equator = 6378137, squared_eccentricity = 0.00669437999014;
  const double s = std::sin(latitude);
  const double w = 1 - squared_eccentricity * s * s;
  return {equator * (1 - squared_eccentricity) / (w * std::sqrt(w)), equator / std::sqrt(w)};
}

// By how much a small step from here to there is longer in the plane than on the earth.
std::optional<double> stretch(const port::Projection& projection, const port::EarthPoint& from,
                              const port::EarthPoint& to) {
  const auto a = projection.to_plane(from), b = projection.to_plane(to);
  if (!a || !b) return std::nullopt;
  const double in_plane = std::hypot(static_cast<double>(b->x) - static_cast<double>(a->x),
                                     static_cast<double>(b->y) - static_cast<double>(a->y)) /
                          1e9 * projection.metres();
  constexpr double radian_per_nano = std::numbers::pi / 180 / 1e9;
  const double latitude = static_cast<double>(from.latitude) * radian_per_nano;
  const Radii radii = radii_at(latitude);
  const double north = static_cast<double>(to.latitude - from.latitude) * radian_per_nano;
  const double east = static_cast<double>(to.longitude - from.longitude) * radian_per_nano;
  return in_plane / std::hypot(north * radii.meridian, east * radii.normal * std::cos(latitude));
}

// The stretch of the two directions that is farther off.
std::optional<double> stretch_at(const port::Projection& projection,
                                 const port::EarthPoint& place) {
  constexpr std::int64_t step = site_nano / 1000;
  const std::int64_t inward = place.latitude > 0 ? -step : step;
  const auto north = stretch(projection, place, {place.longitude, place.latitude + inward});
  const auto east = stretch(
      projection, place, {place.longitude + (place.longitude > 0 ? -step : step), place.latitude});
  if (!north || !east) return std::nullopt;
  return std::abs(*north - 1) > std::abs(*east - 1) ? *north : *east;
}

std::string text_of(const port::EarthPoint& place) {
  char text[80];
  std::snprintf(text, sizeof text, "longitude %.4f, latitude %.4f",
                static_cast<double>(place.longitude) / 1e9,
                static_cast<double>(place.latitude) / 1e9);
  return text;
}

bool check_at(Settings& settings, const std::string& source, const port::EarthPoint& place) {
  const SiteSettings& site = settings.site;
  const auto found = stretch_at(*site.projection, place);
  if (!found || std::abs(*found - 1) <= off_max) return false;
  char percent[40];
  std::snprintf(percent, sizeof percent, "%.1f %%", std::abs(*found - 1) * 100);
  settings.warnings.push_back(
      source + ": lengths at " + text_of(place) + " are " + percent +
      (*found > 1 ? " too long" : " too short") + " in the plane of the site; " +
      (site.crs.empty() ? "that is far from where it is about: are longitude and latitude swapped, "
                          "here or in the origin of [site]?"
                        : "crs '" + site.crs + "' is made for another part of the earth"));
  return true;
}

}  // namespace

void check_scale(Settings& settings) {
  const SitePlane plane = settings.site.plane();
  if (metres_per_unit(plane) == 0) return;
  const auto check = [&](const std::string& source, const std::optional<Position>& position) {
    if (!position) return false;
    const auto place = earth_point(plane, to_point(*position));
    return place && check_at(settings, source, *place);
  };
  if (!settings.anchors.empty() &&
      check(settings.anchors.front().source, settings.anchors.front().position)) {
    return;
  }
  for (const NodeSettings& node : settings.nodes) {
    if (check(node.source, node.position)) return;
  }
}

}  // namespace etcm::firmware
