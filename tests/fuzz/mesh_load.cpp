// Mesh::load() of any bytes: nothing in them is believed, so whatever they are, the mesh is whole
// or empty. One byte says how much room there is, whether the bytes are those of a small mesh in
// which some words are changed, and whether the checksum is made right, and the hash of the mesh
// too; one the limit.
#include <optional>
#include <vector>

#include "base/checksum.h"
#include "etcm/audit.h"
#include "inputs/owned_mesh.h"
#include "mesh/saved.h"
#include "mesh_changes.h"
#include "mesh_questions.h"
#include "triangulation/mesh_state.h"

namespace etcm::fuzz {

// The linker has load() ask here (--wrap): what it compares with what is saved, a forger knows too.
std::uint64_t hash_in_library(const Mesh& mesh, const internal::MeshState& state,
                              internal::WorkMeter* work) noexcept asm("__real_" ETCM_HASH_SYMBOL);
std::uint64_t hash_overheard(const Mesh& mesh, const internal::MeshState& state,
                             internal::WorkMeter* work) noexcept asm("__wrap_" ETCM_HASH_SYMBOL);

namespace {

using namespace internal;

std::optional<std::uint64_t> overheard;

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    word |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  }
  return word;
}

void put(std::span<std::byte> bytes, std::size_t at, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<std::byte>(value >> (8 * i));
}

// As somebody would who forges a mesh.
void make_checksum_right(std::span<std::byte> saved) {
  if (saved.size() < saved_head_bytes || word_at(saved, 12) == 0) return;
  const std::uint64_t whole = saved_size(word_at(saved, 12), word_at(saved, 16));
  if (whole > saved.size()) return;
  const auto before = static_cast<std::size_t>(whole) - saved_tail_bytes;
  Checksum sum;
  sum.add(saved.data(), before);
  put(saved, before, sum.value(), saved_tail_bytes);
}

// The same of a forger who has read how a mesh is hashed; nothing where load() does not come so
// far.
void make_hash_right(std::span<std::byte> saved, Mesh& mesh) {
  overheard.reset();
  static_cast<void>(mesh.load(saved));
  mesh.clear();
  if (!overheard) return;
  put(saved, 32, *overheard, 8);
  make_checksum_right(saved);
}

// Some places of two rows, so that nodes are on one line, and features between them that the mesh
// takes; as save() writes it.
std::vector<std::byte> small_mesh(Input& input) {
  inputs::OwnedMesh mesh({.vertices_max = 20, .features_max = 10});
  std::vector<Position> nodes;
  const std::uint8_t places = input.byte();
  for (std::int32_t i = 0; i < 8; ++i) {
    if ((places >> i & 1) != 0) nodes.push_back({.x = i / 2, .y = i % 2});
  }
  require(mesh->build(nodes, {}) == Status::ok, "build() of nodes alone");
  for (std::uint32_t i = input.below(6); i > 0 && nodes.size() > 1; --i) {
    const auto end = [&] {
      const auto count = static_cast<std::uint32_t>(nodes.size());
      return VertexId{static_cast<IdValue>(1 + input.below(count))};
    };
    FeatureId feature;
    const VertexId from = end(), to = end();
    static_cast<void>(mesh->add_feature({from, to}, feature));
  }
  std::vector<std::byte> saved(mesh->saved_bytes());
  require(mesh->save(saved) == Status::ok, "save()");
  return saved;
}

// A word or two of its segments become other ids, or none; at times one of its vertices.
void change_words(std::vector<std::byte>& saved, Input& input) {
  const std::uint32_t vertex_end = word_at(saved, 12), segment_end = word_at(saved, 16);
  const std::size_t vertices_at = saved_head_bytes;
  const std::size_t segments_at = vertices_at + saved_vertex_bytes * (vertex_end - 1);
  for (std::uint32_t i = 1 + input.below(2); i > 0; --i) {
    const std::uint8_t kind = input.byte();
    const bool is_vertex = kind >= 224 || segment_end == 0;
    const std::uint32_t words = is_vertex ? 2 * (vertex_end - 1) : 4 * segment_end;
    if (words == 0) return;
    const std::size_t at = (is_vertex ? vertices_at : segments_at) + 4 * input.below(words);
    std::uint32_t word = kind % 4 != 0 ? input.below(vertex_end) : saved_nobody;
    if (is_vertex) word = word_at(saved, at) + input.below(3) - 1;
    put(saved, at, word, 4);
  }
}

// It goes on as any other mesh does.
void live_on(Mesh& mesh, Input& input) {
  ask_everything(mesh, input);
  std::vector<std::uint32_t> numbers(Handles::words(mesh.config()));
  Handles handles;
  require(handles.open(mesh, numbers) == Status::ok, "open() of handles");
  MeshChanges changes(mesh, handles, 100);
  for (int i = 0; i < 16 && !input.is_empty(); ++i) changes.make_one(input);
  compare_with_build(mesh);
}

}  // namespace

std::uint64_t hash_overheard(const Mesh& mesh, const MeshState& state, WorkMeter* work) noexcept {
  overheard = hash_in_library(mesh, state, work);
  return *overheard;
}

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  const std::uint8_t choice = input.byte(), limit = input.byte();
  std::vector<std::byte> saved;
  if (choice >= 128) {
    saved = small_mesh(input);
    change_words(saved, input);
  }
  const std::span<const std::uint8_t> given = input.rest();
  if (choice < 128) {
    const auto bytes_given = std::as_bytes(given);
    saved.assign(bytes_given.begin(), bytes_given.end());
  }
  if (choice % 4 != 0) make_checksum_right(saved);
  inputs::OwnedMesh mesh({.vertices_max = choice < 32 ? 20u : 600u,
                          .features_max = choice < 64 ? 10u : 300u,
                          .steiner_max = choice < 96 ? 4u : 0u});
  require(mesh.opened() == Status::ok, "open()");
  if (choice % 4 == 3) make_hash_right(saved, *mesh);
  const Work most = limit < 240 ? Work::unlimited() : Work{std::uint64_t{1} << (limit % 16)};
  const Status status = mesh->load(saved, most);
  require(mesh->work_used() <= most, "load() has worked more than it may");
  require(audit(*mesh).broken == Rule::none, "load() leaves what fails its audit");
  if (status != Status::ok) {
    require(mesh->node_count() == 0 && mesh->feature_count() == 0 && mesh->steiner_count() == 0,
            "a refused load() left something");
  }
  // Changes are made of the same bytes.
  Input changes(given);
  live_on(*mesh, changes);
}

}  // namespace etcm::fuzz
