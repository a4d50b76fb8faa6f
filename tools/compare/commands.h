// The program's commands, one file each.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace etcm::compare {

// What the command line chose; returns the exit status: 0, or 1 where some system failed.
using Run = std::function<int()>;

// Each leaves its work in `run` when it is chosen.
void add_experiment_command(CLI::App& program, Run& run);
void add_generate_command(CLI::App& program, Run& run);
// FILE.poly on the program itself.
void add_file_command(CLI::App& program, Run& run);

}  // namespace etcm::compare
