// A life of a mesh: bytes are the room it has, then changes and questions, one behind another.
#include <vector>

#include "etcm/storage.h"
#include "mesh_changes.h"
#include "mesh_questions.h"
#include "support/analysis_check.h"
#include "support/mesh_block.h"

namespace etcm::fuzz {
namespace {

// Of more no other kind of step comes, and each is judged in time that grows with the mesh.
constexpr int steps_max = 150;
// Each takes as long as a hundred changes.
constexpr int analyses_max = 3;

MeshConfig config_of(Input& input) {
  MeshConfig config;
  const std::uint8_t room = input.byte();
  config.vertices_max = room < 128 ? 1 + room % 64 : 400;
  config.features_max = input.byte() % 48;
  const std::uint8_t budget = input.byte();
  if (budget >= 192) config.steiner_max = 1 + budget % 16;
  if (budget % 2 == 1) config.policy = split_paper;
  return config;
}

std::int32_t step_of(Input& input) {
  constexpr std::int32_t steps[] = {1, 2, 3, 7, 100, 1009, 65'536, position_max / 32 - 1};
  return steps[input.byte() % std::size(steps)];
}

// The bytes are all there is: a copy of them lives as the mesh does.
void seal_and_attach(test::MeshBlock& block) {
  seal(*block);
  test::MeshBlock copy(block);
  require(attach(*copy, copy.bytes(), block->config().policy) == Status::ok, "attach() refuses");
  require(copy->hash() == block->hash(), "attach() makes another mesh");
  MeshReader reader;
  require(reader.attach(copy.bytes()) == Status::ok, "a MeshReader refuses");
  require(reader.mesh().hash() == block->hash(), "a MeshReader reads another mesh");
  VertexId one, other;
  const Status status = block->join({1, -1}, one);
  require(copy->join({1, -1}, other) == status && one == other && copy->hash() == block->hash(),
          "the copy goes another way");
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  const MeshConfig config = config_of(input);
  const std::int32_t step = step_of(input);
  test::MeshBlock block(config);
  require(block->open(block.bytes(), config) == Status::ok, "open()");
  std::vector<std::uint32_t> numbers(Handles::words(config));
  Handles handles;
  require(handles.open(*block, numbers) == Status::ok, "open() of handles");
  MeshChanges changes(*block, handles, step);
  test::AnalysisCheck analysis(config.vertices_max, input.byte());
  for (int i = 0, analyses = 0; i < steps_max && !input.is_empty(); ++i) {
    const std::uint8_t kind = input.byte();
    if (kind < 230) changes.make_one(input);
    if (kind >= 230 && kind < 245) ask_everything(*block, input);
    if (kind >= 245 && kind < 252 && analyses++ < analyses_max) {
      const auto answer = analysis.of(*block);
      require(answer, answer.message());
    }
    if (kind >= 252 && kind < 254) seal_and_attach(block);
    if (kind >= 254) compare_with_build(*block);
  }
  ask_everything(*block, input);
  compare_with_build(*block);
}

}  // namespace etcm::fuzz
