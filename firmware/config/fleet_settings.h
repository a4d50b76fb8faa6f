// What a member of a fleet needs to know of the settings.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/config/settings.h"
#include "firmware/fleet/fleet_member.h"

namespace etcm::firmware {

// Of a site; more are not taken in.
inline constexpr std::uint32_t fleet_members_max = 256;

// `run`: another number for each run of a program, on any machine; `version`: that program's.
// REQUIRES: settings.mqtt.
FleetSettings fleet_settings_of(const Settings& settings, std::uint64_t run = 0,
                                std::string_view version = {});

// In units of the mesh: places that are farther apart are not those of one node that stands still.
std::int64_t apart_min_of(const Settings& settings);

// Nodes of other gateways that there may be here: as many as the mesh has room for, where they are
// shared.
std::uint32_t foreign_room(const Settings& settings);

}  // namespace etcm::firmware
