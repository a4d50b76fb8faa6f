// The program's subcommands, one file each, and what they share.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "link.h"
#include "master.h"
#include "values.h"

namespace etcm::bus {

enum ExitCode : int {
  exit_ok = 0,
  exit_trouble = 1,    // the bus: no port, no answer, or not what was written
  exit_bad_usage = 2,  // the command line; nothing was sent
  exit_interrupted = 130,
};

// The command line contradicts itself. what() is one line.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Each adds its subcommand; the callback it leaves in `run` does the work when it is chosen and
// returns an ExitCode. UsageError, LinkError and Interrupted pass through.
using Run = std::function<int()>;
void add_scan_command(CLI::App& program, Run& run);
void add_poll_command(CLI::App& program, Run& run);
void add_probe_command(CLI::App& program, Run& run);
void add_read_command(CLI::App& program, Run& run);
void add_write_command(CLI::App& program, Run& run);

// Which bus, how it is set, and whom to ask: what all subcommands take, under mbpoll's names.
class BusOptions {
 public:
  // `units` and `timeout_s` are what holds where the user gives none.
  BusOptions(std::string units, std::string timeout_s)
      : units_(std::move(units)), timeout_s_(std::move(timeout_s)) {}

  // Whether mbpoll's -0 and -1 are options, or -1 is a value as -12 is.
  enum class Digits : std::uint8_t { are_options, begin_values };
  void add_to(CLI::App& command, Digits digits = Digits::are_options);

  // `least` is 0 where a broadcast is meant to be possible, else 1.
  std::vector<std::uint8_t> units(int least = 1) const;
  port::Duration timeout() const;
  std::unique_ptr<Link> open() const;
  bool is_once() const { return is_once_; }

 private:
  bool is_serial() const;

  std::string mode_;
  std::string device_;
  std::string units_;
  std::string timeout_s_;
  std::uint16_t tcp_port_ = 502;
  port::SerialLine line_;
  std::string parity_ = "even";
  bool has_rts_ = false;
  bool is_once_ = false;
  bool is_as_always_ = false;  // asked for, and so anyway
  bool is_verbose_ = false;
};

// -t and --word-order: the table of coils, inputs or registers, and what stands in them.
class TypeOptions {
 public:
  void add_to(CLI::App& command, std::string table);
  std::uint8_t function() const;  // that reads the table
  bool are_bits() const;          // else registers
  ValueType type() const;

 private:
  std::string table_;
  std::string order_ = "ABCD";
};

// -r, an address from 0; decimal or 0x....
void add_first_option(CLI::App& command, std::string& text);
std::uint16_t parse_first(const std::string& text);

// "3.2 ms".
std::string milliseconds_text(port::Duration duration);

}  // namespace etcm::bus
