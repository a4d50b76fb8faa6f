// Takes a changed configuration over while the gateway runs.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "firmware/config/settings.h"

namespace etcm::firmware {

// Makes `settings` like `next` in all that can change while the gateway runs. Returns what differs
// and cannot, as it is written in the file: "[mesh] vertices_max".
std::vector<std::string> take_over(Settings& settings, const Settings& next);

// Of so many mistakes a reload tells each; --check-config tells them all.
inline constexpr std::size_t reload_mistakes_max = 20;
// From one reload to the next at the least, however often it is asked for.
inline constexpr port::Duration reload_pause = std::chrono::seconds(1);

// Reads the whole configuration. The settings that hold from now on, where nothing in it is wrong;
// else null, and the log says why. Whoever asked waits for this answer, so the log should leave out
// none of its lines: they are few, and reload_pause apart. `refusal` becomes the same in one
// sentence for a person, with the cure; empty where nothing is wrong. `waiting`, where it is not
// null, becomes what differs now and needs a restart; where something is wrong it stays as it was.
std::shared_ptr<const Settings> reload(const std::string& path, const Settings& current,
                                       port::ProjectionSource* projections, port::Log& log,
                                       std::string& refusal,
                                       std::vector<std::string>* waiting = nullptr);

}  // namespace etcm::firmware
