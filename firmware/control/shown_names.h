// What `etcm-gateway ctl show` shows.
#pragma once

#include <array>
#include <string_view>

namespace etcm::firmware {

inline constexpr std::array<std::string_view, 10> shown_names = {
    "alarms",        "history",     "health",     "config",      "metrics",
    "features.json", "status.json", "units.json", "alarms.json", "history.json"};

}  // namespace etcm::firmware
