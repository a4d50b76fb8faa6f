// etcm-compare: the systems of the paper, ours and CGAL's, by the paper's five criteria.
#include <exception>
#include <iostream>

#include "command_line/command_line.h"
#include "compare/commands.h"

int main(int argc, char** argv) {
  CLI::App program("Compares conforming Delaunay meshers by the five criteria of the ETCM paper.",
                   "etcm-compare");
  etcm::compare::Run run;
  etcm::compare::add_experiment_command(program, run);
  etcm::compare::add_generate_command(program, run);
  etcm::compare::add_file_command(program, run);
  if (const auto end = etcm::command_line::parse(program, argc, argv)) return *end;
  try {
    return run();
  } catch (const std::exception& error) {
    std::cerr << "etcm-compare: " << error.what() << '\n';
    return 2;
  }
}
