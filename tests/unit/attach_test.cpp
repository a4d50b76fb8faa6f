// The bytes of a mesh, copied, kept, mapped and harmed.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <memory>

#include "etcm/audit.h"
#include "etcm/locate.h"
#include "etcm/nearest.h"
#include "etcm/storage.h"
#include "etcm/traverse.h"
#include "inputs/patterns.h"
#include "inputs/random.h"
#include "support/mesh_block.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

constexpr MeshConfig room{.vertices_max = 160, .features_max = 30};

std::unique_ptr<MeshBlock> block_of(const Graph& graph, const MeshConfig& config = room) {
  auto block = std::make_unique<MeshBlock>(config);
  EXPECT_EQ((*block)->open(block->bytes(), config), Status::ok);
  EXPECT_EQ((*block)->build(graph.nodes, graph.features), Status::ok);
  return block;
}

Graph comb() { return inputs::comb(12, 10, 400, 5); }

// One random change; what it answers and what the mesh then is.
std::vector<std::uint64_t> change(Mesh& mesh, inputs::Random& random) {
  const auto place = [&random] {
    const std::int32_t x = random.between(0, 400);
    return Position{x, random.between(0, 400)};
  };
  const auto some = [&random](std::uint32_t end) {
    return static_cast<IdValue>(random.below(end + 1));
  };
  VertexId vertex;
  FeatureId feature;
  Status status = Status::ok;
  const Position position = place();
  const VertexId v{some(mesh.vertex_id_end())}, w{some(mesh.vertex_id_end())};
  switch (random.below(6)) {
    case 0:
      status = mesh.join(position, vertex);
      break;
    case 1:
      status = mesh.leave(v);
      break;
    case 2:
      status = mesh.move(v, position);
      break;
    case 3:
      status = mesh.add_feature({v, w}, feature);
      break;
    case 4:
      status = mesh.remove_feature(FeatureId{some(mesh.feature_id_end())});
      break;
    default:
      status = mesh.canonicalize();
  }
  return {static_cast<std::uint64_t>(status),
          vertex.value,
          feature.value,
          mesh.work_needed().units,
          mesh.is_canonical(),
          mesh.error_detail().vertex.value,
          mesh.hash()};
}

void expect_same_life(Mesh& a, Mesh& b, std::uint64_t seed) {
  inputs::Random for_a(seed), for_b(seed);
  for (int i = 0; i < 150; ++i) {
    ASSERT_EQ(change(a, for_a), change(b, for_b)) << "change " << i;
    ASSERT_TRUE(picture_of(a) == picture_of(b));
  }
  EXPECT_TRUE(audit(b));
}

TEST(Attach, ACopyElsewhereGoesOnWithTheSameBits) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    auto original = block_of(comb());
    inputs::Random random(seed);
    for (int i = 0; i < 40; ++i) change(**original, random);
    MeshBlock copy(*original);
    ASSERT_EQ(attach_copy(*copy, copy.bytes()), Status::ok);
    expect_same_life(**original, *copy, seed);
  }
}

TEST(Attach, NothingOfTheCopyLeadsBackToTheOriginal) {
  auto original = block_of(comb());
  const Picture before = picture_of(**original);
  MeshBlock copy(*original);
  std::fill(original->bytes().begin(), original->bytes().end(), std::byte{0xAA});
  ASSERT_EQ(attach_copy(*copy, copy.bytes()), Status::ok);
  EXPECT_TRUE(picture_of(*copy) == before);
  EXPECT_TRUE(audit(*copy));
  inputs::Random random(7);
  for (int i = 0; i < 60; ++i) change(*copy, random);
  EXPECT_TRUE(audit(*copy));
}

TEST(Attach, AMeshIsKeptOverAReset) {
  auto block = block_of(comb());
  const Picture before = picture_of(**block);
  seal(**block);
  Mesh after;
  ASSERT_EQ(attach(after, block->bytes()), Status::ok);
  EXPECT_TRUE(picture_of(after) == before);
  EXPECT_TRUE(after.is_canonical());
  EXPECT_EQ(after.config().vertices_max, room.vertices_max);
  EXPECT_EQ(after.config().policy, SplitPolicy{split_default});
}

TEST(Attach, MeshesWithoutTrianglesAreMeshesToo) {
  for (std::size_t nodes = 0; nodes <= 4; ++nodes) {
    auto block = block_of({"", std::vector<Position>(square.data(), square.data() + nodes), {}});
    seal(**block);
    MeshBlock copy(*block);
    ASSERT_EQ(attach(*copy, copy.bytes()), Status::ok) << nodes;
    expect_same_life(**block, *copy, nodes);
  }
}

TEST(Attach, WhatHasChangedSinceItWasSealedIsRefused) {
  auto block = block_of(comb());
  seal(**block);
  VertexId id;
  ASSERT_EQ((*block)->join({-5, -5}, id), Status::ok);
  MeshBlock copy(*block);
  EXPECT_EQ(attach(*copy, copy.bytes()), Status::damaged);
  seal(**block);
  MeshBlock sealed(*block);
  EXPECT_EQ(attach(*sealed, sealed.bytes()), Status::ok);
}

TEST(Attach, WhatWasAttachedBeforeStaysWhereTheNextIsRefused) {
  auto block = block_of(comb());
  const std::uint64_t hash = (*block)->hash();
  std::vector<std::uint64_t> nothing(400);
  EXPECT_EQ(attach(**block, std::as_writable_bytes(std::span(nothing))), Status::not_a_mesh);
  EXPECT_EQ((*block)->hash(), hash);
}

TEST(Attach, AMeshWithoutPolicyIsRefused) {
  auto block = block_of(comb());
  seal(**block);
  EXPECT_EQ(attach(**block, block->bytes(), nullptr), Status::bad_config);
}

TEST(Attach, ThePolicyAndItsContextAreTaken) {
  auto block = block_of(comb());
  int context = 0;
  ASSERT_EQ(attach_copy(**block, block->bytes(), split_paper, &context), Status::ok);
  EXPECT_EQ((*block)->config().policy, SplitPolicy{split_paper});
  EXPECT_EQ((*block)->config().policy_context, &context);
}

TEST(Attach, EveryLengthThatIsCutOffIsRefused) {
  auto block = block_of(comb());
  seal(**block);
  const std::size_t whole = storage_bytes(room);
  for (std::size_t length = 0; length < whole; ++length) {
    Mesh mesh;
    ASSERT_EQ(attach(mesh, block->bytes().first(length)), Status::storage_too_small) << length;
  }
  EXPECT_EQ(attach(**block, block->bytes().first(whole)), Status::ok);
}

TEST(Attach, EachFlippedBitIsRefusedOrMeansNothing) {
  auto block = block_of(inputs::comb(3, 10, 60, 5), {.vertices_max = 30, .features_max = 8});
  seal(**block);
  const Picture before = picture_of(**block);
  const MeshBlock pristine(*block);
  std::size_t refused = 0;
  for (std::size_t i = 0; i < block->bytes().size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      MeshBlock harmed(pristine);
      harmed.bytes()[i] ^= std::byte{1} << bit;
      const Status status = attach(*harmed, harmed.bytes());
      if (status == Status::ok) {
        ASSERT_TRUE(picture_of(*harmed) == before) << i;
      } else {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 8u * 1000);
}

TEST(Attach, AHeadThatContradictsItselfIsRefusedWithoutAChecksum) {
  auto block = block_of(inputs::comb(3, 10, 60, 5), {.vertices_max = 30, .features_max = 8});
  for (const std::size_t at : {seal_bytes, seal_bytes + 5}) {
    MeshBlock harmed(*block);
    harmed.in_seal(at) ^= std::byte{1};
    EXPECT_EQ(attach_copy(*harmed, harmed.bytes()), Status::damaged);
  }
}

// Pages that a write would stop the program in.
class MappedFile {
 public:
  explicit MappedFile(std::span<const std::byte> bytes)
      : file_(std::tmpfile()), size_(bytes.size()) {
    EXPECT_EQ(std::fwrite(bytes.data(), 1, bytes.size(), file_), bytes.size());
    EXPECT_EQ(std::fflush(file_), 0);
    pages_ = mmap(nullptr, size_, PROT_READ, MAP_SHARED, fileno(file_), 0);
    EXPECT_NE(pages_, MAP_FAILED);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile() {
    munmap(pages_, size_);
    std::fclose(file_);
  }
  std::span<const std::byte> bytes() const {
    return {static_cast<const std::byte*>(pages_), size_};
  }

 private:
  std::FILE* file_;
  std::size_t size_;
  void* pages_ = nullptr;
};

TEST(MeshReader, ReadsBytesThatItMayNotWrite) {
  auto block = block_of(comb());
  seal(**block);
  const MappedFile file(block->bytes());
  MeshReader reader;
  ASSERT_EQ(reader.attach(file.bytes()), Status::ok);
  const Mesh& mesh = reader.mesh();
  EXPECT_TRUE(picture_of(mesh) == picture_of(**block));
  EXPECT_TRUE(audit(mesh));
  EXPECT_EQ(mesh.config().policy, nullptr);
  EXPECT_TRUE(mesh.is_canonical());
  for (std::int32_t x = -20; x < 420; x += 37) {
    const Point place = to_point({x, x / 2});
    EXPECT_EQ(locate(mesh, place).triangle, locate(**block, place).triangle);
    EXPECT_EQ(nearest_node(mesh, place), nearest_node(**block, place));
  }
  std::size_t nodes = 0;
  for ([[maybe_unused]] const auto node : nodes_of(mesh)) ++nodes;
  EXPECT_EQ(nodes, mesh.node_count());
  // The mesh goes on, for the file is another.
  VertexId id;
  EXPECT_EQ((*block)->join({-5, -5}, id), Status::ok);
  EXPECT_EQ(mesh.node_count() + 1, (*block)->node_count());
}

TEST(MeshReader, KeepsWhatItHadWhereTheNextIsRefused) {
  auto block = block_of(comb());
  seal(**block);
  MeshReader reader;
  ASSERT_EQ(reader.attach(block->bytes()), Status::ok);
  const std::uint64_t hash = reader.mesh().hash();
  MeshBlock harmed(*block);
  harmed.in_seal(0) = std::byte{};
  EXPECT_EQ(reader.attach(harmed.bytes()), Status::not_a_mesh);
  EXPECT_EQ(reader.attach_copy(harmed.bytes()), Status::not_a_mesh);
  EXPECT_EQ(reader.mesh().hash(), hash);
  ASSERT_EQ(reader.attach_copy(MeshBlock(*block).bytes().first(0)), Status::storage_too_small);
}

}  // namespace
}  // namespace etcm::test
