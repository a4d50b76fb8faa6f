// The memory of one mesh: sized at compile time, a static object or a member, never the heap; and
// what can be done with its bytes.
//
// A mesh is a block of bytes: its storage holds all of it, and no address that anybody else would
// follow. So the bytes of a mesh at rest, which no call is changing, can be copied to any place
// that is aligned to 8, kept over a reset, written to flash, or mapped into another process; and
// attach() makes a mesh of them that goes on as the first one would have, with the same ids and
// bits.
//
//   etcm::seal(mesh);                                      // then copy, keep or write the storage
//   ...
//   if (etcm::attach(mesh, bytes) != etcm::Status::ok) ... // after the reset, in another place
//
// What is believed of the bytes:
//   attach()       What seal() has vouched for, which is what is in use of the bytes. Where that
//                  was altered since, cut off or copied while a change was going on, it is refused,
//                  but for one time in 2^64. A call that changes the mesh alters it even where it
//                  is refused, and so does a dry run, but for some that are refused at once: the
//                  mesh is as it was, its bytes are not. So seal after each such call, whatever it
//                  answered. It is a checksum, no
//                  signature: who can write the bytes on purpose can make it right. What a program
//                  keeps beside the mesh, such as the devices behind its ids, is not in it: that
//                  wants a checksum of its own, or is written between a change and its seal, so
//                  that a reset in between lets go of both.
//   attach_copy()  Everything but the head, which is looked at: whether a mesh begins there, of
//                  this layout and within these bytes. For copies that this program made of a mesh
//                  at rest.
// After both work_used() and work_needed() are 0, and error_detail() tells of the last change
// before. Bytes that may be forged belong to neither: such a mesh is sent as Mesh::save() writes
// it, for Mesh::load() believes nothing.
//
// The errors of all of these, and then what was attached before still is:
//   not_a_mesh         no mesh begins there
//   wrong_byte_order   the machine that made it has another order of bytes
//   wrong_version      a version of the library made it that lays storage out otherwise
//   wrong_id_width     its ids are of another width (ETCM_ID_BITS)
//   storage_too_small  there are fewer bytes than its capacities ask for
//   damaged            the head contradicts itself, or the checksum is another
// Storage is for the program that made it, or one with the same version of the library
// (ETCM_VERSION): another may lay it out otherwise. Where it does, it answers wrong_version; where
// it does not, the storage is taken. So what must outlast an update of the program is saved.
// Machines of 32 and of 64 bits lay storage out alike. To a machine with another order of bytes or
// other ids the mesh goes as Mesh::save() writes it.
//
// What a reset shall spare lies where start-up code clears nothing, such as a section .noinit, and
// is sealed after each call that changes the mesh. At a start attach(); where that is not ok, as
// after the power was off or a reset in the middle of a call, open().
//
// A span that is null or not aligned to 8 is a programming error (illegal_argument.h).
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "etcm/config.h"
#include "etcm/mesh.h"

namespace etcm {
inline namespace ETCM_IDS {

// Algorithms see only the bytes, so no code is instantiated for a capacity.
template <std::uint32_t VerticesMax, std::uint32_t FeaturesMax>
class MeshStorage {
  static_assert(VerticesMax >= 1 && VerticesMax <= vertices_limit);
  static_assert(FeaturesMax <= features_limit);
  static_assert(storage_bytes(VerticesMax, FeaturesMax) < std::numeric_limits<std::size_t>::max());

 public:
  [[nodiscard]] std::span<std::byte> bytes() noexcept { return bytes_; }

  // The configuration this storage has room for.
  [[nodiscard]] static constexpr MeshConfig config() noexcept {
    return {.vertices_max = VerticesMax, .features_max = FeaturesMax};
  }

 private:
  alignas(8) std::array<std::byte, storage_bytes(VerticesMax, FeaturesMax)> bytes_;
};

// Writes a checksum of the mesh into its storage. The mesh may go on; each call that changes it,
// refused or not, breaks the seal. O(n), some 90 instructions for each 8 bytes in use on a
// Cortex-M4.
void seal(Mesh& mesh) noexcept;

// Takes storage that holds a sealed mesh, as Mesh::open() takes storage for an empty one; another
// Mesh that had it must not be used any more. The
// policy is not among the bytes; it must be the one that the mesh had, or one that answers the
// same: with another, is_canonical() would be about the first. Handles (handles.h) are opened anew.
// Errors: bad_config where there is no policy, and those above. O(n).
Status attach(Mesh& mesh, std::span<std::byte> storage, SplitPolicy policy = split_default,
              void* policy_context = nullptr) noexcept;

// The same of a copy, sealed or not. O(1).
Status attach_copy(Mesh& mesh, std::span<std::byte> storage, SplitPolicy policy = split_default,
                   void* policy_context = nullptr) noexcept;

// Reads a mesh in bytes that it does not write: in flash, or mapped from another process. It keeps
// the head, so attach it again when the bytes have become another mesh; they must stay as they are
// while it is asked. Everything that takes a `const Mesh&` takes this one. Its config() has no
// policy.
class MeshReader {
 public:
  // Without a mesh: attach() first. Any other call before that is a programming error.
  MeshReader() noexcept = default;
  MeshReader(const MeshReader&) = delete;
  MeshReader& operator=(const MeshReader&) = delete;

  // As those above, with errors of the list above alone. The storage must outlive the reader.
  Status attach(std::span<const std::byte> storage) noexcept;
  Status attach_copy(std::span<const std::byte> storage) noexcept;

  [[nodiscard]] const Mesh& mesh() const noexcept { return mesh_; }

 private:
  void take(std::span<const std::byte> storage) noexcept;

  Mesh mesh_;
  alignas(8) std::array<std::byte, bytes_head> head_;
};

}  // namespace ETCM_IDS
}  // namespace etcm
