// A saved mesh is the same mesh on every machine; bytes that are none leave nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "base/checksum.h"
#include "etcm/audit.h"
#include "inputs/patterns.h"
#include "inputs/random.h"
#include "saved_mesh_1.h"
#include "support/history.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

using Bytes = std::vector<std::byte>;

Bytes saved(const Mesh& mesh) {
  Bytes bytes(mesh.saved_bytes());
  EXPECT_EQ(mesh.save(bytes), Status::ok);
  return bytes;
}

// As somebody does who forges one.
void sign(Bytes& bytes) {
  internal::Checksum sum;
  sum.add(bytes.data(), bytes.size() - 8);
  for (std::size_t i = 0; i < 8; ++i) {
    bytes[bytes.size() - 8 + i] = static_cast<std::byte>(sum.value() >> (8 * i));
  }
}

// A whole mesh that is what the bytes say, or an empty one.
void expect_whole_or_empty(const Bytes& bytes) {
  const auto mesh = empty_mesh(60, 20);
  const Status status = (*mesh)->load(bytes);
  if (status == Status::ok) {
    ASSERT_EQ(saved(**mesh), bytes);
  } else {
    ASSERT_EQ((*mesh)->node_count() + (*mesh)->feature_count(), 0u) << to_string(status);
    ASSERT_EQ((*mesh)->error_detail().status, status);
    VertexId id;
    ASSERT_EQ((*mesh)->join({1, 1}, id), Status::ok);
    ASSERT_EQ(id, VertexId{1});
  }
  ASSERT_TRUE(audit(**mesh));
}

// Few, with holes between the ids, a feature through a node and Steiner vertices.
std::unique_ptr<OwnedMesh> small() {
  auto mesh = built(inputs::comb(7, 10, 200, 5), split_default, 30);
  VertexId first, second, third;
  FeatureId feature;
  EXPECT_EQ((*mesh)->join({-100, -100}, first), Status::ok);
  EXPECT_EQ((*mesh)->join({-100, 0}, second), Status::ok);
  EXPECT_EQ((*mesh)->join({-100, 100}, third), Status::ok);
  EXPECT_EQ((*mesh)->add_feature({third, first}, feature), Status::ok);
  EXPECT_EQ((*mesh)->remove_feature(FeatureId{0}), Status::ok);
  EXPECT_EQ((*mesh)->leave(VertexId{1}), Status::ok);
  EXPECT_GT((*mesh)->steiner_count(), 2u);
  return mesh;
}

TEST(SavedMesh, IsTheSameWithAllIdsAndThoseThatComeNext) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto mesh = empty_mesh(120, 40);
    History history(**mesh, 60, 30, seed);
    for (int i = 0; i < 120; ++i) ASSERT_TRUE(history.step());
    const auto loaded = empty_mesh(150, 60);
    ASSERT_EQ((*loaded)->load(saved(**mesh)), Status::ok);
    ASSERT_TRUE(picture_of(**loaded) == picture_of(**mesh));
    ASSERT_TRUE(audit(**loaded));
    EXPECT_EQ(saved(**loaded), saved(**mesh));
    ASSERT_EQ((*mesh)->canonicalize(), Status::ok);
    ASSERT_EQ((*loaded)->canonicalize(), Status::ok);
    EXPECT_EQ((*loaded)->hash(), (*mesh)->hash());
  }
}

TEST(SavedMesh, GivesTheSameIdsToWhoComesNext) {
  const auto mesh = small();
  const auto loaded = empty_mesh();
  ASSERT_EQ((*loaded)->load(saved(**mesh)), Status::ok);
  for (std::int32_t i = 0; i < 12; ++i) {
    VertexId a, b;
    FeatureId f, g;
    const Position position{200 + 7 * i, i * i};
    ASSERT_EQ((*mesh)->join(position, a), (*loaded)->join(position, b));
    ASSERT_EQ(a, b);
    ASSERT_EQ((*mesh)->add_feature({a, VertexId{2}}, f),
              (*loaded)->add_feature({b, VertexId{2}}, g));
    ASSERT_EQ(f, g);
    ASSERT_TRUE(picture_of(**loaded) == picture_of(**mesh));
  }
}

TEST(SavedMesh, MayHaveFewNodesOrNone) {
  for (std::size_t nodes = 0; nodes <= 4; ++nodes) {
    const auto mesh = built({"", std::vector<Position>(square.data(), square.data() + nodes), {}});
    const auto loaded = empty_mesh();
    ASSERT_EQ((*loaded)->load(saved(**mesh)), Status::ok);
    EXPECT_TRUE(picture_of(**loaded) == picture_of(**mesh));
  }
}

TEST(SavedMesh, IsTheseBytesOnEveryMachine) {
  const Bytes bytes = saved(**small());
  internal::Checksum sum;
  sum.add(bytes.data(), bytes.size() - 8);
  EXPECT_EQ(bytes.size(), 376u);
  EXPECT_EQ(sum.value(), 12973877606963956849u);
}

Bytes bytes_of(std::string_view digits) {
  const auto value = [](char digit) { return digit <= '9' ? digit - '0' : digit - 'a' + 10; };
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(16 * value(digits[i]) + value(digits[i + 1])));
  }
  return bytes;
}

// By a version of old.
TEST(SavedMesh, OfTheFirstFormatIsLoadedForEver) {
  const auto mesh = empty_mesh(60, 20);
  ASSERT_EQ((*mesh)->load(bytes_of(saved_mesh_1)), Status::ok);
  EXPECT_TRUE(audit(**mesh));
  EXPECT_EQ((*mesh)->hash(), saved_mesh_1_hash);
  EXPECT_EQ((*mesh)->node_count(), 16u);
  EXPECT_EQ((*mesh)->steiner_count(), 5u);
  EXPECT_EQ((*mesh)->feature_count(), 7u);
  EXPECT_EQ((*mesh)->position(VertexId{2}), (Position{0, 200}));
}

TEST(SavedMesh, CutOffIsRefused) {
  const Bytes whole = saved(**small());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto mesh = empty_mesh();
    const std::span<const std::byte> part(whole.data(), length);
    ASSERT_EQ((*mesh)->load(part), Status::damaged) << length;
  }
}

TEST(SavedMesh, EachFlippedBitIsRefused) {
  const Bytes whole = saved(**small());
  const auto mesh = empty_mesh();
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes harmed = whole;
      harmed[i] ^= std::byte{1} << bit;
      ASSERT_NE((*mesh)->load(harmed), Status::ok) << i;
    }
  }
}

TEST(SavedMesh, ForgedIsAWholeMeshOrNone) {
  const Bytes whole = saved(**small());
  inputs::Random random(11);
  for (std::size_t i = 8; i + 8 < whole.size(); ++i) {
    for (const unsigned value : {0x00u, 0x01u, 0x7fu, 0x80u, 0xffu}) {
      Bytes forged = whole;
      forged[i] ^= static_cast<std::byte>(value == 0 ? 1 + random.below(255) : value);
      sign(forged);
      expect_whole_or_empty(forged);
    }
  }
}

// The hash is of the mesh that is saved, so only one that is made with it can be wrong elsewhere.
TEST(SavedMesh, ForgedInTwoWordsIsAWholeMeshOrNone) {
  const Bytes whole = saved(**small());
  inputs::Random random(12);
  for (int i = 0; i < 4000; ++i) {
    Bytes forged = whole;
    const auto word = [&] {
      return static_cast<std::ptrdiff_t>(4 * (2 + random.below((whole.size() - 16) / 4)));
    };
    for (int k = 0; k < 2; ++k) {
      const std::ptrdiff_t at = word();
      std::copy_n(whole.begin() + word(), 4, forged.begin() + at);
    }
    sign(forged);
    expect_whole_or_empty(forged);
  }
}

// Checksum and hash are right, but a segment goes on beyond a node on its line, where another one
// begins.
TEST(SavedMesh, ForgedWithASegmentThatJumpsOverANodeIsDamaged) {
  for (const std::string_view digits :
       {"6574636d73617665010000000400000002000000030000000000000002000000fbf10a214048f70e"
        "02000001010000010400000104000001feffff00fbffff000300000002000000ffffffff00000000"
        "0300000001000000ffffffff01000000b67e0081f461238e",
        "6574636d73617665010000000600000005000000050000000000000004000000db1f989788e225a1"
        "ffffff00feffff00fbffff00fcffff00fcffff0002000001ffffff0001000001ffffff00fcffff00"
        "0500000004000000ffffffff000000800500000001000000ffffffff01000000ffffffffffffffff"
        "ffffffffffffffff0200000005000000ffffffff030000000300000001000000ffffffff04000080"
        "1dcf351f63463571",
        "6574636d73617665010000000c000000050000000600000001000000030000004b6113f1edb0ec8c"
        "04000001fcffff0003000001ffffff00fcffff00ffffff0004000001fbffff000400000105000001"
        "0200000101000001ffffffffffffffff010000803c3c3c0cffffffffffffffffffffffffffffffff"
        "ffffffffffffffffffffffffffffffffffffffffffffffff0200000004000000ffffffff01000000"
        "0400000005000000ffffffff02000000ffffffffffffffffffffffffffffffff0300000006000000"
        "ffffffff04000000d16e59afecf231cd"}) {
    const auto mesh = empty_mesh(60, 20);
    EXPECT_EQ((*mesh)->load(bytes_of(digits)), Status::damaged);
    EXPECT_EQ((*mesh)->node_count(), 0u);
  }
}

TEST(SavedMesh, NeedsRoom) {
  const auto mesh = small();
  const Bytes bytes = saved(**mesh);
  const std::uint32_t vertices = (*mesh)->vertex_id_end() - 1;
  const std::uint32_t features = (*mesh)->feature_id_end();
  const auto load_into = [&bytes](const MeshConfig& config) {
    return OwnedMesh(config)->load(bytes);
  };
  EXPECT_EQ(load_into({.vertices_max = vertices, .features_max = features}), Status::ok);
  EXPECT_EQ(load_into({.vertices_max = vertices - 1, .features_max = features}),
            Status::out_of_vertices);
  EXPECT_EQ(load_into({.vertices_max = vertices, .features_max = features - 1}),
            Status::out_of_features);
  EXPECT_EQ(load_into({.vertices_max = vertices, .features_max = features, .steiner_max = 1}),
            Status::steiner_budget);
}

TEST(SavedMesh, NeedsWork) {
  const auto mesh = small();
  const Bytes bytes = saved(**mesh);
  const auto loaded = empty_mesh();
  ASSERT_EQ((*loaded)->load(bytes), Status::ok);
  const std::uint64_t needed = (*loaded)->work_needed().units;
  for (std::uint64_t limit = 0; limit < needed; limit += 7) {
    const auto other = empty_mesh();
    ASSERT_EQ((*other)->load(bytes, Work{limit}), Status::work_limit) << limit;
    ASSERT_LE((*other)->work_used().units, limit + 24);
    ASSERT_EQ((*other)->node_count(), 0u);
  }
  const auto other = empty_mesh();
  EXPECT_EQ((*other)->load(bytes, Work{needed}), Status::ok);
}

TEST(SavedMesh, IsWhole) {
  MeshConfig config = inputs::config_for(inputs::comb(20, 10, 1000, 5), 1000);
  config.steiner_max = 1;
  OwnedMesh mesh(config);
  const Graph graph = inputs::comb(20, 10, 1000, 5);
  EXPECT_EQ(mesh->build(graph.nodes, graph.features), Status::steiner_budget);
  Bytes bytes(mesh->saved_bytes(), std::byte{7});
  EXPECT_EQ(mesh->save(bytes), Status::mesh_unresolved);
  EXPECT_EQ(std::count(bytes.begin(), bytes.end(), std::byte{7}),
            static_cast<std::ptrdiff_t>(bytes.size()));
}

TEST(SavedMesh, IsNotWrittenBeyondTheSpan) {
  const auto mesh = small();
  Bytes bytes((*mesh)->saved_bytes() - 1);
  EXPECT_EQ((*mesh)->save(bytes), Status::buffer_too_small);
  EXPECT_EQ((*mesh)->load(saved(**mesh)), Status::mesh_not_empty);
}

}  // namespace
}  // namespace etcm::test
