#include "firmware/config/unit_count.h"

#include <algorithm>

namespace etcm::firmware {

std::uint32_t count_units(const Settings& settings) {
  std::uint32_t count = 0;
  for (const BusSettings& bus : settings.buses) {
    for (const ModbusAddress unit : UnitRange{.first = 1, .last = unit_max}) {
      if (asks(bus, unit)) ++count;
    }
  }
  return count;
}

UnitRoom unit_room_of(const Settings& settings) {
  const std::uint32_t buses = static_cast<std::uint32_t>(settings.buses.size()) + added_buses_max;
  return {.units = std::max(count_units(settings),
                            std::min(settings.mesh.vertices_max, buses * unit_max)),
          .buses = buses};
}

}  // namespace etcm::firmware
