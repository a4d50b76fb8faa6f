// The site file: features, anchors and the domain, drawn as a Triangle .poly or as GeoJSON.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "etcm/files/decimal.h"
#include "firmware/config/settings.h"

namespace etcm::firmware {

// From the coordinates of a site file to the units of the mesh.
class SiteGrid {
 public:
  explicit SiteGrid(const SiteSettings& settings) : settings_(settings) {}

  // Exact; throws InputError for what is no whole number of units (unless rounded) or out of range.
  // `where` is said in front of what is wrong, and may be empty.
  Position place(std::size_t line, const std::string& where, const files::Decimal& x,
                 const files::Decimal& y) const;
  // The nearest sub-unit: for what only shows into an area. Out of range: what is far away.
  Point near(const files::Decimal& x, const files::Decimal& y) const;

 private:
  std::int32_t coordinate(std::size_t line, const std::string& where, const char* axis,
                          const files::Decimal& given, std::int64_t origin,
                          bool may_be_degrees) const;

  const SiteSettings& settings_;
};

// Adds what the file settings.site names to the settings. Which of the two it is, the extension
// says. Each mistake adds one line "file:line: what; the cure" to `mistakes`.
void read_site(Settings& settings, std::vector<std::string>& mistakes);

}  // namespace etcm::firmware
