// What both versions of gpio_line need.
#pragma once

#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>

namespace etcm::port {

// The name under which a line is requested; gpioinfo shows it.
inline constexpr const char* line_consumer = "etcm-gateway";

struct ChipOffset {
  std::string chip;
  unsigned offset = 0;
};

// Reads "gpiochip0:4"; nothing where that is none.
inline std::optional<ChipOffset> parse_chip_offset(const std::string& place) {
  const std::size_t colon = place.rfind(':');
  if (colon == std::string::npos || colon == 0) return std::nullopt;
  ChipOffset found{.chip = place.substr(0, colon)};
  const char* const end = place.data() + place.size();
  const auto [stop, error] = std::from_chars(place.data() + colon + 1, end, found.offset);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return found;
}

[[noreturn]] inline void fail_not_found(const std::string& place) {
  throw std::runtime_error("gpio line " + place +
                           " was not found; gpioinfo lists the lines there are and their names");
}

[[noreturn]] inline void fail_request(const std::string& place) {
  const int error = errno;
  throw std::runtime_error("gpio line " + place + " cannot be had (" + std::strerror(error) + ")" +
                           (error == EBUSY    ? "; gpioinfo shows who has it"
                            : error == EACCES ? "; let the gateway's user into the group gpio"
                                              : ""));
}

}  // namespace etcm::port
