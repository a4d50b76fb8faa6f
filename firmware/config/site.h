// The site file: features, anchors and the domain, drawn as a Triangle .poly or as GeoJSON.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "etcm/files/decimal.h"
#include "etcm/port/projection.h"
#include "firmware/config/settings.h"
#include "firmware/config/site_projection.h"

namespace etcm::firmware {

// From the coordinates of a site file to the units of the mesh.
class SiteGrid {
 public:
  explicit SiteGrid(const SiteSettings& settings, SiteFrame frame = {})
      : settings_(settings), plane_(settings.plane()), frame_(std::move(frame)) {}

  // In the plane exact; throws InputError for what is no whole number of units (unless rounded) or
  // out of range. Of any other frame the nearest. `where` is said in front of what is wrong, and
  // may be empty.
  Position place(std::size_t line, const std::string& where, const files::Decimal& x,
                 const files::Decimal& y) const;
  // The nearest sub-unit: for what only shows into an area. Out of range: what is far away.
  Point near(const files::Decimal& x, const files::Decimal& y) const;

 private:
  std::int32_t coordinate(std::size_t line, const std::string& where, const char* axis,
                          const files::Decimal& given, std::int64_t origin,
                          bool may_be_degrees) const;
  Position place_from_earth(std::size_t line, const std::string& where, const files::Decimal& x,
                            const files::Decimal& y) const;

  const SiteSettings& settings_;
  const SitePlane plane_;
  const SiteFrame frame_;
};

// Finds out which plane the site has, and adds what the file settings.site names to the settings,
// if it names one. Which of the two it is, the extension says. Each mistake adds one line
// "file:line: what; the cure" to `mistakes`. `projections` may be null.
void read_site(Settings& settings, port::ProjectionSource* projections,
               std::vector<std::string>& mistakes);

}  // namespace etcm::firmware
