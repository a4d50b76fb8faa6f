// etcm-bench: how fast, and how few points, beside CGAL.
#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "bench/cliffs.h"
#include "bench/corpus_table.h"
#include "bench/fewer_table.h"
#include "bench/poly_entries.h"
#include "bench/speed.h"
#include "bench/work_table.h"
#include "command_line/command_line.h"
#include "inputs/corpus.h"

namespace {

int print_corpus(const std::vector<std::string>& poly_paths) {
  auto entries = etcm::inputs::corpus();
  auto from_files = etcm::bench::read_entries(poly_paths);
  std::move(from_files.begin(), from_files.end(), std::back_inserter(entries));
  return etcm::bench::print_corpus_table(entries, std::cout) ? 0 : 1;
}

int run_benchmarks() {
  etcm::bench::register_speed();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures the mesher, beside CGAL where it was found at build time.", "etcm-bench");
  app.footer(
      "Without options: the timed benchmarks, with all of Google Benchmark's own\n"
      "options (--benchmark_filter=REGEX, --benchmark_format=json, ...).");
  bool corpus = false;
  bool fewer = false;
  bool work = false;
  std::vector<std::string> poly_paths;
  std::string cliff_filter;
  auto* const cliffs =
      app.add_option("--cliffs", cliff_filter,
                     "Print how the time of hard inputs grows with their size instead; of those "
                     "whose name has this in it")
          ->expected(0, 1);
  app.add_flag("--corpus", corpus, "Print the table of Steiner counts over the corpus instead");
  app.add_flag("--fewer", fewer, "Print what looking for fewer Steiner vertices comes to instead");
  app.add_flag("--work", work, "Print how long a unit of work takes instead");
  app.add_option("--poly", poly_paths, "More inputs for the table: .poly files in whole units");
  const bool asks_for_help = argc == 2 && std::string(argv[1]) == "--help";
  if (!asks_for_help) benchmark::Initialize(&argc, argv);
  if (const auto end = etcm::command_line::parse(app, argc, argv)) return *end;
  try {
    if (fewer) return etcm::bench::print_fewer_table(std::cout) ? 0 : 1;
    if (cliffs->count() != 0) return etcm::bench::print_cliffs(cliff_filter, std::cout) ? 0 : 1;
    if (work) return etcm::bench::print_work_table(std::cout) ? 0 : 1;
    return corpus || !poly_paths.empty() ? print_corpus(poly_paths) : run_benchmarks();
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
