// How much a call that changes a mesh may do: counted, not timed, so it is the same on every
// machine.
//
//   if (mesh.join(position, id, Work{20'000}) == Status::work_limit) ...  // nothing has changed
//
// A unit is about one triangle, edge, list entry or hint cell that is looked at or changed, with a
// few links. What takes longer, such as circles that are compared, is as many units as it takes
// longer. docs/work.md has the time of a unit.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>

#include "etcm/id_width.h"

namespace etcm {
inline namespace ETCM_IDS {

struct Work {
  std::uint64_t units = 0;
  [[nodiscard]] static constexpr Work unlimited() noexcept {
    return {std::numeric_limits<std::uint64_t>::max()};
  }
  friend constexpr auto operator<=>(const Work&, const Work&) = default;
};

// Called over and over inside of a call that may take long, so that a watchdog does not bite while
// it goes on (Mesh::keep_alive()): one that changes a mesh, a dry run, and one that reads all of it
// or around a place, such as audit(), hash(), save(), seal(), attach(), nodes_within() and what
// analysis.h has. It is the Mesh's that the call was given; a MeshReader's has none. Not by open(),
// clear(), attach_copy(), Handles::open(), locate(), neighbours(), chain(), features_at(),
// feature_between(), links_at(), interpolate(), least_steiner(), finite_triangle_count(),
// saved_bytes() and the ranges of traverse.h, which between two steps are the caller's.
//
//   mesh.keep_alive({[](void*) noexcept { IWDG->KR = 0xAAAA; }});
//
// Between two calls of it, before the first and after the last there are at most units_between
// units and one walk: once around a vertex, along a list of segments, or, where a mesh is only
// read, across it. That is tens of units as a rule and never more than twice as many as there are
// triangles, for a step of it may take as long as two. A change walks across the mesh or along a
// line in parts of 64 steps. That holds for work that no limit knows of too
// (docs/work.md); only the time that a policy of one's own takes adds to it, and the sort of a list
// that nodes_within() writes.
//
// It is called where the call runs: by a question in an interrupt, in the interrupt. Where `call`
// asks another mesh that has the same hook, it is called by itself.
//
// The mesh may be in the middle of a change then: `call` must not use it, nor its storage, nor what
// the call was given. To change it is a programming error, which is noticed while a change goes on
// (illegal_argument.h); so is to open or to attach it, which is not noticed. It may do anything
// else: kick a watchdog, read a clock, let other tasks run, set a flag, use another mesh (the stack
// of both calls adds up). It cannot end the call; a limit does that.
struct KeepAlive {
  void (*call)(void* context) noexcept = nullptr;  // null: nobody is called
  void* context = nullptr;
  static constexpr std::uint32_t units_between = 256;
};

}  // namespace ETCM_IDS
}  // namespace etcm
