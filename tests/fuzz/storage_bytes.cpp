// attach() of any bytes. What seal() has vouched for is a mesh; anything else is refused, but what
// was forged on purpose, of which nothing is promised (storage.h), so nothing is asked of it.
//
// The first byte says whether these are any bytes, or those of a sealed mesh with some exchanged:
// two for the place and one for the byte, over and over.
#include <algorithm>
#include <cstring>
#include <vector>

#include "etcm/storage.h"
#include "inputs/patterns.h"
#include "mesh_changes.h"
#include "mesh_questions.h"
#include "support/mesh_block.h"

namespace etcm::fuzz {
namespace {

constexpr MeshConfig room{.vertices_max = 60, .features_max = 8};

// The same for each input.
test::MeshBlock& sealed() {
  static test::MeshBlock block(room);
  static const bool is_made = [] {
    const inputs::Graph graph = inputs::comb(6, 10, 400, 3);
    require(block->open(block.bytes(), room) == Status::ok, "open()");
    require(block->build(graph.nodes, graph.features) == Status::ok, "build()");
    seal(*block);
    return true;
  }();
  require(is_made, "a sealed mesh");
  return block;
}

// Whether all bytes are as they were that the checksum is of: those in use.
void attach_harmed(Input& input) {
  test::MeshBlock copy(sealed());
  const std::span<std::byte> bytes = copy.bytes();
  const std::size_t size = input.byte() == 1 ? input.word() % bytes.size() : bytes.size();
  while (!input.is_empty()) {
    const std::size_t at = input.word() % bytes.size();
    bytes[at] = std::byte{input.byte()};
  }
  // In memory that ends where it does.
  std::vector<std::uint64_t> words((size + 7) / 8);
  const std::span<std::byte> shorter = std::as_writable_bytes(std::span(words)).first(size);
  if (size != 0) std::memcpy(words.data(), bytes.data(), size);
  MeshReader reader;
  Mesh mesh;
  if (words.empty()) return;
  const Status status = attach(mesh, shorter);
  require(reader.attach(shorter) == status, "attach() and a MeshReader disagree");
  if (status != Status::ok) return;
  // Whoever forges the checksum gets what is in the bytes; here it is what was sealed.
  if (mesh.hash() != sealed()->hash()) return;
  ask_about_features(reader.mesh());
  compare_with_build(mesh);
}

void attach_any(Input& input) {
  const std::span<const std::uint8_t> given = input.rest();
  if (given.empty()) return;
  std::vector<std::uint64_t> words((given.size() + 7) / 8);
  std::memcpy(words.data(), given.data(), given.size());
  const std::span<std::byte> bytes = std::as_writable_bytes(std::span(words)).first(given.size());
  Mesh mesh;
  MeshReader reader;
  const Status status = attach(mesh, bytes);
  require(reader.attach(bytes) == status, "attach() and a MeshReader disagree");
  // The head alone is looked at.
  require(status != Status::ok || reader.attach_copy(bytes) == Status::ok, "attach_copy() refuses");
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  if (input.byte() % 2 == 0) return attach_any(input);
  attach_harmed(input);
}

}  // namespace etcm::fuzz
