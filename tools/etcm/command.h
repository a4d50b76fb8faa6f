// The program's subcommands, one file each, and what they share.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

#include "etcm/domain.h"
#include "etcm/files/grid.h"

namespace etcm::cli {

enum ExitCode : int {
  exit_ok = 0,
  exit_io = 1,          // an output cannot be written
  exit_bad_input = 2,   // the input or the command line is wrong; nothing is written
  exit_unresolved = 3,  // the mesh is written, but some feature is not conforming
  exit_not_a_mesh = 4,  // verify: a rule is broken
};

// The command line contradicts itself. what() is one line.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Each adds its subcommand; the callback it leaves in `run` does the work when it is chosen and
// returns an ExitCode. Errors of etcm/files/error.h pass through.
using Run = std::function<int()>;
void add_analyse_command(CLI::App& program, Run& run);
void add_interpolate_command(CLI::App& program, Run& run);
void add_mesh_command(CLI::App& program, Run& run);
void add_nearest_command(CLI::App& program, Run& run);
void add_replay_command(CLI::App& program, Run& run);
void add_size_command(CLI::App& program, Run& run);
void add_verify_command(CLI::App& program, Run& run);
void add_what_if_command(CLI::App& program, Run& run);
void add_export_command(CLI::App& program, Run& run);

// --scale and --round, which several subcommands take.
class PlacementOptions {
 public:
  void add_to(CLI::App& command);
  // Throws UsageError.
  files::Placement placement() const;

 private:
  std::string scale_;
  bool round_ = false;
};

// The place that --at names, in coordinates of the input. Throws UsageError.
Point place_at(const std::string& text, const files::Placement& placement);

// --domain, likewise.
class DomainOption {
 public:
  void add_to(CLI::App& command);
  Exterior exterior() const;

 private:
  std::string name_ = "automatic";
};

// --policy, and what its values name.
void add_policy_option(CLI::App& command, std::string& name);
SplitPolicy policy_named(const std::string& name);

// Prints to the standard output; throws OutputError when nobody listens or the disk is full.
void print(const std::string& text);

}  // namespace etcm::cli
