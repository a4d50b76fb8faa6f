#include "conforming/trial.h"

#include <utility>

#include "conforming/conform.h"
#include "conforming/detach.h"
#include "conforming/prune.h"
#include "conforming/transaction.h"
#include "etcm/split_site.h"
#include "triangulation/march.h"
#include "triangulation/mesh_state.h"
#include "triangulation/segment_store.h"

namespace etcm::internal {
namespace {

// A trial that needs more than this many vertices too many on the way has failed: pruning will not
// take out so many.
constexpr std::uint32_t surplus_most = 3;
// Of 100 splits so many are where the policy has them, and so many of the others as far as they
// finish.
constexpr std::uint32_t usual = 95;
constexpr std::uint32_t farthest = 50;
// The others stop short by at most this part, in 1024ths.
constexpr std::uint32_t short_most = 700;

Parameter part_of(std::int64_t length, std::uint32_t part) noexcept {
  return static_cast<Parameter>(length * part / 1024);
}

// Takes the vertices out. Their segments, in the order of the vertices, take their places in the
// list: one list, for the stack is deepest below it.
std::span<IdValue> take_out(Change& change, std::span<IdValue> ids) noexcept {
  MeshState& m = change.mesh;
  // While all stand: the range that is missing ends at vertices that stay.
  for (const IdValue id : ids) {
    const OwnEdges own = own_edges(m, VertexId{id}, m.work.left());
    if (!m.work.spend(own.looked)) return {};
    for (const VertexId head : {m.topology.target(own.back), VertexId{id}}) {
      if (!keep_for_single_mark(m, head)) return {};
    }
    touch(change, m.owner(VertexId{id}).segment(), m.topology.target(own.back),
          m.topology.target(own.onward));
  }
  std::size_t count = 0;
  for (const IdValue id : ids) {
    const IdValue segment = m.owner(VertexId{id}).segment().value;
    if (!detach(change, VertexId{id})) return {};
    std::size_t i = 0;
    while (i < count && ids[i] != segment) ++i;
    if (i == count) ids[count++] = segment;
  }
  return ids.first(count);
}

Status lay_in_drawn_order(Change& change, std::span<IdValue> segments) noexcept {
  for (auto left = static_cast<std::uint32_t>(segments.size()); left != 0; --left) {
    std::swap(segments[left - 1], segments[draw(change, left)]);
    make_dirty(change, SegmentId{segments[left - 1]});
    const Status status = conform(change);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

// Where a trial splits: mostly where the policy would, at t.
Parameter stray(Change& change, const SplitSite& site, Parameter t) noexcept {
  if (draw(change, 100) < usual) return t;
  const bool goes_far = draw(change, 100) < farthest;
  const bool from_head = draw(change, 2) == 0;
  const std::uint32_t part = draw(change, short_most);
  if (site.feasible_head >= site.feasible_tail) {
    return static_cast<Parameter>(
        site.feasible_tail +
        part_of(std::int64_t{site.feasible_head} - site.feasible_tail, part + 162));
  }
  const std::uint32_t kept = goes_far ? 1024 : 1024 - part;
  return from_head
             ? static_cast<Parameter>(site.head + part_of(site.feasible_head - site.head, kept))
             : static_cast<Parameter>(site.tail - part_of(site.tail - site.feasible_tail, kept));
}

}  // namespace

// Xorshift (Marsaglia 2003): its state is not 0.
std::uint32_t draw(Change& change, std::uint32_t end) noexcept {
  std::uint64_t& state = change.trial.random;
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return static_cast<std::uint32_t>(((state >> 32) * end) >> 32);
}

bool try_without(Change& change, std::span<IdValue> vertices) noexcept {
  MeshState& m = change.mesh;
  const std::uint32_t before = m.steiner_count;
  change.trial.stray = stray;
  change.trial.steiner_most = before + surplus_most;
  Status status = lay_in_drawn_order(change, take_out(change, vertices));
  if (m.work.is_over() || (status == Status::ok && !prune(change))) status = Status::work_limit;
  if (status == Status::ok && m.steiner_count <= before) {
    settle(change);
    return true;
  }
  begin_going_back(change, status);
  restore_detached(change);
  return false;
}

}  // namespace etcm::internal
