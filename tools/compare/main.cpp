// etcm-compare: the systems of the paper, ours and CGAL's, by the paper's five criteria.
#include <exception>
#include <iostream>

#include "compare/commands.h"

int main(int argc, char** argv) {
  CLI::App program("Compares conforming Delaunay meshers by the five criteria of the ETCM paper.",
                   "etcm-compare");
  program.require_subcommand(0, 1);
  etcm::compare::Run run;
  etcm::compare::add_experiment_command(program, run);
  etcm::compare::add_generate_command(program, run);
  etcm::compare::add_file_command(program, run);
  CLI11_PARSE(program, argc, argv);
  if (!run) {
    std::cout << program.help();
    return 2;
  }
  try {
    return run();
  } catch (const std::exception& error) {
    std::cerr << "etcm-compare: " << error.what() << '\n';
    return 2;
  }
}
