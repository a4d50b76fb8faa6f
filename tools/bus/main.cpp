// etcm-bus: for the person with a laptop on the bus.
#include <exception>

#include "command.h"
#include "command_line/command_line.h"

int main(int argc, char** argv) {
  using namespace etcm;
  CLI::App program("Asks the units of a Modbus bus, on a serial line or over TCP.", "etcm-bus");
  program.footer(
      "Exit codes: 0 done; 1 the bus: no port, no answer, or not what was written; 2 bad command\n"
      "line, nothing was sent; 130 interrupted.");
  bus::Run run;
  bus::add_scan_command(program, run);
  bus::add_poll_command(program, run);
  bus::add_probe_command(program, run);
  bus::add_read_command(program, run);
  bus::add_write_command(program, run);
  if (const auto end = command_line::parse(program, argc, argv)) return *end;
  try {
    return command_line::finish(program, run());
  } catch (const bus::UsageError& error) {
    return command_line::complain(program, bus::exit_bad_usage, error.what());
  } catch (const bus::LinkError& error) {
    return command_line::complain(program, bus::exit_trouble, error.what());
  } catch (const bus::Interrupted&) {
    return bus::exit_interrupted;
  } catch (const std::exception& error) {
    return command_line::complain(program, bus::exit_trouble, error.what());
  }
}
