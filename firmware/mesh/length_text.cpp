#include "firmware/mesh/length_text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace etcm::firmware {

void write_metres(TextLine& text, double metres) {
  const bool is_long = metres >= 1000;
  const bool is_short = metres < 1;
  const double value = is_long ? metres / 1000 : is_short ? metres * 1000 : metres;
  const int decimals = value >= 100 ? 0 : value >= 10 ? 1 : 2;
  std::array<char, 400> room;  // for any double
  const char* const begin = room.data();
  const auto written = std::to_chars(room.data(), room.data() + room.size(), value,
                                     std::chars_format::fixed, decimals);
  const char* end = written.ptr;
  if (decimals > 0) {
    while (end[-1] == '0') --end;
    if (end[-1] == '.') --end;
  }
  text << std::string_view(begin, static_cast<std::size_t>(end - begin))
       << (is_long    ? " km"
           : is_short ? " mm"
                      : " m");
}

void write_distance(TextLine& text, const SitePlane& plane, Position from, Position to,
                    std::string_view behind) {
  const double metres = metres_per_unit(plane);
  if (metres <= 0) return;
  write_metres(text, metres * std::hypot(static_cast<double>(to.x) - from.x,
                                         static_cast<double>(to.y) - from.y));
  text << behind;
}

}  // namespace etcm::firmware
