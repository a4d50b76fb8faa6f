#include "firmware/config/unit_count.h"

#include <algorithm>
#include <array>
#include <vector>

namespace etcm::firmware {

std::uint32_t count_units(const Settings& settings) {
  std::uint32_t count = 0;
  for (const BusSettings& bus : settings.buses) {
    std::array<bool, 256> is_unit{};
    for (const std::vector<UnitRange>* const ranges : {&bus.units, &bus.assign, &bus.scan}) {
      for (const UnitRange range : *ranges) {
        for (const ModbusAddress address : range) is_unit[address.value] = true;
      }
    }
    if (!bus.assign.empty()) is_unit[default_unit.value] = true;
    count += static_cast<std::uint32_t>(std::count(is_unit.begin(), is_unit.end(), true));
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
