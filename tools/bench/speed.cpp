#include "bench/speed.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/cgal_peer.h"
#include "inputs/owned_mesh.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"

namespace etcm::bench {
namespace {

using inputs::FeatureLength;
using inputs::Graph;
using inputs::OwnedMesh;

struct Size {
  std::size_t nodes;
  FeatureLength length;
};

std::string name_of(Size size) {
  return std::to_string(size.nodes) + (size.length == FeatureLength::any ? "/long" : "/short");
}

// Made once, when first asked for: a filtered run makes only what it measures.
const Graph& graph_of(Size size) {
  static std::map<std::pair<std::size_t, FeatureLength>, Graph> graphs;
  const auto key = std::pair(size.nodes, size.length);
  const auto found = graphs.find(key);
  if (found != graphs.end()) return found->second;
  return graphs.emplace(key, inputs::random_graph(size.nodes, size.length, 1)).first->second;
}

// Long features of 5000 nodes need fewer than two Steiner vertices a node.
std::size_t steiner_room(const Graph& graph) { return 4 * graph.nodes.size() + 1000; }

void finish(benchmark::State& state, const Graph& graph) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(graph.nodes.size()));
}

void build_ours(benchmark::State& state, Size size, bool with_features) {
  const Graph& graph = graph_of(size);
  OwnedMesh mesh(inputs::config_for(graph, with_features ? steiner_room(graph) : 0));
  const std::span<const FeatureEnds> features =
      with_features ? std::span<const FeatureEnds>(graph.features) : std::span<const FeatureEnds>();
  for (auto _ : state) {
    mesh->clear();
    const Status status = mesh->build(graph.nodes, features);
    if (status != Status::ok) {
      state.SkipWithError(to_string(status));
      break;
    }
  }
  finish(state, graph);
  state.counters["steiner"] = mesh->steiner_count();
}

// The percentiles of single operations, which a mean would hide.
class Latencies {
 public:
  void add(double seconds) { seconds_.push_back(seconds); }
  void report(benchmark::State& state) {
    if (seconds_.empty()) return;
    std::sort(seconds_.begin(), seconds_.end());
    state.counters["median_us"] = 1e6 * seconds_[seconds_.size() / 2];
    state.counters["p99_us"] = 1e6 * seconds_[seconds_.size() * 99 / 100];
    state.counters["max_us"] = 1e6 * seconds_.back();
  }

 private:
  std::vector<double> seconds_;
};

template <class Operation>
double seconds_of(const Operation& operation) {
  const auto start = std::chrono::steady_clock::now();
  operation();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Position random_place(const Graph& graph, inputs::Random& random) {
  const std::int32_t side = inputs::random_graph_side(graph.nodes.size());
  const std::int32_t x = random.between(0, side);
  return {x, random.between(0, side)};
}

// Each node leaves again, outside the measurement, so that the mesh keeps its size.
void join_ours(benchmark::State& state, Size size) {
  const Graph& graph = graph_of(size);
  OwnedMesh mesh(inputs::config_for(graph, steiner_room(graph)));
  Status status = mesh->build(graph.nodes, graph.features);
  inputs::Random random(1);
  Latencies latencies;
  for (auto _ : state) {
    VertexId joined;
    double seconds = 0;
    do {
      const Position place = random_place(graph, random);
      seconds = seconds_of([&] { status = mesh->join(place, joined); });
    } while (status == Status::duplicate_vertex);
    if (status == Status::ok) status = mesh->leave(joined);
    if (status != Status::ok) {
      state.SkipWithError(to_string(status));
      break;
    }
    state.SetIterationTime(seconds);
    latencies.add(seconds);
  }
  latencies.report(state);
}

// What a join has left, taken back; and the same by laying all again.
void canonicalize_ours(benchmark::State& state, Size size, bool whole) {
  const Graph& graph = graph_of(size);
  OwnedMesh mesh(inputs::config_for(graph, steiner_room(graph)));
  Status status = mesh->build(graph.nodes, graph.features);
  inputs::Random random(1);
  Latencies latencies;
  for (auto _ : state) {
    VertexId joined;
    while (status == Status::ok) {
      status = mesh->join(random_place(graph, random), joined);
      if (status != Status::duplicate_vertex) break;
      status = Status::ok;
    }
    double seconds = 0;
    if (status == Status::ok) {
      seconds = seconds_of([&] { status = whole ? mesh->rebuild() : mesh->canonicalize(); });
    }
    if (status == Status::ok) status = mesh->leave(joined);
    if (status == Status::ok) status = mesh->canonicalize();
    if (status != Status::ok) {
      state.SkipWithError(to_string(status));
      break;
    }
    state.SetIterationTime(seconds);
    latencies.add(seconds);
  }
  latencies.report(state);
}

#ifdef ETCM_WITH_CGAL
void build_peer(benchmark::State& state, Size size, bool with_features) {
  const Graph& graph = graph_of(size);
  std::size_t vertices = 0;
  for (auto _ : state) {
    vertices = with_features ? cgal_conforming(graph) : cgal_delaunay(graph.nodes);
  }
  finish(state, graph);
  state.counters["steiner"] = static_cast<double>(vertices - graph.nodes.size());
}

void join_peer(benchmark::State& state, Size size) {
  const Graph& graph = graph_of(size);
  CgalMesh mesh(graph);
  inputs::Random random(1);
  Latencies latencies;
  for (auto _ : state) {
    const Position place = random_place(graph, random);
    const double seconds = seconds_of([&] { mesh.insert_and_conform(place); });
    state.SetIterationTime(seconds);
    latencies.add(seconds);
  }
  latencies.report(state);
}
#endif

void register_build(Size size, bool with_features) {
  const std::string task = with_features ? "conforming/" : "delaunay/";
  const std::string name = task + name_of(size);
  const auto unit = size.nodes >= 100'000 ? benchmark::kMillisecond : benchmark::kMicrosecond;
  benchmark::RegisterBenchmark((name + "/etcm").c_str(), build_ours, size, with_features)
      ->Unit(unit);
#ifdef ETCM_WITH_CGAL
  benchmark::RegisterBenchmark((name + "/cgal").c_str(), build_peer, size, with_features)
      ->Unit(unit);
#endif
}

void register_join(Size size) {
  const std::string name = "join/" + name_of(size);
  benchmark::RegisterBenchmark((name + "/etcm").c_str(), join_ours, size)
      ->UseManualTime()
      ->Iterations(5000)
      ->Unit(benchmark::kMicrosecond);
#ifdef ETCM_WITH_CGAL
  // Few enough that the mesh hardly grows, and that the largest ends in seconds.
  benchmark::RegisterBenchmark((name + "/cgal").c_str(), join_peer, size)
      ->UseManualTime()
      ->Iterations(100)
      ->Unit(benchmark::kMicrosecond);
#endif
}

void register_canonicalize(Size size) {
  const auto measure = [&](const char* task, bool whole, int iterations) {
    benchmark::RegisterBenchmark((task + name_of(size) + "/etcm").c_str(), canonicalize_ours, size,
                                 whole)
        ->UseManualTime()
        ->Iterations(iterations)
        ->Unit(benchmark::kMicrosecond);
  };
  measure("canonicalize/", false, 1000);
  measure("rebuild/", true, 100);
}

}  // namespace

void register_speed() {
  constexpr std::array sizes{Size{1000, FeatureLength::any}, Size{5000, FeatureLength::any},
                             Size{5000, FeatureLength::in_reach},
                             Size{100'000, FeatureLength::in_reach}};
  for (const Size size : sizes) {
    register_build(size, false);
    register_build(size, true);
  }
  register_build({10'000, FeatureLength::in_reach}, false);
  register_build({1'000'000, FeatureLength::in_reach}, false);
  for (const std::size_t nodes : {1000u, 10'000u, 100'000u}) {
    register_join({nodes, FeatureLength::in_reach});
  }
  for (const Size size : {Size{1000, FeatureLength::in_reach}, Size{5000, FeatureLength::in_reach},
                          Size{1000, FeatureLength::any}}) {
    register_canonicalize(size);
  }
}

}  // namespace etcm::bench
