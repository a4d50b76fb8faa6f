#include "mesh_changes.h"

#include <algorithm>
#include <map>
#include <vector>

#include "etcm/audit.h"
#include "etcm/traverse.h"
#include "inputs/owned_mesh.h"
#include "support/meshes.h"

namespace etcm::fuzz {
namespace {

// One byte; of three quarters of them no limit.
Work limit_of(Input& input) {
  const std::uint8_t choice = input.byte();
  return choice < 192 ? Work::unlimited() : Work{std::uint64_t{1} << (choice % 18)};
}

bool is_same(const Outcome& a, Status status, std::int64_t steiner) {
  return a.status == status && (status != Status::ok || a.steiner == steiner);
}

}  // namespace

Position MeshChanges::position(Input& input) const {
  const std::uint8_t x = input.byte();
  if (x == 0xff) {
    const std::uint32_t far = input.number();
    return {static_cast<std::int32_t>(far), static_cast<std::int32_t>(input.number())};
  }
  return {(x % 64 - 32) * step_ + x / 64, (input.byte() % 64 - 32) * step_};
}

// Of one that is in use, or may be: free ids and those behind the last are data too.
VertexId MeshChanges::vertex(Input& input) const {
  const std::uint32_t end = mesh_.vertex_id_end() + 2;
  return VertexId{static_cast<IdValue>(input.below(end))};
}

FeatureId MeshChanges::feature(Input& input) const {
  return FeatureId{static_cast<IdValue>(input.below(mesh_.feature_id_end() + 2))};
}

// Where the last walk has ended, the next begins, so a limit may cut off one and not the other.
template <class Ask, class Change>
MeshChanges::Made MeshChanges::after_dry_run(Input& input, Ask ask, Change change) {
  if (input.byte() % 2 == 0) return {change()};
  const std::uint64_t hash = mesh_.hash();
  const std::int64_t before = mesh_.steiner_count();
  const bool was_canonical = mesh_.is_canonical();
  DryRun dry(mesh_);
  const Outcome outcome = ask(dry);
  require(mesh_.hash() == hash && mesh_.is_canonical() == was_canonical, "a dry run left a trace");
  const Status status = change();
  const bool is_limited = outcome.status == Status::work_limit || status == Status::work_limit;
  require(is_limited || is_same(outcome, status, mesh_.steiner_count() - before),
          "a dry run foretold something else");
  return {status};
}

MeshChanges::Made MeshChanges::join(Input& input) {
  const Position place = position(input);
  VertexId id;
  return after_dry_run(
      input, [&](DryRun& dry) { return dry.join(place, limit_); },
      [&] { return mesh_.join(place, id, limit_); });
}

MeshChanges::Made MeshChanges::leave(Input& input) {
  const VertexId node = vertex(input);
  return after_dry_run(
      input, [&](DryRun& dry) { return dry.leave(node, limit_); },
      [&] { return mesh_.leave(node, limit_); });
}

MeshChanges::Made MeshChanges::move(Input& input) {
  const VertexId node = vertex(input);
  const Position place = position(input);
  return after_dry_run(
      input, [&](DryRun& dry) { return dry.move(node, place, limit_); },
      [&] { return mesh_.move(node, place, limit_); });
}

MeshChanges::Made MeshChanges::add_feature(Input& input) {
  const VertexId from = vertex(input);
  const FeatureEnds ends{from, vertex(input)};
  FeatureId id;
  return after_dry_run(
      input, [&](DryRun& dry) { return dry.add_feature(ends, limit_); },
      [&] { return mesh_.add_feature(ends, id, limit_); });
}

MeshChanges::Made MeshChanges::remove_feature(Input& input) {
  const FeatureId line = feature(input);
  return after_dry_run(
      input, [&](DryRun& dry) { return dry.remove_feature(line, limit_); },
      [&] { return mesh_.remove_feature(line, limit_); });
}

MeshChanges::Made MeshChanges::clear_and_build(Input& input) {
  std::vector<Position> nodes(input.below(24));
  for (Position& node : nodes) node = position(input);
  std::vector<FeatureEnds> features(input.below(12));
  const auto end = static_cast<std::uint32_t>(nodes.size() + 2);
  for (FeatureEnds& ends : features) {
    ends.from = VertexId{static_cast<IdValue>(input.below(end))};
    ends.to = VertexId{static_cast<IdValue>(input.below(end))};
  }
  if (input.byte() % 8 != 0) mesh_.clear();
  const bool was_empty = mesh_.node_count() == 0;
  const Status status = mesh_.build(nodes, features, limit_);
  require(status == Status::ok || !was_empty || mesh_.unresolved() != 0 || mesh_.node_count() == 0,
          "a refused build() left something whole");
  return {status, was_empty ? Kind::by_parts : Kind::of_all};
}

// What stands by other ids, or nearly that.
MeshChanges::Made MeshChanges::clear_and_restore(Input& input) {
  std::map<VertexId, VertexId> renamed;
  std::map<FeatureId, std::uint32_t> numbers;
  std::vector<Position> nodes;
  std::vector<FeatureEnds> features;
  std::vector<SteinerPlace> steiner;
  for (const VertexId v : nodes_of(mesh_)) {
    nodes.push_back(mesh_.position(v));
    renamed[v] = test::vertex_of(nodes.size() - 1);
  }
  for (const FeatureId f : features_of(mesh_)) {
    const FeatureEnds ends = mesh_.ends(f);
    numbers[f] = static_cast<std::uint32_t>(features.size());
    features.push_back({renamed.at(ends.from), renamed.at(ends.to)});
  }
  for (const VertexId v : test::steiner_vertices(mesh_)) {
    steiner.push_back({numbers.at(mesh_.feature_of(v)), mesh_.point(v)});
  }
  const std::uint64_t hash = mesh_.hash();
  const bool was_whole = mesh_.unresolved() == 0;
  const std::uint8_t harm = input.byte();
  if (harm % 4 == 1 && !steiner.empty()) steiner[input.byte() % steiner.size()].point.x += harm;
  if (harm % 4 == 2 && !steiner.empty()) steiner[input.byte() % steiner.size()].feature = harm / 4;
  if (harm % 4 == 3 && !nodes.empty()) nodes[input.byte() % nodes.size()] = position(input);
  mesh_.clear();
  const Status status = mesh_.restore(nodes, features, steiner, limit_);
  require(status == Status::ok || mesh_.node_count() == 0, "a refused restore() left something");
  require(status != Status::ok || mesh_.unresolved() == 0, "restore() left a part undone");
  if (harm % 4 == 0 && was_whole && limit_ == Work::unlimited()) {
    require(status == Status::ok && mesh_.hash() == hash, "restore() makes another mesh");
  }
  return {status, Kind::by_parts};
}

// Each of these makes another mesh of the same nodes and features.
MeshChanges::Made MeshChanges::improve(Input& input) {
  switch (input.byte() % 4) {
    case 0:
      return {mesh_.rebuild(limit_)};
    case 1: {
      const Status status = mesh_.canonicalize(limit_);
      require(status != Status::ok || mesh_.is_canonical(), "canonicalize() is not canonical");
      return {status, Kind::by_parts};
    }
    case 2: {
      const std::uint32_t trials = input.below(12), before = mesh_.steiner_count();
      const Status status = mesh_.optimise(trials, input.byte(), limit_);
      require(mesh_.steiner_count() <= before, "optimise() made it worse");
      return {status, Kind::by_parts};
    }
    default:
      mesh_.clear();
      return {};
  }
}

MeshChanges::Made MeshChanges::by_handle(Input& input) {
  NodeHandle& node = nodes_[input.byte() % std::size(nodes_)];
  NodeHandle& other = nodes_[input.byte() % std::size(nodes_)];
  FeatureHandle& line = lines_[input.byte() % std::size(lines_)];
  switch (input.byte() % 7) {
    case 0:
      return {handles_.join(position(input), node, limit_)};
    case 1:
      return {handles_.leave(node, limit_)};
    case 2:
      return {handles_.move(node, position(input), limit_)};
    case 3:
      return {handles_.add_feature(node, other, line, limit_)};
    case 4:
      return {handles_.remove_feature(line, limit_)};
    case 5:
      return {handles_.handle_of(vertex(input), node)};
    default:
      return {handles_.handle_of(feature(input), line)};
  }
}

MeshChanges::Made MeshChanges::change(Input& input) {
  const std::uint8_t kind = input.byte() % 16;
  limit_ = limit_of(input);
  if (kind < 4) return join(input);
  if (kind < 6) return leave(input);
  if (kind < 8) return move(input);
  if (kind < 11) return add_feature(input);
  if (kind < 12) return remove_feature(input);
  if (kind < 13) return clear_and_build(input);
  if (kind < 14) return clear_and_restore(input);
  return kind < 15 ? improve(input) : by_handle(input);
}

void MeshChanges::make_one(Input& input) {
  const test::Picture before = test::picture_of(mesh_);
  const Made made = change(input);
  if (made.status != Status::ok && made.kind == Kind::of_all) {
    require(test::picture_of(mesh_) == before, "a refused change changed the mesh");
  }
  for (const NodeHandle& node : nodes_) {
    VertexId id;
    if (handles_.find(node, id) != Status::ok) continue;
    require(mesh_.kind(id) == VertexKind::node, "a handle names what is no node");
  }
  const Audit sound = audit(mesh_);
  require(sound.broken == Rule::none, to_string(sound.broken));
}

void compare_with_build(Mesh& mesh) {
  if (mesh.unresolved() != 0) return;
  const Status status = mesh.canonicalize();
  const test::Graph standing = test::graph_of(mesh);
  MeshConfig config = inputs::config_for(standing, 1500, mesh.config().policy);
  config.features_max += 300;
  inputs::OwnedMesh fresh(config);
  const Status built = fresh->build(standing.nodes, standing.features);
  if (status != Status::ok) {
    const bool is_for_room = status == Status::out_of_vertices ||
                             status == Status::out_of_features || status == Status::steiner_budget;
    require(built != Status::ok || is_for_room, "canonicalize() refuses what build() makes");
    return;
  }
  require(mesh.is_canonical(), "canonicalize() is not canonical");
  require(audit(mesh).broken == Rule::none, "canonicalize() leaves what fails its audit");
  require(built == Status::ok && fresh->hash() == mesh.hash(), "canonicalize() is not build()");
}

}  // namespace etcm::fuzz
