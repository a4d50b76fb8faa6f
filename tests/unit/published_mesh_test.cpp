// The example of one writer and many readers: both meshes stay one, whatever is refused.
#include "published_mesh.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "inputs/random.h"

namespace etcm::test {
namespace {

using Published = example::PublishedMesh<200, 40>;

// Changes at random; node and feature ids are those that the mesh gives.
class Writer {
 public:
  explicit Writer(std::uint64_t seed) : random_(seed) {}

  // What `change` of the example is given, without its limit.
  auto next() {
    const std::uint64_t kind = nodes_.size() < 3 ? 0 : random_.below(11);
    const Position place{coordinate(), coordinate()};
    const VertexId from = any(nodes_), to = any(nodes_);
    const FeatureId feature = any(features_);
    return [=, this](Mesh& mesh, Work limit) {
      if (kind < 4) return mesh.join(place, joined_, limit);
      if (kind < 5) return mesh.leave(from, limit);
      if (kind < 7) return mesh.move(from, place, limit);
      if (kind < 9) return mesh.add_feature({from, to}, added_, limit);
      if (kind < 10) return mesh.remove_feature(feature, limit);
      // With a limit it would keep a part of what it does.
      return mesh.canonicalize();
    };
  }

  void look(const Mesh& mesh) {
    nodes_.clear();
    for (IdValue id = 1; id < mesh.vertex_id_end(); ++id) {
      if (mesh.kind(VertexId{id}) == VertexKind::node) nodes_.push_back(VertexId{id});
    }
    features_.clear();
    for (IdValue id = 0; id < mesh.feature_id_end(); ++id) {
      if (mesh.is_feature(FeatureId{id})) features_.push_back(FeatureId{id});
    }
  }

 private:
  std::int32_t coordinate() { return random_.between(0, 999); }
  template <class Id>
  Id any(const std::vector<Id>& ids) {
    return ids.empty() ? Id{} : ids[random_.index(ids.size())];
  }

  inputs::Random random_;
  std::vector<VertexId> nodes_;
  std::vector<FeatureId> features_;
  VertexId joined_;
  FeatureId added_;
};

// What stands at each id.
std::vector<Point> places_of(const Mesh& mesh) {
  std::vector<Point> places;
  for (IdValue id = 1; id < mesh.vertex_id_end(); ++id) {
    const VertexId vertex{id};
    places.push_back(mesh.kind(vertex) == VertexKind::none ? Point{} : mesh.point(vertex));
  }
  return places;
}

// What is refused rearranges the storage of the mesh behind, so a call may take more work in the
// other one than in it: who limits both would have one of them without the change.
TEST(PublishedMesh, StaysOneMeshUnderALimitOfWork) {
  std::uint32_t refused = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Published published;
    ASSERT_EQ(published.open(), Status::ok);
    Writer writer(seed);
    for (int step = 0; step < 500; ++step) {
      const auto change = writer.next();
      Status first = Status::ok;
      std::uint64_t hash = 0;
      std::vector<Point> places;
      bool is_second = false;
      const Status answered = published.change(
          [&](Mesh& mesh, Work limit) {
            const Status status = change(mesh, limit);
            if (is_second) {
              EXPECT_EQ(status, first) << "seed " << seed << ", step " << step;
              EXPECT_EQ(mesh.hash(), hash) << "seed " << seed << ", step " << step;
              EXPECT_EQ(places_of(mesh), places) << "seed " << seed << ", step " << step;
            }
            is_second = true;
            first = status;
            hash = mesh.hash();
            places = places_of(mesh);
            writer.look(mesh);
            return status;
          },
          Work{seed % 2 == 0 ? 300u : 1428u}, [] {});
      ASSERT_EQ(answered, first);
      refused += answered == Status::work_limit ? 1 : 0;
    }
  }
  EXPECT_GT(refused, 100u);
}

}  // namespace
}  // namespace etcm::test
