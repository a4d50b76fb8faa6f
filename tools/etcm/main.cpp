// etcm: conforming Delaunay meshes of files.
#include <signal.h>

#include <new>

#include "command.h"
#include "command_line/command_line.h"
#include "etcm/files/error.h"

int main(int argc, char** argv) {
  using namespace etcm;
  // A reader that went away and a file that may not grow are errors of a write, not sudden deaths.
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);

  CLI::App program("Conforming Delaunay meshes of constraint graphs, exactly.", "etcm");
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
  cli::add_what_if_command(program, run);
  cli::add_size_command(program, run);
  cli::add_verify_command(program, run);
  cli::add_export_command(program, run);
  if (const auto end = command_line::parse(program, argc, argv)) return *end;
  try {
    return run();
  } catch (const files::InputError& error) {
    return command_line::complain(program, cli::exit_bad_input, error.what());
  } catch (const cli::UsageError& error) {
    return command_line::complain(program, cli::exit_bad_input, error.what());
  } catch (const files::OutputError& error) {
    return command_line::complain(program, cli::exit_io, error.what());
  } catch (const std::bad_alloc&) {
    return command_line::complain(program, cli::exit_io,
                                  "out of memory; the input is too large for this machine");
  }
}
