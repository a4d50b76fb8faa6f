// The unit that a saved node answered at.
#pragma once

#include "firmware/persist/saved_state.h"
#include "firmware/polling/poller.h"

namespace etcm::firmware {

// None where it is asked no more, or answered nowhere. O(units).
inline UnitIndex saved_unit(const Poller& poller, const SavedState& saved, const SavedNode& node) {
  if (node.bus == no_saved_bus) return UnitIndex::none();
  for (UnitIndex unit{0}; unit.value < poller.unit_count(); ++unit.value) {
    if (poller.address_of(unit) == ModbusAddress{node.address} &&
        saved_bus_name(poller.bus(poller.bus_of(unit)).name) == saved.buses[node.bus]) {
      return unit;
    }
  }
  return UnitIndex::none();
}

}  // namespace etcm::firmware
