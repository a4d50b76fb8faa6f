// An interrupt that reads while the main program writes: each read is of a whole mesh
// (lib/docs/readers.md). For a machine with a system timer. Leaves with 1 where one is not, or
// where there were too few.
#include <array>
#include <cstdint>

#include "console.h"
#include "published_mesh.h"

namespace {

using namespace etcm;
using test::put;
using test::put_number;

constexpr std::uint32_t vertices_max = 100, features_max = 8;
constexpr std::uint32_t crowd = 40, rounds = 12, change_count = 2 * crowd * rounds;
// Of the board's clock, between two interrupts: a few times what one takes.
#ifdef __ARM_ARCH_6M__
constexpr std::uint32_t ticks_between = 9000;
#else
constexpr std::uint32_t ticks_between = 2500;
#endif

volatile std::uint32_t& control() { return *reinterpret_cast<volatile std::uint32_t*>(0xE000E010); }
volatile std::uint32_t& reload() { return *reinterpret_cast<volatile std::uint32_t*>(0xE000E014); }
volatile std::uint32_t& current() { return *reinterpret_cast<volatile std::uint32_t*>(0xE000E018); }

using Published = example::PublishedMesh<vertices_max, features_max>;
Published published;
MeshStorage<vertices_max, features_max> storage;
std::array<std::uint64_t, change_count + 1> hashes;

// Of the interrupt.
std::uint32_t at, reads, torn;

Status set_up(Mesh& mesh, Work limit) noexcept {
  VertexId first, last;
  Status status = mesh.join({-10, 3}, first, limit);
  if (status == Status::ok) status = mesh.join({1010, 996}, last, limit);
  FeatureId fence;
  return status == Status::ok ? mesh.add_feature({first, last}, fence, limit) : status;
}

// All join, and leave in another order, over and over.
Status change(Mesh& mesh, std::uint32_t number, Work limit) noexcept {
  const std::uint32_t step = number % (2 * crowd);
  if (step >= crowd) return mesh.leave(VertexId{static_cast<IdValue>(3 + step * 7 % crowd)}, limit);
  const auto scatter = static_cast<std::int32_t>((number + 1) * 7919u % 100'003u);
  VertexId id;
  return mesh.join({scatter % 1000, scatter / 7 % 1000}, id, limit);
}

bool write_down() {
  Mesh mesh;
  if (mesh.open(storage.bytes(), storage.config()) != Status::ok) return false;
  if (set_up(mesh, Work::unlimited()) != Status::ok) return false;
  hashes[0] = mesh.hash();
  for (std::uint32_t i = 0; i < change_count; ++i) {
    static_cast<void>(change(mesh, i, Work::unlimited()));
    hashes[i + 1] = mesh.hash();
  }
  return true;
}

}  // namespace

// Looks on from where it was: a mesh that is older than the one before it does not find.
extern "C" void etcm_tick() {
  const std::uint64_t hash = published.read([](const Mesh& mesh) noexcept { return mesh.hash(); });
  std::uint32_t now = at;
  while (now <= change_count && hashes[now] != hash) ++now;
  ++reads;
  if (now > change_count) {
    ++torn;
  } else {
    at = now;
  }
}

int main() {
  const auto nothing = [] {};
  if (!write_down() || published.open() != Status::ok) return 1;
  if (published.change(set_up, Work::unlimited(), nothing) != Status::ok) return 1;
  reload() = ticks_between;
  current() = 0;
  control() = 7;  // enabled, with an interrupt, by the processor's clock
  for (std::uint32_t i = 0; i < change_count; ++i) {
    static_cast<void>(
        published.change([i](Mesh& mesh, Work limit) noexcept { return change(mesh, i, limit); },
                         Work::unlimited(), nothing));
  }
  control() = 0;
  put("reads by an interrupt: ");
  put_number(reads);
  put(", torn: ");
  put_number(torn);
  put("\n");
  return torn == 0 && reads >= change_count / 4 ? 0 : 1;
}
