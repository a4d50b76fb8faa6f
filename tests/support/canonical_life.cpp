#include "support/canonical_life.h"

#include <algorithm>

#include "etcm/audit.h"
#include "etcm/dry_run.h"
#include "support/families.h"

namespace etcm::test {
namespace {

using testing::AssertionFailure;
using testing::AssertionResult;
using testing::AssertionSuccess;

}  // namespace

CanonicalLife::CanonicalLife(std::uint64_t seed)
    : random_(seed), graph_(graph_of_some_family(random_)) {
  if (random_.below(5) == 0) policy_ = split_paper;
  if (random_.below(3) == 0) each_ = 1 + random_.below(12);
  low_ = high_ = graph_.nodes.front();
  for (const Position& p : graph_.nodes) {
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
    high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
  }
  MeshConfig config = inputs::config_for(graph_, 4000, policy_);
  config.features_max += 300;
  mesh_ = std::make_unique<OwnedMesh>(config);
  if ((*mesh_)->build(graph_.nodes, graph_.features) != Status::ok) mesh_.reset();
}

Position CanonicalLife::bounded(std::int64_t x, std::int64_t y) const {
  const auto within = [](std::int64_t value) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(value, -position_max, position_max));
  };
  return {within(x), within(y)};
}

VertexId CanonicalLife::random_node() {
  const Mesh& mesh = **mesh_;
  if (mesh.node_count() == 0) return VertexId::none();
  for (;;) {
    const VertexId v{static_cast<IdValue>(1 + random_.index(mesh.vertex_id_end() - 1))};
    if (mesh.kind(v) == VertexKind::node) return v;
  }
}

// Anywhere, somewhat outside, beside a node, or between two.
Position CanonicalLife::near_something() {
  const std::int64_t width = high_.x - low_.x + 1, height = high_.y - low_.y + 1;
  const Position anywhere = bounded(low_.x + random_.between(0, static_cast<std::int32_t>(width)),
                                    low_.y + random_.between(0, static_cast<std::int32_t>(height)));
  const VertexId a = random_node(), b = random_node();
  if (a.is_none()) return anywhere;
  const Position p = (*mesh_)->position(a), q = (*mesh_)->position(b);
  switch (random_.below(6)) {
    case 0:
      return bounded(anywhere.x + random_.between(-1, 1) * width / 4,
                     anywhere.y + random_.between(-1, 1) * height / 4);
    case 1:
      return bounded(p.x + random_.between(-9, 9), p.y + random_.between(-9, 9));
    case 2:
      return bounded((std::int64_t{p.x} + q.x) / 2 + random_.between(-2, 2),
                     (std::int64_t{p.y} + q.y) / 2 + random_.between(-2, 2));
    default:
      return anywhere;
  }
}

// Of what may be refused or not: no trace of it is left, or the mesh would not be that of build().
void CanonicalLife::rehearse() {
  Mesh& mesh = **mesh_;
  DryRun dry(mesh);
  const VertexId v = random_node();
  const std::uint64_t choice = random_.below(5);
  if (v.is_none() || choice == 0) {
    static_cast<void>(dry.join(near_something()));
  } else if (choice == 1) {
    static_cast<void>(dry.leave(v));
  } else if (choice == 2) {
    static_cast<void>(dry.move(v, near_something()));
  } else if (choice == 3) {
    static_cast<void>(dry.add_feature({v, random_node()}));
  } else if (mesh.feature_id_end() != 0) {
    static_cast<void>(
        dry.remove_feature(FeatureId{static_cast<IdValue>(random_.index(mesh.feature_id_end()))}));
  }
}

void CanonicalLife::change() {
  Mesh& mesh = **mesh_;
  VertexId v;
  FeatureId f;
  if (random_.below(4) == 0) rehearse();
  const std::uint64_t choice = random_.below(100);
  if (choice < 25) {
    static_cast<void>(mesh.join(near_something(), v));
    return;
  }
  v = random_node();
  if (v.is_none()) return;
  if (choice < 27) {
    static_cast<void>(mesh.optimise(4, static_cast<std::uint32_t>(random_.below(1000))));
  } else if (choice < 50) {
    static_cast<void>(mesh.leave(v));
  } else if (choice < 60) {
    static_cast<void>(mesh.move(v, near_something()));
  } else if (choice < 75) {
    const Position p = mesh.position(v);
    static_cast<void>(
        mesh.move(v, bounded(p.x + random_.between(-3, 3), p.y + random_.between(-3, 3))));
  } else if (choice < 88 && mesh.feature_count() < graph_.features.size() * 2 + 8) {
    static_cast<void>(mesh.add_feature({v, random_node()}, f));
  } else if (mesh.feature_id_end() != 0) {
    f = FeatureId{static_cast<IdValue>(random_.index(mesh.feature_id_end()))};
    if (mesh.is_feature(f)) static_cast<void>(mesh.remove_feature(f));
  }
}

AssertionResult CanonicalLife::compare() {
  Mesh& mesh = **mesh_;
  ++compared_;
  const Status status = mesh.canonicalize();
  const Graph standing = graph_of(mesh);
  MeshConfig config = inputs::config_for(standing, 8000, policy_);
  config.features_max += 300;
  OwnedMesh fresh(config);
  const Status built = fresh->build(standing.nodes, standing.features);
  if (status != Status::ok) {
    if (built != Status::ok || status == Status::out_of_vertices) return AssertionSuccess();
    return AssertionFailure() << "canonicalize() answers " << to_string(status);
  }
  if (!mesh.is_canonical()) return AssertionFailure() << "not canonical after canonicalize()";
  if (const Audit sound = audit(mesh); !sound)
    return AssertionFailure() << "broken " << to_string(sound.broken);
  if (built != Status::ok || fresh->hash() == mesh.hash()) return AssertionSuccess();
  return AssertionFailure() << "not the mesh of build(): " << mesh.steiner_count()
                            << " Steiner vertices instead of " << fresh->steiner_count();
}

AssertionResult CanonicalLife::live(int events) {
  if (mesh_ == nullptr) return AssertionSuccess();
  for (int event = 1; event <= events; ++event) {
    change();
    if (random_.below(each_) != 0) continue;
    const AssertionResult answer = compare();
    if (!answer) return AssertionFailure() << "event " << event << ": " << answer.message();
  }
  return AssertionSuccess();
}

}  // namespace etcm::test
