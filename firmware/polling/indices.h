// How units, buses and quantities are counted.
#pragma once

#include "firmware/protocol/strong_id.h"

namespace etcm::firmware {

// Units are counted over all buses, from 0.
using UnitIndex = StrongId<struct UnitTag>;

// Buses are counted as they are configured, from 0.
using BusIndex = StrongId<struct BusTag>;

// Quantities are counted as quantities_of() lists them, from 0.
using QuantityIndex = StrongId<struct QuantityTag>;

}  // namespace etcm::firmware
