// The hash of the mesh of each input of the corpus, by each policy, a line each. What it prints
// must be the same on every machine.
#include <cinttypes>
#include <cstdio>

#include "etcm/policy.h"
#include "inputs/corpus.h"
#include "inputs/owned_mesh.h"

namespace {

// The policy `paper` does not end on all of them; then the partial mesh is compared.
constexpr std::size_t steiner_room_per_input = 3;
constexpr std::size_t steiner_room_least = 2000;

void print(const etcm::inputs::Graph& graph, const char* policy_name, etcm::SplitPolicy policy) {
  const std::size_t inputs = graph.nodes.size() + graph.features.size();
  etcm::inputs::OwnedMesh mesh(etcm::inputs::config_for(
      graph, steiner_room_least + steiner_room_per_input * inputs, policy));
  const etcm::Status status =
      mesh.opened() == etcm::Status::ok ? mesh->build(graph.nodes, graph.features) : mesh.opened();
  std::printf("%s, %s: %s, %u Steiner vertices, %016" PRIx64 "\n", graph.name.c_str(), policy_name,
              etcm::to_string(status), static_cast<unsigned>(mesh->steiner_count()), mesh->hash());
}

}  // namespace

int main() {
  for (const auto& entry : etcm::inputs::corpus()) {
    print(entry.graph, "default", etcm::split_default);
    print(entry.graph, "paper", etcm::split_paper);
  }
}
