// Bytes that somebody else has written, as a mesh.
#include <cstring>
#include <new>
#include <type_traits>

#include "base/checksum.h"
#include "etcm/storage.h"
#include "triangulation/mesh_arrays.h"
#include "triangulation/mesh_state.h"
#include "triangulation/pulse.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

// What lasts lies at the same place on every machine. Another figure is another version of Seal.
static_assert(sizeof(PaddedArrays) == arrays_room);
static_assert(sizeof(KeptState) == (sizeof(IdValue) == 2 ? 544 : 560));
static_assert(std::is_trivially_copyable_v<MeshState>);

namespace {

constexpr std::uint64_t reversed(std::uint64_t word) noexcept {
  std::uint64_t other = 0;
  for (int i = 0; i < 8; ++i) other |= ((word >> (8 * i)) & 0xff) << (56 - 8 * i);
  return other;
}

std::uint64_t checksum_of(const KeptState& kept, const MeshArrays& arrays,
                          const Mesh& mesh) noexcept {
  Pulse pulse(mesh);
  Checksum sum;
  // The checksum itself is the last word.
  const auto* const first = reinterpret_cast<const std::byte*>(&kept);
  const auto* const last = reinterpret_cast<const std::byte*>(&kept.seal.checksum);
  sum_up(sum, first, static_cast<std::size_t>(last - first), pulse);
  const auto add = [&](const auto* elements, std::size_t begin, std::size_t end) noexcept {
    sum_up(sum, reinterpret_cast<const std::byte*>(elements + begin),
           (end - begin) * sizeof(*elements), pulse);
  };
  // Only what has been written: the infinite vertex stands nowhere and belongs to nothing.
  add(arrays.points, 1, kept.vertex_end);
  add(arrays.owners, 1, kept.vertex_end);
  add(arrays.segments, 0, kept.segment_end);
  const std::size_t triangles = arrays.topology.triangle_count();
  if (triangles == 0) return sum.value();
  add(arrays.topology.triangle_memory(), 0, triangles);
  add(arrays.vertex_edges, 0, kept.vertex_end);
  add(arrays.hint_cells, 0, std::size_t{1} << (2 * kept.hints.side_bits));
  return sum.value();
}

// Whether counts are within the capacities, so that nothing is read outside of the storage.
bool is_within(const KeptState& kept) noexcept {
  const std::uint64_t vertices = std::uint64_t{kept.node_count} + kept.steiner_count;
  return kept.vertex_end >= 1 && kept.vertex_end <= kept.config.vertices_max + 1u &&
         kept.segment_end <= kept.config.features_max && vertices < kept.vertex_end &&
         kept.feature_count <= kept.segment_end && kept.place_count <= places_most &&
         kept.hints.side_bits_most == hint_side_bits(kept.config.vertices_max) &&
         kept.hints.side_bits >= 0 && kept.hints.side_bits <= kept.hints.side_bits_most;
}

const MeshState& head_at(std::span<const std::byte> storage) noexcept {
  return *std::launder(reinterpret_cast<const MeshState*>(storage.data()));
}

Status look_at_head(std::span<const std::byte> storage) noexcept {
  demand(storage.data() != nullptr &&
             reinterpret_cast<std::uintptr_t>(storage.data()) % alignof(MeshState) == 0,
         Call::attach, Fault::bad_storage);
  if (storage.size() < bytes_head) return Status::storage_too_small;
  const KeptState& kept = head_at(storage);
  constexpr Seal ours;
  if (kept.seal.magic == reversed(ours.magic)) return Status::wrong_byte_order;
  if (kept.seal.magic != ours.magic) return Status::not_a_mesh;
  if (kept.seal.version != ours.version) return Status::wrong_version;
  if (kept.seal.id_bits != ours.id_bits) return Status::wrong_id_width;
  const KeptConfig& config = kept.config;
  if (config.vertices_max < 1 || config.vertices_max > vertices_limit ||
      config.features_max > features_limit ||
      kept.seal.bytes !=
          storage_bytes_as<std::uint64_t>(config.vertices_max, config.features_max)) {
    return Status::damaged;
  }
  if (kept.seal.bytes > storage.size()) return Status::storage_too_small;
  return is_within(kept) ? Status::ok : Status::damaged;
}

// The arrays of storage whose head is right. Who may only read the bytes gets no other address.
MeshArrays arrays_at(std::span<const std::byte> storage) noexcept {
  return arrays_of(head_at(storage), const_cast<std::byte*>(storage.data()));
}

Status look_at_all(const Mesh& mesh, std::span<const std::byte> storage) noexcept {
  const Status status = look_at_head(storage);
  if (status != Status::ok) return status;
  const KeptState& kept = head_at(storage);
  const bool is_whole = kept.seal.checksum == checksum_of(kept, arrays_at(storage), mesh);
  return is_whole ? Status::ok : Status::damaged;
}

Status take(Mesh& mesh, std::span<std::byte> storage, Status looked, SplitPolicy policy,
            void* policy_context) noexcept {
  if (looked != Status::ok) return looked;
  if (policy == nullptr) return Status::bad_config;
  auto& m = *std::launder(reinterpret_cast<MeshState*>(storage.data()));
  static_cast<MeshArrays&>(m) = arrays_at(storage);
  static_cast<OwnState&>(m) = OwnState{};
  m.policy = policy;
  m.policy_context = policy_context;
  m.mesh = &mesh;
  MeshAccess::give(mesh, &m);
  return Status::ok;
}

}  // namespace

void seal(Mesh& mesh) noexcept {
  MeshState& m = about_to_change(mesh, Call::seal);
  m.seal.checksum = checksum_of(m, m, mesh);
}

Status attach(Mesh& mesh, std::span<std::byte> storage, SplitPolicy policy,
              void* policy_context) noexcept {
  return take(mesh, storage, look_at_all(mesh, storage), policy, policy_context);
}

Status attach_copy(Mesh& mesh, std::span<std::byte> storage, SplitPolicy policy,
                   void* policy_context) noexcept {
  return take(mesh, storage, look_at_head(storage), policy, policy_context);
}

void MeshReader::take(std::span<const std::byte> storage) noexcept {
  auto* const m = ::new (head_.data()) MeshState(head_at(storage));
  static_cast<MeshArrays&>(*m) = arrays_at(storage);
  static_cast<OwnState&>(*m) = OwnState{};
  m->mesh = &mesh_;
  MeshAccess::give(mesh_, m);
}

Status MeshReader::attach(std::span<const std::byte> storage) noexcept {
  const Status status = look_at_all(mesh_, storage);
  if (status == Status::ok) take(storage);
  return status;
}

Status MeshReader::attach_copy(std::span<const std::byte> storage) noexcept {
  const Status status = look_at_head(storage);
  if (status == Status::ok) take(storage);
  return status;
}

}  // namespace ETCM_IDS
}  // namespace etcm
