// How many units and buses there are, and may be once a reload has added some.
#pragma once

#include <cstdint>

#include "firmware/config/settings.h"

namespace etcm::firmware {

// As many units as the poller has for these settings.
std::uint32_t count_units(const Settings& settings);

// So many buses may be added while the gateway runs.
inline constexpr std::uint32_t added_buses_max = 16;

// So much memory is taken at the start: for units as many as there are then, or as many as the mesh
// has room for and so many buses can have, where that is more.
UnitRoom unit_room_of(const Settings& settings);

}  // namespace etcm::firmware
