// Every Status, reached by name: one that no call can answer any more, or a new one that nobody
// provokes, fails here.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "etcm/domain.h"
#include "etcm/handles.h"
#include "etcm/storage.h"
#include "inputs/patterns.h"
#include "support/mesh_block.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

Status open_with(const MeshConfig& config) { return OwnedMesh(config).opened(); }

Status build_with(const MeshConfig& config, const Graph& graph) {
  OwnedMesh mesh(config);
  EXPECT_EQ(mesh.opened(), Status::ok);
  return mesh->build(graph.nodes, graph.features);
}

Status build(const Graph& graph) { return build_with(inputs::config_for(graph, 1000), graph); }

// Needs Steiner vertices.
Graph needy() { return inputs::comb(20, 10, 1000, 5); }

Status after_unresolved() {
  MeshConfig config = inputs::config_for(needy(), 1000);
  config.steiner_max = 1;
  OwnedMesh mesh(config);
  EXPECT_EQ(mesh->build(needy().nodes, needy().features), Status::steiner_budget);
  VertexId id;
  return mesh->join({-50, -50}, id);
}

Status join_by_handles(std::uint32_t given_out) {
  const auto mesh = built({"", square, {}});
  std::vector<std::uint32_t> numbers(Handles::words((*mesh)->config()));
  Handles handles;
  EXPECT_EQ(handles.open(**mesh, numbers, given_out), Status::ok);
  NodeHandle node;
  const Status status = handles.join({5, 5}, node);
  return status == Status::ok ? handles.leave({node.id, node.number + 1}) : status;
}

MeshBlock sealed() {
  const MeshConfig config{.vertices_max = 9};
  MeshBlock block(config);
  EXPECT_EQ(block->open(block.bytes(), config), Status::ok);
  seal(*block);
  return block;
}

Status attach_harmed(std::size_t at, unsigned value) {
  MeshBlock block = sealed();
  block.in_seal(at) = static_cast<std::byte>(value);
  return attach(*block, block.bytes());
}

Status attach_reversed() {
  MeshBlock block = sealed();
  std::reverse(&block.in_seal(0), &block.in_seal(0) + 8);
  return attach(*block, block.bytes());
}

const std::map<Status, std::function<Status()>> ways{
    {Status::ok, [] { return build(needy()); }},
    {Status::bad_config, [] { return open_with({}); }},
    {Status::storage_too_small, [] { return Mesh().open({}, MeshStorage<4, 1>::config()); }},
    {Status::bad_coordinate,
     [] {
       return build({"", {{position_max + 1, 0}}, {}});
     }},
    {Status::duplicate_vertex,
     [] {
       return build({"", {{1, 1}, {1, 1}}, {}});
     }},
    {Status::unknown_vertex,
     [] {
       return build({"", square, {between_nodes(0, 9)}});
     }},
    {Status::unknown_feature,
     [] {
       return (*built({"", square, {}}))->remove_feature(FeatureId{0});
     }},
    {Status::stale_handle, [] { return join_by_handles(0); }},
    {Status::zero_length_feature,
     [] {
       return build({"", square, {between_nodes(1, 1)}});
     }},
    {Status::repeated_feature,
     [] {
       return build({"", square, {between_nodes(0, 2), between_nodes(0, 2)}});
     }},
    {Status::overlapping_features,
     [] {
       return build({"", square, {between_nodes(0, 1), between_nodes(4, 1)}});
     }},
    {Status::crossing_features,
     [] {
       return build({"", square, {between_nodes(0, 2), between_nodes(1, 3)}});
     }},
    {Status::endpoint_in_use,
     [] {
       return (*built({"", square, {between_nodes(0, 2)}}))->leave(vertex_of(2));
     }},
    {Status::mesh_not_empty,
     [] {
       return (*built({"", square, {}}))->build(square, {});
     }},
    {Status::mesh_unresolved, after_unresolved},
    {Status::buffer_too_small,
     [] {
       return label_domain(**built({"", square, {}}), Exterior::hull, {}, {}, {});
     }},
    {Status::not_a_mesh, [] { return attach_harmed(0, 0); }},
    {Status::wrong_version, [] { return attach_harmed(seal_version, 0xff); }},
    {Status::wrong_byte_order, attach_reversed},
    {Status::wrong_id_width, [] { return attach_harmed(seal_id_bits, 64); }},
    {Status::damaged, [] { return attach_harmed(seal_bytes, 1); }},
    {Status::out_of_vertices,
     [] {
       return build_with({.vertices_max = 4}, {"", square, {}});
     }},
    {Status::out_of_features,
     [] {
       return build_with({.vertices_max = 9}, {"", square, {between_nodes(0, 2)}});
     }},
    {Status::out_of_handles,
     [] { return join_by_handles(std::numeric_limits<std::uint32_t>::max()); }},
    {Status::steiner_budget,
     [] {
       MeshConfig config = inputs::config_for(needy(), 1000);
       config.steiner_max = 1;
       return build_with(config, needy());
     }},
    {Status::work_limit,
     [] {
       OwnedMesh mesh(inputs::config_for(needy(), 1000));
       return mesh->build(needy().nodes, needy().features, Work{100});
     }},
    {Status::grid_exhausted,
     [] {
       // The policy `paper` closes in on the common node until the grid ends.
       const Graph fan = inputs::fan({50, 7200, 1000, 100'000, 1});
       return build_with(inputs::config_for(fan, 200'000, split_paper), fan);
     }},
};

TEST(MeshStatus, IsReachedByName) {
  for (const auto& [status, way] : ways) EXPECT_EQ(way(), status) << to_string(status);
}

TEST(MeshStatus, AllAreReached) {
  // Past the last one, all have the same name.
  const std::string no_name = to_string(Status{255});
  for (unsigned value = 0; to_string(static_cast<Status>(value)) != no_name; ++value) {
    const auto status = static_cast<Status>(value);
    EXPECT_TRUE(ways.contains(status)) << to_string(status);
  }
}

}  // namespace
}  // namespace etcm::test
