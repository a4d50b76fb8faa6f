#include "firmware/mesh/place_text.h"

#include <array>
#include <charconv>
#include <cstdlib>
#include <string_view>

#include "firmware/config/settings.h"

namespace etcm::firmware {

namespace {

// In millionths of a degree, some 11 cm: "63.430500".
TextLine& write_angle(TextLine& text, std::int64_t nanodegrees) {
  constexpr std::int64_t one = 1'000'000;
  const std::int64_t angle = std::abs(nearest_unit(nanodegrees, site_nano / one));
  text << angle / one << ".";
  for (std::int64_t digit = one / 10; digit > angle % one && digit > 1; digit /= 10) text << "0";
  return text << angle % one;
}

// To a thousandth, without zeros at the end.
void write_coordinate(TextLine& text, std::int64_t origin, std::int64_t unit, std::int32_t value) {
  const double place = static_cast<double>(origin) + static_cast<double>(unit) * value;
  std::array<char, 400> room;  // for any double
  const auto written = std::to_chars(room.data(), room.data() + room.size(), place / site_nano,
                                     std::chars_format::fixed, 3);
  std::string_view digits(room.data(), static_cast<std::size_t>(written.ptr - room.data()));
  while (digits.ends_with('0')) digits.remove_suffix(1);
  if (digits.ends_with('.')) digits.remove_suffix(1);
  text << digits;
}

}  // namespace

TextLine& operator<<(TextLine& text, Position position) {
  return text << "(" << position.x << ", " << position.y << ")";
}

void write_place(TextLine& text, const SitePlane& plane, Position position) {
  text << position;
  const auto place = earth_point(plane, to_point(position));
  if (!place) return;
  write_angle(text << ", ", place->latitude) << (place->latitude < 0 ? "° S, " : "° N, ");
  write_angle(text, place->longitude) << (place->longitude < 0 ? "° W" : "° E");
}

void write_site_place(TextLine& text, const SitePlane& plane, Position position) {
  write_place(text, plane, position);
  const bool is_counted_alike = (plane.unit_length == 0 || plane.unit_length == site_nano) &&
                                plane.origin_x == 0 && plane.origin_y == 0;
  if (plane.projection != nullptr || is_counted_alike) return;
  text << ", in the site file (";
  write_coordinate(text, plane.origin_x, plane.unit_length, position.x);
  text << ", ";
  write_coordinate(text, plane.origin_y, plane.unit_length, position.y);
  text << ")";
}

}  // namespace etcm::firmware
