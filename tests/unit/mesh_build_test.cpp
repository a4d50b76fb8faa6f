// build() and the meshes that are hardly one: empty, single, collinear, cocircular, at the edge of
// the range.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "etcm/audit.h"
#include "etcm/storage.h"
#include "inputs/patterns.h"
#include "support/meshes.h"
#include "support/oracle.h"

namespace etcm::test {
namespace {

constexpr std::int32_t far = position_max;

TEST(MeshBuild, OfNothingIsAMesh) {
  const auto mesh = built({});
  EXPECT_EQ((*mesh)->node_count(), 0u);
  EXPECT_EQ((*mesh)->triangle_count(), 0u);
  EXPECT_TRUE(is_sound(**mesh));
  EXPECT_EQ((*mesh)->hash(), (*empty_mesh())->hash());
}

TEST(MeshBuild, OfOneNodeHasNoNeighbours) {
  const auto mesh = built({"", {{3, 4}}, {}});
  EXPECT_EQ((*mesh)->node_count(), 1u);
  EXPECT_EQ((*mesh)->position(VertexId{1}), (Position{3, 4}));
  EXPECT_EQ((*mesh)->neighbours(VertexId{1}, {}), 0u);
  EXPECT_TRUE(is_sound(**mesh));
}

TEST(MeshBuild, IsTheSameWhateverTheBytesOfTheStorageHaveBeen) {
  const Graph graph{"", {{0, 0}, {90, 0}, {40, 9}, {50, -7}, {30, 50}}, {between_nodes(0, 1)}};
  static MeshStorage<40, 4> zero, other;
  std::fill(zero.bytes().begin(), zero.bytes().end(), std::byte{0});
  std::fill(other.bytes().begin(), other.bytes().end(), std::byte{0xa5});
  Mesh first, second;
  VertexId id;
  for (const auto& [mesh, storage] : {std::pair{&first, &zero}, std::pair{&second, &other}}) {
    ASSERT_EQ(mesh->open(storage->bytes(), storage->config()), Status::ok);
    ASSERT_EQ(mesh->build(graph.nodes, graph.features), Status::ok);
    ASSERT_EQ(mesh->join({60, 3}, id), Status::ok);
    ASSERT_EQ(mesh->leave(vertex_of(4)), Status::ok);
    ASSERT_EQ(mesh->canonicalize(), Status::ok);
  }
  EXPECT_EQ(picture_of(first), picture_of(second));
}

TEST(MeshBuild, OfTwoNodesIsAnEdge) {
  const auto mesh = built({"", {{0, 0}, {5, 1}}, {between_nodes(0, 1)}});
  EXPECT_EQ((*mesh)->finite_triangle_count(), 0u);
  Neighbour neighbour{};
  EXPECT_EQ((*mesh)->neighbours(VertexId{1}, {&neighbour, 1}), 1u);
  EXPECT_EQ(neighbour.vertex, VertexId{2});
  EXPECT_TRUE(neighbour.constrained);
  EXPECT_TRUE(is_sound(**mesh));
}

TEST(MeshBuild, OfCollinearNodesIsAChain) {
  const auto mesh = built({"", {{0, 0}, {9, 3}, {3, 1}, {6, 2}}, {between_nodes(0, 1)}});
  EXPECT_EQ((*mesh)->finite_triangle_count(), 0u);
  std::array<VertexId, 8> chain;
  ASSERT_EQ((*mesh)->chain(FeatureId{0}, chain), 4u);
  EXPECT_EQ(chain[0], vertex_of(0));
  EXPECT_EQ(chain[1], vertex_of(2));
  EXPECT_EQ(chain[2], vertex_of(3));
  EXPECT_EQ(chain[3], vertex_of(1));
  EXPECT_TRUE(is_sound(**mesh));
}

TEST(MeshBuild, OfCocircularNodesNeedsNoPointForAChord) {
  const auto mesh = built(inputs::exact_circle(40, 1));
  EXPECT_EQ((*mesh)->steiner_count(), 0u);
  EXPECT_TRUE(is_sound(**mesh));
}

TEST(MeshBuild, TakesAnyDiagonalOfASquare) {
  for (const FeatureEnds diagonal : {between_nodes(0, 2), between_nodes(1, 3)}) {
    const auto mesh = built({"", {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {diagonal}});
    EXPECT_EQ((*mesh)->steiner_count(), 0u);
    EXPECT_TRUE(is_sound(**mesh));
  }
}

TEST(MeshBuild, ReachesTheEdgesOfTheRange) {
  const Graph graph{"",
                    {{-far, -far}, {far, -far}, {far, far}, {-far, far}, {0, 1}, {1, 0}, {far, 0}},
                    {between_nodes(0, 2), between_nodes(2, 3), between_nodes(4, 3)}};
  const auto mesh = built(graph);
  EXPECT_TRUE(is_sound(**mesh));
  EXPECT_EQ((*mesh)->hash(), (*built(shuffled(graph, 1)))->hash());
}

TEST(MeshBuild, RefusesWhatIsOutOfRange) {
  constexpr std::int32_t least = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t bad : {far + 1, -far - 1, least, most}) {
    for (const Position position : {Position{bad, 0}, Position{0, bad}}) {
      const auto mesh = empty_mesh();
      EXPECT_EQ((*mesh)->build(std::array{Position{1, 1}, position}, {}), Status::bad_coordinate);
      EXPECT_EQ((*mesh)->node_count(), 0u);
      EXPECT_EQ((*mesh)->error_detail().status, Status::bad_coordinate);
      EXPECT_TRUE(is_sound(**mesh));
    }
  }
}

struct Wrong {
  const char* name;
  Status status;
  Graph graph;
};

void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.name; }

class MeshBuildRefuses : public testing::TestWithParam<Wrong> {
 public:
  static std::string name(const testing::TestParamInfo<Wrong>& info) { return info.param.name; }
};

TEST_P(MeshBuildRefuses, AndStaysEmpty) {
  const auto mesh = empty_mesh();
  const Picture before = picture_of(**mesh);
  const Graph& graph = GetParam().graph;
  EXPECT_EQ((*mesh)->build(graph.nodes, graph.features), GetParam().status);
  EXPECT_EQ((*mesh)->error_detail().status, GetParam().status);
  EXPECT_EQ(picture_of(**mesh), before);
  EXPECT_TRUE(is_sound(**mesh));
  VertexId id;
  EXPECT_EQ((*mesh)->join({0, 0}, id), Status::ok) << "the mesh is still of use";
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, MeshBuildRefuses,
    testing::Values(
        Wrong{"duplicate", Status::duplicate_vertex, {"", {{0, 0}, {1, 1}, {0, 0}}, {}}},
        Wrong{"two_duplicates", Status::duplicate_vertex, {"", {{7, 7}, {7, 7}}, {}}},
        Wrong{"unknown_end", Status::unknown_vertex, {"", square, {between_nodes(0, 5)}}},
        Wrong{"infinite_end",
              Status::unknown_vertex,
              {"", square, {{infinite_vertex, vertex_of(1)}}}},
        Wrong{"no_end", Status::unknown_vertex, {"", square, {{VertexId::none(), vertex_of(1)}}}},
        Wrong{"no_length", Status::zero_length_feature, {"", square, {between_nodes(2, 2)}}},
        Wrong{"repeated",
              Status::repeated_feature,
              {"", square, {between_nodes(0, 2), between_nodes(2, 0)}}},
        Wrong{"overlapping",
              Status::overlapping_features,
              {"", square, {between_nodes(0, 1), between_nodes(0, 4)}}},
        Wrong{"crossing",
              Status::crossing_features,
              {"", square, {between_nodes(0, 2), between_nodes(1, 3)}}}),
    MeshBuildRefuses::name);

TEST(MeshBuild, NamesTheDuplicateAndTheCrossing) {
  const auto mesh = empty_mesh();
  ASSERT_EQ((*mesh)->build(std::array{Position{0, 0}, Position{1, 1}, Position{0, 0}}, {}),
            Status::duplicate_vertex);
  EXPECT_TRUE((*mesh)->error_detail().vertex == vertex_of(0) ||
              (*mesh)->error_detail().vertex == vertex_of(2));
  ASSERT_EQ((*mesh)->build(
                square, std::array{between_nodes(1, 4), between_nodes(0, 2), between_nodes(1, 3)}),
            Status::crossing_features);
  const ErrorDetail& error_detail = (*mesh)->error_detail();
  EXPECT_EQ(std::min(error_detail.feature, error_detail.other), FeatureId{1});
  EXPECT_EQ(std::max(error_detail.feature, error_detail.other), FeatureId{2});
}

TEST(MeshBuild, NeedsAnEmptyMesh) {
  const auto mesh = built({"", square, {}});
  const Picture before = picture_of(**mesh);
  EXPECT_EQ((*mesh)->build(square, {}), Status::mesh_not_empty);
  EXPECT_EQ(picture_of(**mesh), before);
  (*mesh)->clear();
  EXPECT_EQ((*mesh)->build(square, {}), Status::ok);
}

// Whatever was in it before.
TEST(MeshBuild, TakesAMeshThatAllHaveLeft) {
  const std::array features{between_nodes(0, 2)};
  const auto fresh = built({"", square, {features.begin(), features.end()}});
  const auto mesh = built({"", {{0, 0}, {50, 9}, {50, -9}, {99, 0}}, {between_nodes(0, 3)}});
  ASSERT_EQ((*mesh)->remove_feature(FeatureId{0}), Status::ok);
  EXPECT_EQ((*mesh)->build(square, features), Status::mesh_not_empty) << "nodes stand";
  for (std::size_t i = 0; i < 4; ++i) ASSERT_EQ((*mesh)->leave(vertex_of(i)), Status::ok);
  EXPECT_EQ((*mesh)->build(std::array{Position{0, 0}, Position{0, 0}}, {}),
            Status::duplicate_vertex);
  ASSERT_EQ((*mesh)->build(square, features), Status::ok);
  EXPECT_EQ(picture_of(**mesh), picture_of(**fresh));
  EXPECT_TRUE((*mesh)->is_canonical());
  EXPECT_TRUE(is_sound(**mesh));
}

TEST(MeshBuild, TellsOnceThatTheNodesStand) {
  const auto count = [](void* calls) noexcept { ++*static_cast<int*>(calls); };
  const auto mesh = empty_mesh();
  int calls = 0;
  ASSERT_EQ(
      (*mesh)->build(square, std::array{between_nodes(0, 2)}, Work::unlimited(), count, &calls),
      Status::ok);
  EXPECT_EQ(calls, 1);
  const std::uint64_t hash = (*mesh)->hash();
  (*mesh)->clear();
  ASSERT_EQ((*mesh)->build(square, std::array{between_nodes(0, 2)}), Status::ok);
  EXPECT_EQ((*mesh)->hash(), hash);
  (*mesh)->clear();
  EXPECT_EQ((*mesh)->build(std::array{Position{0, 0}, Position{0, 0}}, {}, Work::unlimited(), count,
                           &calls),
            Status::duplicate_vertex);
  EXPECT_EQ(calls, 1);
}

TEST(MeshBuild, LetsFeaturesMeetWhereANodeStands) {
  const auto mesh = built(
      {"", {{0, 0}, {10, 0}, {5, -5}, {5, 5}, {5, 0}}, {between_nodes(0, 1), between_nodes(2, 3)}});
  EXPECT_EQ((*mesh)->steiner_count(), 0u);
  EXPECT_TRUE(is_sound(**mesh));
}

// In a fan a vertex at a new distance returns on all longer features, so distances must not
// multiply.
TEST(MeshBuild, NeedsFewVerticesOnAFanOfNarrowAngles) {
  constexpr std::size_t room = 2000;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const auto mesh = built(inputs::fan({50, 10, 100'000, 10'000'000, seed}), split_default, room);
    EXPECT_LT((*mesh)->steiner_count(), room);
    EXPECT_EQ(audit(**mesh).broken, Rule::none);
  }
}

TEST(MeshBuild, SharesThePlacesOfManyParallels) {
  // A place of its own for each split would take 1920.
  const auto mesh = built(inputs::parallels(20, 10, 100'000, 40, 51));
  EXPECT_LT((*mesh)->steiner_count(), 1150u);
  EXPECT_TRUE(passes_audit(**mesh));
}

TEST(MeshOpen, ChecksItsConfiguration) {
  MeshStorage<10, 4> storage;
  Mesh mesh;
  MeshConfig config = storage.config();
  EXPECT_EQ(mesh.open(storage.bytes(), config), Status::ok);
  config.vertices_max = 0;
  EXPECT_EQ(validate(config), Status::bad_config);
  EXPECT_EQ(mesh.open(storage.bytes(), config), Status::bad_config);
  config = storage.config();
  config.policy = nullptr;
  EXPECT_EQ(validate(config), Status::bad_config);
  config = storage.config();
  config.features_max = features_limit + 1;
  EXPECT_EQ(validate(config), Status::bad_config);
  config = storage.config();
  config.vertices_max = vertices_limit + 1;
  EXPECT_EQ(validate(config), Status::bad_config);
}

// What a machine of 32 bits computes, computed here.
TEST(StorageBytes, NeverSayLessThanIsNeeded) {
  constexpr std::uint32_t greatest = std::numeric_limits<std::uint32_t>::max();
  constexpr auto narrow = storage_bytes_as<std::uint32_t>;
  constexpr auto wide = storage_bytes_as<std::uint64_t>;
  static_assert(wide(100, 10) == storage_bytes(100, 10));
  static_assert(wide(greatest, greatest) < std::uint64_t{1} << 40);
  static_assert(wide(greatest, 0) > std::uint64_t{bytes_per_vertex_capacity} * greatest);
  static_assert(narrow(greatest, greatest) == greatest);
  static_assert(narrow(59'652'324, 0) >= (sizeof(IdValue) == 2 ? 2'600'000'000u : greatest));
  static_assert(narrow(1, greatest) == greatest);
  static_assert(storage_bytes_as<std::uint16_t>(1000, 10) == 65'535);
  static_assert(hint_side_bits(greatest) == 14);
  static_assert(hint_side_bits(15) == 0 && hint_side_bits(16) == 1);
  // Where the one is exact, so is the other; and more capacity never takes less memory.
  std::uint32_t before = 0;
  for (std::uint64_t vertices = 1; vertices <= greatest; vertices += vertices / 5 + 1) {
    const auto count = static_cast<std::uint32_t>(vertices);
    const std::uint64_t bytes = wide(count, count / 7);
    EXPECT_EQ(narrow(count, count / 7), std::min<std::uint64_t>(bytes, greatest)) << count;
    EXPECT_GE(narrow(count, count / 7), before) << count;
    before = narrow(count, count / 7);
  }
}

TEST(StorageBytes, BeyondTheLimitsOpenNothing) {
  constexpr std::uint32_t greatest = std::numeric_limits<std::uint32_t>::max();
  for (const MeshConfig& config : {MeshConfig{.vertices_max = greatest},
                                   MeshConfig{.vertices_max = 1, .features_max = greatest}}) {
    std::vector<std::uint64_t> storage(1000);
    Mesh mesh;
    EXPECT_EQ(validate(config), Status::bad_config);
    EXPECT_EQ(mesh.open(std::as_writable_bytes(std::span(storage)), config), Status::bad_config);
  }
  std::vector<std::uint64_t> storage(1000);
  const MeshConfig config{.vertices_max = vertices_limit, .features_max = features_limit};
  Mesh mesh;
  EXPECT_EQ(mesh.open(std::as_writable_bytes(std::span(storage)), config),
            sizeof(std::size_t) == 4 && sizeof(IdValue) == 4 ? Status::bad_config
                                                             : Status::storage_too_small);
}

TEST(MeshQueries, FillWhatFitsAndSayWhatIsNeeded) {
  const auto mesh = built({"", {{0, 0}, {10, 0}, {10, 10}, {0, 10}, {5, 4}}, {}});
  std::array<Neighbour, 2> few{};
  EXPECT_EQ((*mesh)->neighbours(vertex_of(4), few), 4u);
  EXPECT_NE(few[1].vertex, few[0].vertex);
  EXPECT_EQ((*mesh)->kind(infinite_vertex), VertexKind::none);
  EXPECT_EQ((*mesh)->vertex_id_end(), 6u);
  EXPECT_FALSE((*mesh)->is_feature(FeatureId{0}));
}

}  // namespace
}  // namespace etcm::test
