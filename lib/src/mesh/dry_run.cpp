#include "etcm/dry_run.h"

#include <utility>

#include "triangulation/mesh_state.h"

namespace etcm {
inline namespace ETCM_IDS {

using namespace internal;

namespace {

// While the outcome is set, the commit of a change goes back instead and leaves in it what it has
// come to. The answer is made in place, and holds what must be put back: a change is deep enough.
struct Before {
  Work used;
  Work needed;
};
Before begin(Mesh& mesh, Outcome& outcome) noexcept {
  MeshState& m = about_to_change(mesh, Call::dry_run);
  m.outcome = &outcome;
  outcome.status = Status::work_limit;
  outcome.detail = m.error_detail;
  outcome.steiner = -static_cast<std::int32_t>(m.steiner_count);
  return {m.work.used(), m.work.needed()};
}

void end(Mesh& mesh, Outcome& outcome, Status answer, const Before& before) noexcept {
  MeshState& m = state_of(mesh);
  const Work needed = mesh.work_needed();
  std::swap(outcome.detail, m.error_detail);
  if (outcome.status == Status::ok) {
    outcome.detail = ErrorDetail{};
  } else {
    outcome.status = answer;
    outcome.steiner = 0;
    outcome.work = needed;
  }
  m.work.tell(before.used, before.needed);
  m.outcome = nullptr;
}

}  // namespace

Outcome DryRun::join(Position position, Work limit) noexcept {
  Outcome outcome;
  const Before before = begin(mesh_, outcome);
  VertexId id;
  end(mesh_, outcome, mesh_.join(position, id, limit), before);
  return outcome;
}

Outcome DryRun::leave(VertexId node, Work limit) noexcept {
  Outcome outcome;
  const Before before = begin(mesh_, outcome);
  end(mesh_, outcome, mesh_.leave(node, limit), before);
  return outcome;
}

Outcome DryRun::move(VertexId node, Position position, Work limit) noexcept {
  Outcome outcome;
  const Before before = begin(mesh_, outcome);
  end(mesh_, outcome, mesh_.move(node, position, limit), before);
  return outcome;
}

Outcome DryRun::add_feature(FeatureEnds ends, Work limit) noexcept {
  Outcome outcome;
  const Before before = begin(mesh_, outcome);
  FeatureId id;
  end(mesh_, outcome, mesh_.add_feature(ends, id, limit), before);
  return outcome;
}

Outcome DryRun::remove_feature(FeatureId feature, Work limit) noexcept {
  Outcome outcome;
  const Before before = begin(mesh_, outcome);
  end(mesh_, outcome, mesh_.remove_feature(feature, limit), before);
  return outcome;
}

}  // namespace ETCM_IDS
}  // namespace etcm
