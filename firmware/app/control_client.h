// `etcm-gateway ctl`: what a person says to the gateway that runs on this machine.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace etcm::firmware {

// Where the installed service listens.
inline constexpr const char* control_socket_default = "/run/etcm/control";

// One line to the gateway at `socket`. Gives its answer piece by piece to `take`, without the first
// line. Returns what went wrong, with the cure; empty where nothing did.
std::string ask_gateway(const std::string& socket, const std::string& line,
                        const std::function<void(std::string_view)>& take);

// Adds the command `ctl`. `run` is set where the line has it; it gives the status to end with.
void add_control_command(CLI::App& app, std::function<int()>& run);

}  // namespace etcm::firmware
