// etcm-bus: for the person with a laptop on the bus.
#include <cstdio>
#include <exception>

#include "command.h"

namespace {

int complain(int code, const std::string& message) {
  std::fprintf(stderr, "etcm-bus: %s\n", message.c_str());
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace etcm;
  CLI::App program("Asks the units of a Modbus bus, on a serial line or over TCP.", "etcm-bus");
  // That one is there is asked below: CLI11 would ask it before it names a word that it does not
  // know.
  program.require_subcommand(0, 1);
  program.footer(
      "Exit codes: 0 done; 1 the bus: no port, no answer, or not what was written; 2 bad command\n"
      "line, nothing was sent; 130 interrupted.");
  bus::Run run;
  bus::add_scan_command(program, run);
  bus::add_poll_command(program, run);
  bus::add_probe_command(program, run);
  bus::add_read_command(program, run);
  bus::add_write_command(program, run);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return program.exit(success);
  } catch (const CLI::ParseError& error) {
    return complain(bus::exit_bad_usage,
                    std::string(error.what()) + " (etcm-bus --help tells more)");
  }
  if (!run)
    return complain(bus::exit_bad_usage, "a command is required (etcm-bus --help tells which)");
  try {
    return run();
  } catch (const bus::UsageError& error) {
    return complain(bus::exit_bad_usage, error.what());
  } catch (const bus::LinkError& error) {
    return complain(bus::exit_trouble, error.what());
  } catch (const bus::Interrupted&) {
    return bus::exit_interrupted;
  } catch (const std::exception& error) {
    return complain(bus::exit_trouble, error.what());
  }
}
