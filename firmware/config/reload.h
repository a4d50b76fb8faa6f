// Takes a changed configuration over while the gateway runs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"

namespace etcm::firmware {

// Makes `current` like `next` in all that can change while the gateway runs. Returns what differs
// and cannot, as it is written in the file: "[mesh] vertices_max".
std::vector<std::string> take_over(Settings& current, const Settings& next);

// Of so many mistakes a reload tells each; --check-config tells them all.
inline constexpr std::size_t reload_mistakes_max = 20;
// From one reload to the next at the least, however often it is asked for.
inline constexpr port::Duration reload_pause = std::chrono::seconds(1);

// Reads the whole configuration, and takes it over where nothing in it is wrong. Else `current`
// stays as it is, the log says why, and the answer is false. Whoever asked waits for this answer,
// so the log should leave out none of its lines: they are few, and reload_pause apart.
bool reload(const std::string& path, Settings& current, port::Log& log);

}  // namespace etcm::firmware
