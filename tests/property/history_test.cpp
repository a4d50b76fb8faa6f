// Whatever happens to a mesh, it stays what mesh.h promises.
#include "support/history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "support/analysis_check.h"
#include "support/emulated.h"
#include "support/meshes.h"
#include "support/oracle.h"

namespace etcm::test {
namespace {

struct Life {
  const char* name;
  std::int32_t side;
  std::size_t crowd;
  int events;
  int audit_every;
  std::uint32_t vertices_max;
  std::uint32_t features_max;
  std::uint32_t steiner_max;
  unsigned work_bits;
};

void PrintTo(const Life& life, std::ostream* out) { *out << life.name; }

class Lives : public testing::TestWithParam<Life> {
 protected:
  MeshConfig config() const {
    MeshConfig config;
    config.vertices_max = GetParam().vertices_max;
    config.features_max = GetParam().features_max;
    config.steiner_max = GetParam().steiner_max;
    return config;
  }

 public:
  static std::string name(const testing::TestParamInfo<Life>& info) { return info.param.name; }
};

TEST_P(Lives, StaySound) {
  for (std::uint64_t seed = 1; seed <= (is_slow ? 1u : 3u); ++seed) {
    OwnedMesh mesh(config());
    ASSERT_EQ(mesh.opened(), Status::ok);
    History history(*mesh, GetParam().side, GetParam().crowd, seed);
    history.limit_work(GetParam().work_bits);
    for (int event = 1; event <= GetParam().events; ++event) {
      ASSERT_TRUE(history.step()) << "seed " << seed << ", event " << event;
      if (event % GetParam().audit_every != 0) continue;
      ASSERT_TRUE(passes_audit(*mesh)) << "seed " << seed << ", event " << event;
      ASSERT_TRUE(history.agrees()) << "seed " << seed << ", event " << event;
      if (event % 250 == 0) {
        ASSERT_TRUE(passes_oracle(*mesh)) << "seed " << seed << ", event " << event;
      }
    }
    const bool is_short = std::string(GetParam().name).starts_with("short");
    EXPECT_EQ(history.refused_for_room() > 0, is_short);
    const Graph standing = graph_of(*mesh);
    const auto batch = built(shuffled(standing, seed));
    const Status rebuilt = mesh->rebuild();
    if (rebuilt == Status::ok) {
      EXPECT_EQ(mesh->hash(), (*batch)->hash()) << "seed " << seed;
      EXPECT_TRUE(is_sound(*mesh)) << "seed " << seed;
      EXPECT_TRUE(history.agrees()) << "seed " << seed;
    } else {
      EXPECT_GT(history.refused_for_room(), 0u) << to_string(rebuilt);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Random, Lives,
    testing::Values(Life{"roomy", 1000, 60, 1000, 10, 4000, 200, 0, 0},
                    Life{"crowded", 12, 40, 1000, 1, 2000, 200, 0, 0},
                    Life{"tiny", 3, 6, 1000, 1, 200, 60, 0, 0},
                    Life{"flat", 1, 4, 300, 1, 50, 20, 0, 0},
                    Life{"wide", 20'000, 200, 400, 50, 8000, 400, 0, 0},
                    Life{"short_of_vertices", 1000, 60, 1000, 10, 70, 200, 0, 0},
                    Life{"short_of_features", 30, 40, 1000, 10, 2000, 6, 0, 0},
                    Life{"short_of_steiner", 1000, 60, 1000, 10, 4000, 200, 12, 0},
                    Life{"short_of_work", 1000, 60, 1000, 10, 4000, 200, 0, 14}),
    Lives::name);

// All leave, few return, all leave again; and whatever stands, each question has its answer.
TEST(EventfulHistory, IsAnalysedAtEachStep) {
  std::size_t times_empty = 0;
  for (std::uint64_t seed = 1; seed <= (is_slow ? 3u : 20u); ++seed) {
    const auto mesh = empty_mesh(300, 60);
    History history(**mesh, seed % 2 == 0 ? 6 : 1000, static_cast<std::size_t>(seed % 13), seed,
                    Course::eventful);
    AnalysisCheck analysis(300, seed);
    for (int event = 1; event <= 300; ++event) {
      ASSERT_TRUE(history.step()) << "seed " << seed << ", event " << event;
      ASSERT_TRUE(passes_audit(**mesh)) << "seed " << seed << ", event " << event;
      ASSERT_TRUE(analysis.of(**mesh)) << "seed " << seed << ", event " << event;
    }
    ASSERT_TRUE(history.agrees()) << "seed " << seed;
    times_empty += history.times_empty();
  }
  EXPECT_GT(times_empty, is_slow ? 3u : 20u);
}

// Whatever a mesh starts from, build() that gave up for any reason, restore() or rebuild(): each
// change succeeds whole or changes nothing.
TEST(EventfulHistory, StaysSoundFromAnyStart) {
  std::size_t times_incomplete = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= (is_slow ? 300u : 6000u); ++seed) {
    inputs::Random random(seed);
    MeshConfig config{.vertices_max = 300, .features_max = 60};
    const auto few = [&random] { return static_cast<std::uint32_t>(1 + random.below(3)); };
    if (seed % 4 == 1) config.steiner_max = few();
    if (seed % 4 == 2) config.vertices_max = 8 + 3 * few();
    if (seed % 4 == 3) config.features_max = 2 * few();
    if (seed % 3 == 0) config.policy = split_paper;
    OwnedMesh mesh(config);
    ASSERT_EQ(mesh.opened(), Status::ok);
    constexpr std::int32_t sides[] = {3, 4, 5, 30, 1000};
    History history(*mesh, sides[random.index(5)], 16, seed, Course::eventful);
    if (seed % 4 == 0) history.limit_work(14);
    for (int event = 1; event <= 12; ++event) {
      ASSERT_TRUE(history.step()) << "seed " << seed << ", event " << event;
      ASSERT_TRUE(passes_audit(*mesh)) << "seed " << seed << ", event " << event;
    }
    times_incomplete += history.times_incomplete();
    refused += history.refused_for_room();
  }
  EXPECT_GT(times_incomplete, is_slow ? 10u : 400u);
  EXPECT_GT(refused, is_slow ? 20u : 400u);
}

// What a mesh holds after a long life is little more than what it needs.
TEST(History, LeavesFewSteinerVerticesBehind) {
  double log_sum = 0;
  constexpr int lives = is_slow ? 3 : 10;
  for (std::uint64_t seed = 1; seed <= lives; ++seed) {
    const auto mesh = empty_mesh(8000, 1000);
    History history(**mesh, 1000, 200, seed);
    for (int event = 0; event < 1000; ++event) ASSERT_TRUE(history.step()) << "seed " << seed;
    const std::uint32_t lived = (*mesh)->steiner_count();
    ASSERT_EQ((*mesh)->rebuild(), Status::ok);
    ASSERT_GT((*mesh)->steiner_count(), 0u);
    log_sum += std::log(static_cast<double>(lived) / (*mesh)->steiner_count());
  }
  EXPECT_LE(std::exp(log_sum / lives), 1.2) << "geometric mean against a batch build";
}

// Many nodes, no features: joins and leaves are the inverse of each other.
TEST(PlainHistory, IsForgotten) {
  const auto mesh = empty_mesh(600, 0);
  inputs::Random random(7);
  std::vector<VertexId> ids;
  for (int event = 0; event < 3000; ++event) {
    if (ids.size() > 10 && random.below(ids.size() > 300 ? 2 : 3) == 0) {
      const std::size_t chosen = random.index(ids.size());
      ASSERT_EQ((*mesh)->leave(ids[chosen]), Status::ok);
      ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(chosen));
    } else {
      const std::int32_t x = random.between(-40, 40);
      const Position position{x, random.between(-40, 40)};
      VertexId id;
      const Status answer = (*mesh)->join(position, id);
      if (answer == Status::ok)
        ids.push_back(id);
      else
        ASSERT_TRUE(answer == Status::duplicate_vertex || answer == Status::out_of_vertices);
    }
    if (event % 20 != 0) continue;
    ASSERT_TRUE(passes_audit(**mesh)) << "event " << event;
    ASSERT_EQ((*mesh)->hash(), (*built(graph_of(**mesh)))->hash()) << "event " << event;
  }
  for (const VertexId id : ids) ASSERT_EQ((*mesh)->leave(id), Status::ok);
  EXPECT_EQ((*mesh)->node_count(), 0u);
  EXPECT_EQ((*mesh)->triangle_count(), 0u);
  EXPECT_TRUE(is_sound(**mesh));
}

}  // namespace
}  // namespace etcm::test
