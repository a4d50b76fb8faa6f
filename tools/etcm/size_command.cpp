// etcm size --nodes N --features M
#include <cstdint>
#include <memory>
#include <string>

#include "command.h"
#include "etcm/config.h"

namespace etcm::cli {

namespace {

struct SizeOptions {
  std::uint32_t nodes = 0;
  std::uint32_t features = 0;
  bool json = false;
};

// What ids of 16 bits can name, whatever the width of this program's (etcm/config.h).
constexpr std::uint32_t narrow_vertices_limit = 4094;
constexpr std::uint32_t narrow_features_limit = 8190;

int run_size(const SizeOptions& options) {
  const MeshConfig config = capacity_for(options.nodes, options.features);
  const std::string vertices = std::to_string(config.vertices_max);
  const std::string segments = std::to_string(config.features_max);
  const bool is_narrow =
      config.vertices_max <= narrow_vertices_limit && config.features_max <= narrow_features_limit;
  const auto bytes = [&](std::uint32_t id_bytes) {
    return std::to_string(storage_bytes_with(id_bytes, config.vertices_max, config.features_max));
  };
  if (options.json) {
    print("{\"vertices_max\": " + vertices + ", \"features_max\": " + segments +
          ", \"bytes_16\": " + (is_narrow ? bytes(2) : "null") + ", \"bytes_32\": " + bytes(4) +
          "}\n");
    return exit_ok;
  }
  print("MeshStorage<" + vertices + ", " + segments + ">\nids of 16 bits: " +
        (is_narrow ? bytes(2) + " bytes"
                   : "too many, they name " + std::to_string(narrow_vertices_limit) +
                         " vertices and " + std::to_string(narrow_features_limit) + " segments") +
        "\nids of 32 bits: " + bytes(4) + " bytes\n");
  return exit_ok;
}

}  // namespace

void add_size_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<SizeOptions>();
  CLI::App& command = *program.add_subcommand(
      "size", "The capacities and the memory that a mesh takes, as a rule, for each width of ids");
  command.add_option("--nodes", options->nodes, "How many nodes")
      ->check(CLI::Range(std::uint32_t{1}, vertices_limit))
      ->required();
  command.add_option("--features", options->features, "How many features between any two of them")
      ->check(CLI::Range(std::uint32_t{0}, features_limit))
      ->capture_default_str();
  command.add_flag("--json", options->json, "One object on stdout instead of sentences");
  command.callback([options, &run] { run = [options] { return run_size(*options); }; });
}

}  // namespace etcm::cli
