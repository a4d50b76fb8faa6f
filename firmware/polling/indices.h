// How units and buses are counted.
#pragma once

#include "firmware/protocol/strong_id.h"

namespace etcm::firmware {

// Units are counted over all buses, from 0.
using UnitIndex = StrongId<struct UnitTag>;

// Buses are counted as they are configured, from 0.
using BusIndex = StrongId<struct BusTag>;

}  // namespace etcm::firmware
