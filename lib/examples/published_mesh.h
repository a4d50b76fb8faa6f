// A mesh that one writer changes while others read it, without a lock.
//
// There are two meshes. Readers are given the one in front; the writer changes the one behind, puts
// it in front, waits until nobody reads the other any more, and makes the same change there. The
// same change of the same mesh gives the same mesh and the same ids (mesh.h), so both are one
// again. A reader never waits; a change takes twice the time, and the mesh twice the memory.
//
// For threads, and for interrupts that read what the main program writes: one that has begun is
// over before the main program goes on, so there the writer never waits. A machine without an
// instruction that adds atomically, such as a Cortex-M0+, has one core and interrupts, which nest:
// there a sum in three steps is as good, for who comes in between has left again.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#if __has_include("etcm/mesh.h")
#include "etcm/mesh.h"
#include "etcm/storage.h"
#else  // the drop-in
#include "etcm.hpp"
#endif

namespace example {

template <std::uint32_t VerticesMax, std::uint32_t FeaturesMax>
class PublishedMesh {
 public:
  // Two empty meshes. Before the first reader.
  etcm::Status open() noexcept {
    for (unsigned side = 0; side < 2; ++side) {
      const etcm::Status status =
          meshes_[side].open(storage_[side].bytes(), storage_[side].config());
      if (status != etcm::Status::ok) return status;
    }
    return etcm::Status::ok;
  }

  // Answers what `question` answers of the mesh, which stays as it is meanwhile. Any number of
  // readers; it asks again only where the writer has published in between.
  template <class Question>
  auto read(Question question) noexcept {
    for (;;) {
      const unsigned side = front_.load();
      add(readers_[side], 1);
      if (front_.load() == side) {
        const Reading reading(readers_[side]);
        return question(static_cast<const etcm::Mesh&>(meshes_[side]));
      }
      add(readers_[side], -1);
    }
  }

  // Makes a change: `make` is called twice, each time with another mesh and a limit of work, and
  // must do the same. What is refused is not published. `idle` is called over and over while
  // readers are waited for.
  //
  // Only the first is limited: a change that was refused left the mesh behind as it was, but not
  // how its storage is arranged, so in one of the two a call may take a little more work than in
  // the other. With a limit for both one of them could end without the change.
  template <class Change, class Idle>
  etcm::Status change(Change make, etcm::Work limit, Idle idle) noexcept {
    const unsigned before = front_.load(), after = 1 - before;
    const etcm::Status status = make(meshes_[after], limit);
    if (status != etcm::Status::ok) return status;
    front_.store(after);
    while (readers_[before].load() != 0) idle();
    return make(meshes_[before], etcm::Work::unlimited());
  }

 private:
  using Count = std::atomic<int>;
  struct Reading {
    explicit Reading(Count& count) noexcept : readers(count) {}
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;
    ~Reading() { add(readers, -1); }
    Count& readers;
  };

  static void add(Count& count, int more) noexcept {
#if __GCC_ATOMIC_INT_LOCK_FREE == 2
    count.fetch_add(more);
#else
    count.store(count.load() + more);
#endif
  }

  std::array<etcm::MeshStorage<VerticesMax, FeaturesMax>, 2> storage_;
  std::array<etcm::Mesh, 2> meshes_;
  std::atomic<unsigned> front_{0};
  std::array<Count, 2> readers_{};
};

}  // namespace example
