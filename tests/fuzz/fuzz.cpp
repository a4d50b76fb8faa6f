// Lives without end: random meshes of random capacity under random changes, and all questions of
// the analysis after each, until the time or the count is up. Prints the seed of each failure;
// `--first SEED --lives 1` then lives it again.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "etcm/audit.h"
#include "inputs/random.h"
#include "support/analysis_check.h"
#include "support/canonical_life.h"
#include "support/history.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

// Every capacity and budget at times too small, places from so tight that all meets all to roomy.
MeshConfig random_config(inputs::Random& random) {
  const auto one_in = [&](std::uint64_t n) { return random.below(n) == 0; };
  MeshConfig config;
  config.vertices_max = static_cast<std::uint32_t>(one_in(2) ? 1 + random.below(120) : 3000);
  config.features_max = static_cast<std::uint32_t>(one_in(2) ? random.below(40) : 300);
  if (one_in(4)) config.steiner_max = static_cast<std::uint32_t>(1 + random.below(30));
  if (one_in(3)) config.policy = split_paper;
  return config;
}

bool live(std::uint64_t seed) {
  inputs::Random random(seed);
  OwnedMesh mesh(random_config(random));
  if (mesh.opened() != Status::ok) {
    std::fprintf(stderr, "seed %llu: open: %s\n", static_cast<unsigned long long>(seed),
                 to_string(mesh.opened()));
    return false;
  }
  constexpr std::int32_t sides[] = {1, 2, 3, 5, 8, 20, 100, 1000, 1'000'000, position_max};
  const std::int32_t side = sides[random.index(std::size(sides))];
  const Course course = random.below(3) == 0 ? Course::steady : Course::eventful;
  const std::size_t crowd = course == Course::eventful ? random.index(16) : 4 + random.index(60);
  History history(*mesh, side, crowd, random.next(), course);
  if (random.below(3) == 0) history.limit_work(4 + static_cast<unsigned>(random.below(12)));
  AnalysisCheck analysis(mesh->config().vertices_max, random.next());
  for (int event = 0; event < 300; ++event) {
    testing::AssertionResult answer = history.step();
    const Audit sound = audit(*mesh);
    if (answer && sound) answer = analysis.of(*mesh);
    if (answer && sound) continue;
    std::fprintf(stderr, "seed %llu, event %d: %s; audit: %s\n",
                 static_cast<unsigned long long>(seed), event, answer.message(),
                 to_string(sound.broken));
    return false;
  }
  if (mesh->rebuild() != Status::ok) return true;
  const Graph graph = graph_of(*mesh);
  for (const Graph& order : {graph, shuffled(graph, seed), shuffled(graph, seed + 1)}) {
    if (mesh->hash() == (*built(order, mesh->config().policy))->hash()) continue;
    std::fprintf(stderr, "seed %llu: a rebuild is not the batch mesh in every order\n",
                 static_cast<unsigned long long>(seed));
    return false;
  }
  return true;
}

bool live_canonical(std::uint64_t seed) {
  CanonicalLife life(seed);
  const testing::AssertionResult answer = life.live(300);
  if (!answer) {
    std::fprintf(stderr, "seed %llu, %s, %s\n", static_cast<unsigned long long>(seed),
                 life.name().c_str(), answer.message());
  }
  return answer;
}

int run(bool (*live)(std::uint64_t), std::uint64_t first, std::uint64_t lives,
        std::uint64_t seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  std::uint64_t failed = 0, lived = 0;
  while (lives != 0 ? lived < lives : std::chrono::steady_clock::now() < end) {
    failed += !live(first + lived);
    ++lived;
  }
  std::printf("%llu lives of 300 events from seed %llu, %llu failed\n",
              static_cast<unsigned long long>(lived), static_cast<unsigned long long>(first),
              static_cast<unsigned long long>(failed));
  return failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace etcm::test

int main(int argc, char** argv) {
  CLI::App app{
      "Random lives of meshes, each change judged by brute force and audited, and then analysed"};
  std::uint64_t first = 1, lives = 0, seconds = 600;
  bool is_canonical = false;
  app.add_option("--first", first, "the first seed; the next lives count up")
      ->capture_default_str();
  app.add_option("--lives", lives, "how many lives, instead of a time");
  app.add_option("--seconds", seconds, "for how long")->capture_default_str();
  app.add_flag("--canonical", is_canonical,
               "make the mesh canonical after its changes, and compare it with build()");
  CLI11_PARSE(app, argc, argv);
  using namespace etcm::test;
  return run(is_canonical ? live_canonical : live, first, lives, seconds);
}
