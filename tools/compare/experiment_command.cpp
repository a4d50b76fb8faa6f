// etcm-compare experiment --out DIR
#include <filesystem>
#include <iostream>
#include <memory>

#include "compare/commands.h"
#include "compare/experiment.h"
#include "compare/progress.h"
#include "compare/report/figures.h"
#include "compare/report/mesh_panels.h"
#include "compare/report/tables.h"
#include "etcm/files/file_set.h"

namespace etcm::compare {
namespace {

struct ExperimentOptions {
  std::string folder;
  ExperimentPlan plan{.sizes = standard_sizes()};
  double limit_s = 60;
  bool no_figures = false;
};

int run_and_write(ExperimentOptions& options) {
  options.plan.limit = std::chrono::milliseconds(std::llround(options.limit_s * 1000));
  std::filesystem::create_directories(options.folder);
  Results results;
  {
    Progress progress;
    results = run_experiment(
        options.plan, [&](double done, const std::string& what) { progress.show(done, what); });
  }
  const std::string tables = experiment_tables(results);
  files::FileSet files;
  files.add(options.folder + "/runs.csv", runs_csv(results));
  files.add(options.folder + "/summary.csv", summary_csv(results));
  files.add(options.folder + "/tables.md", tables);
  files.add(options.folder + "/figure-1.svg",
            mesh_panels(inputs::random_graph(60, inputs::FeatureLength::any, 1)));
  files.commit();
  if (!options.no_figures) draw_figures(options.folder);
  std::cout << tables;
  return 0;
}

}  // namespace

void add_experiment_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<ExperimentOptions>();
  CLI::App& command =
      *program.add_subcommand("experiment", "Run the experiment of the paper's section 6");
  command.add_option("--out", options->folder, "Folder for CSV, tables and figures")
      ->required()
      ->type_name("DIR");
  command.add_option("--sizes", options->plan.sizes, "Numbers of nodes")
      ->check(CLI::Range(20, 5000))
      ->capture_default_str();
  command.add_option("--seeds", options->plan.seeds, "Graphs of each size and feature length")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option("--limit", options->limit_s, "Seconds that a system may spend on one graph")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_flag("--no-figures", options->no_figures, "Only CSV, tables and figure 1");
  command.callback([options, &run] { run = [options] { return run_and_write(*options); }; });
}

}  // namespace etcm::compare
