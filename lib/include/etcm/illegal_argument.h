// What a call does whose arguments break its contract: the mesh is not open, an id names nothing,
// storage is not aligned. A mistake in the program, never in its data: data is answered with a
// Status.
//
// The library then calls etcm_illegal_argument(), which must not return. Its own traps; a program
// that wants to log or to reset first defines a function of that name, and the linker takes it:
//
//   extern "C" [[noreturn]] void etcm_illegal_argument(etcm::Call call, etcm::Fault fault) {
//     log(to_string(call), to_string(fault));  // "point", "no such vertex"
//     for (;;) reset();
//   }
//
// A function, not a pointer to one: it takes no memory, is there before anything is initialised,
// and nothing that writes where it should not can redirect it. Two small numbers, not two strings:
// they fit in a register that survives a reset, and the names are linked only where they are used.
//
// Arguments are checked before anything is changed, so a mesh is as it was; but in_callback and
// outside come in the middle of a change, and that mesh is none any more.
//
// A library built with the CMake option ETCM_CHECK_ARGUMENTS=OFF checks nothing: what such a call
// does is undefined then.
#pragma once

#include <cstdint>

#include "etcm/id_width.h"

namespace etcm {
inline namespace ETCM_IDS {

// The public calls that check, by name. New ones are added at the end: the numbers are in logs, and
// etcm/c/types.h has them as numbers.
enum class Call : std::uint8_t {
  open = 0,
  clear,
  build,
  restore,
  rebuild,
  join,
  leave,
  move,
  add_feature,
  remove_feature,
  config,
  node_count,
  steiner_count,
  feature_count,
  triangle_count,
  finite_triangle_count,
  unresolved,
  vertex_id_end,
  feature_id_end,
  error_detail,
  kind,
  point,
  position,
  feature_of,
  neighbours,
  triangle,
  is_feature,
  ends,
  chain,
  hash,
  audit,
  locate,
  label_domain,
  links,
  links_at,
  connectivity,
  relays,
  barrier_gaps,
  coverage_holes,
  interpolate,
  canonicalize,
  is_canonical,
  nearest_node,
  nearest_nodes,
  nodes_within,
  features_at,
  feature_between,
  optimise,
  least_steiner,
  work_needed,
  handles,
  dry_run,
  work_used,
  seal,
  attach,
  saved_bytes,
  save,
  load,
  policy,  // no call: a split policy of one's own, of what it has answered
};

enum class Fault : std::uint8_t {
  not_open,      // the mesh has no storage: open() was not called, or was refused
  bad_storage,   // null, or not aligned to 8
  no_vertex,     // the id is none, out of range or not in use (anymore)
  no_triangle,   // none or out of range
  no_feature,    // none, out of range or not in use (anymore)
  zero_range,    // ranges are at least 1
  no_region,     // fewer regions than triangles
  has_features,  // it must be a mesh of nodes alone
  in_callback,  // a policy, a hook or another function that a change calls must not change the mesh
  outside,      // a policy answered no parameter in (head, tail) of its site
};

// The name of the call, such as "join", and a few words for a person. Never null.
[[nodiscard]] const char* to_string(Call call) noexcept;
[[nodiscard]] const char* to_string(Fault fault) noexcept;

}  // namespace ETCM_IDS
}  // namespace etcm

extern "C" [[noreturn]] void etcm_illegal_argument(etcm::Call call, etcm::Fault fault);

// The same for what is no mistake of the program: the library has made one, or its storage was
// written to by somebody else. `what` says what does not hold, and where.
extern "C" [[noreturn]] void etcm_check_failed(const char* what, const char* file, int line);
