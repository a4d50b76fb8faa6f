// etcm: conforming Delaunay meshes of files.
#include <signal.h>

#include <iostream>
#include <new>

#include "command.h"
#include "etcm/files/error.h"

namespace {

int complain(int code, const std::string& message) {
  std::cerr << "etcm: " << message << std::endl;
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace etcm;
  // A reader that went away and a file that may not grow are errors of a write, not sudden deaths.
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);

  CLI::App program("Conforming Delaunay meshes of constraint graphs, exactly.", "etcm");
  // That one is there is asked below: CLI11 would ask it before it names a word that it does not
  // know.
  program.require_subcommand(0, 1);
  program.footer(
      "Exit codes: 0 done; 1 an output cannot be written; 2 bad input or command line, nothing\n"
      "written; 3 written, but some feature is not conforming (over budget); 4 verify: a rule of\n"
      "the mesh is broken.");
  cli::Run run;
  cli::add_analyse_command(program, run);
  cli::add_interpolate_command(program, run);
  cli::add_nearest_command(program, run);
  cli::add_mesh_command(program, run);
  cli::add_replay_command(program, run);
  cli::add_verify_command(program, run);
  cli::add_export_command(program, run);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return program.exit(success);
  } catch (const CLI::ParseError& error) {
    return complain(cli::exit_bad_input, std::string(error.what()) + " (etcm --help tells more)");
  }
  if (!run) return complain(cli::exit_bad_input, "a command is required (etcm --help tells which)");
  try {
    return run();
  } catch (const files::InputError& error) {
    return complain(cli::exit_bad_input, error.what());
  } catch (const cli::UsageError& error) {
    return complain(cli::exit_bad_input, error.what());
  } catch (const files::OutputError& error) {
    return complain(cli::exit_io, error.what());
  } catch (const std::bad_alloc&) {
    return complain(cli::exit_io, "out of memory; the input is too large for this machine");
  }
}
