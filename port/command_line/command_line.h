// What the programs here do alike with their command lines.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

namespace etcm::command_line {

inline constexpr int exit_bad_usage = 2;

// Adds --version and reads the line. A program with commands wants one of them, or what stands in
// the place of one. Returns what to end with where there is nothing more to do: 0 after --help and
// --version; `exit_bad_usage` for a line that is not understood, which has been told with where to
// look.
[[nodiscard]] std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

// Says it with the program's name, and returns the code.
int complain(const CLI::App& app, int code, const std::string& message);

// What a program ends with that would end with `code`: `exit_no_output`, told, where what it has
// printed could not be written.
inline constexpr int exit_no_output = 1;
[[nodiscard]] int finish(const CLI::App& app, int code);

}  // namespace etcm::command_line
