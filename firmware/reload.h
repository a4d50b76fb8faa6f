// Takes a changed configuration over while the gateway runs.
#pragma once

#include <string>
#include <vector>

#include "etcm/port/log.h"
#include "settings.h"

namespace etcm::firmware {

// Makes `current` like `next` in all that can change while the gateway runs. Returns what differs
// and cannot, as it is written in the file: "[mesh] vertices_max".
std::vector<std::string> take_over(Settings& current, const Settings& next);

// Reads the whole configuration, and takes it over where nothing in it is wrong. Else `current`
// stays as it is, the log says why, and the answer is false.
bool reload(const std::string& path, Settings& current, port::Log& log);

}  // namespace etcm::firmware
