// etcm-compare generate: one graph of the experiment as a .poly.
#include <memory>
#include <sstream>

#include "compare/commands.h"
#include "etcm/files/file_set.h"
#include "inputs/random_graph.h"

namespace etcm::compare {
namespace {

struct GenerateOptions {
  std::size_t nodes = 60;
  std::uint64_t seed = 1;
  std::string length = "long";
  std::string output = "-";
};

std::string poly_text(const inputs::Graph& graph) {
  std::ostringstream out;
  out << "# " << graph.name << '\n' << graph.nodes.size() << " 2 0 0\n";
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    out << i + 1 << ' ' << graph.nodes[i].x << ' ' << graph.nodes[i].y << '\n';
  }
  out << graph.features.size() << " 0\n";
  for (std::size_t i = 0; i < graph.features.size(); ++i) {
    out << i + 1 << ' ' << graph.features[i].from.value << ' ' << graph.features[i].to.value
        << '\n';
  }
  out << "0\n";
  return out.str();
}

int generate(const GenerateOptions& options) {
  const auto length =
      options.length == "long" ? inputs::FeatureLength::any : inputs::FeatureLength::in_reach;
  files::FileSet files;
  files.add(options.output, poly_text(inputs::random_graph(options.nodes, length, options.seed)));
  files.commit();
  return 0;
}

}  // namespace

void add_generate_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<GenerateOptions>();
  CLI::App& command = *program.add_subcommand(
      "generate", "Write a graph of the experiment as a .poly: the same bits on every machine");
  command.add_option("--nodes", options->nodes, "How many nodes; features are 15 % of them")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command
      .add_option("--features", options->length,
                  "long: any pair of nodes that fits; short: within four mean spacings")
      ->check(CLI::IsMember({"long", "short"}))
      ->capture_default_str();
  command.add_option("--seed", options->seed, "Which graph")->capture_default_str();
  command.add_option("-o,--output", options->output, "The file; - is the standard output")
      ->type_name("FILE")
      ->capture_default_str();
  command.callback([options, &run] { run = [options] { return generate(*options); }; });
}

}  // namespace etcm::compare
