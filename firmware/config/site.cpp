#include "firmware/config/site.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "etcm/files/constraint_graph.h"
#include "etcm/files/error.h"
#include "firmware/config/site_geojson.h"
#include "firmware/config/site_poly.h"

namespace etcm::firmware {

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
         (may_be_degrees ? " (if these are degrees: export the file in metres, in a projected "
                           "coordinate system)"
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
  const bool may_be_degrees = is_degree(x, 180) && is_degree(y, 90);
  return {coordinate(line, where, "x", x, settings_.origin.x, may_be_degrees),
          coordinate(line, where, "y", y, settings_.origin.y, may_be_degrees)};
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
  return {one(x, settings_.origin.x), one(y, settings_.origin.y)};
}

void read_site(Settings& settings, std::vector<std::string>& mistakes) {
  std::error_code ignored;
  if (!std::filesystem::exists(settings.site.path, ignored)) {
    mistakes.push_back(settings.site.source + ": the site file " + settings.site.path +
                       " is not there; correct 'file'");
    return;
  }
  std::string extension = std::filesystem::path(settings.site.path).extension();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  try {
    if (extension == ".poly") {
      read_site_poly(settings);
    } else if (extension == ".geojson" || extension == ".json") {
      read_site_geojson(settings, mistakes);
    } else {
      mistakes.push_back(settings.site.source + ": the site file " + settings.site.path +
                         " is of no known kind; give a .poly or a .geojson");
    }
  } catch (const InputError& error) {
    mistakes.push_back(error.what());
  }
}

}  // namespace etcm::firmware
