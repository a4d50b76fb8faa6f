// What a reload takes over of buses, devices, profiles and surveyed nodes: it may add to them.
#pragma once

#include <string>
#include <vector>

#include "firmware/config/settings.h"

namespace etcm::firmware {

// Makes `current` like `next`, all of it or nothing: where something has to wait for a restart,
// that is added to `fixed`, as it is written in the file, and so is all else that differs. New
// buses stand behind those there are; units, devices and profiles that there are stay what they
// are; no more of them are added than settings.room has room for.
void take_over_buses(Settings& current, Settings& next, std::vector<std::string>& fixed);

}  // namespace etcm::firmware
