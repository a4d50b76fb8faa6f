// etcm/bound.h against the nodes, one by one.
#include "etcm/bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "etcm/policy.h"
#include "etcm/predicates.h"
#include "inputs/corpus.h"
#include "inputs/patterns.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"
#include "support/emulated.h"
#include "support/families.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

// A segment between two nodes with no node inside, and all nodes beside it.
class BesideSegment {
 public:
  BesideSegment(const std::vector<Position>& nodes, Position from, Position to)
      : from_(from), to_(to) {
    for (const Position node : nodes) {
      const int side = orient2d(at(0), at(parameter_end), to_point(node));
      if (side > 0) left_.push_back(to_point(node));
      if (side < 0) right_.push_back(to_point(node));
    }
  }

  std::uint32_t least() const {
    std::uint32_t count = 0;
    for (Parameter reach = reach_from(0); reach < parameter_end - 1;) {
      ++count;
      reach = reach_from(reach + 1);
    }
    return reach_from(0) == parameter_end ? 0 : std::max(count, 1u);
  }

 private:
  Point at(Parameter t) const {
    return {from_.x * subunits_per_unit + t * (std::int64_t{to_.x} - from_.x),
            from_.y * subunits_per_unit + t * (std::int64_t{to_.y} - from_.y)};
  }

  // Whether some circle through both places has no node inside: the one through the node on the
  // left that sees them under the greatest angle leans furthest to the right.
  bool can_be_edge(Parameter head, Parameter tail) const {
    if (left_.empty()) return true;
    const Point a = at(head), b = at(tail);
    const Point* foremost = &left_.front();
    for (const Point& node : left_) {
      if (incircle(a, b, *foremost, node) > 0) foremost = &node;
    }
    return std::none_of(right_.begin(), right_.end(),
                        [&](const Point& node) { return incircle(a, b, *foremost, node) > 0; });
  }

  Parameter reach_from(Parameter head) const {
    Parameter low = head, high = parameter_end;
    while (low < high) {
      const Parameter middle = low + (high - low + 1) / 2;
      if (can_be_edge(head, middle)) {
        low = middle;
      } else {
        high = middle - 1;
      }
    }
    return low;
  }

  Position from_;
  Position to_;
  std::vector<Point> left_;
  std::vector<Point> right_;
};

std::uint32_t least_by_hand(const Graph& graph, FeatureEnds feature) {
  const Position from = graph.nodes[inputs::node_index_of(feature.from)];
  const Position to = graph.nodes[inputs::node_index_of(feature.to)];
  const auto along = [&](const Position& p) {
    return (std::int64_t{p.x} - from.x) * (std::int64_t{to.x} - from.x) +
           (std::int64_t{p.y} - from.y) * (std::int64_t{to.y} - from.y);
  };
  std::vector<Position> on_it{from, to};
  for (const Position& p : graph.nodes) {
    if (orient2d(to_point(from), to_point(to), to_point(p)) == 0 && along(p) > 0 &&
        along(p) < along(to)) {
      on_it.push_back(p);
    }
  }
  std::sort(on_it.begin(), on_it.end(),
            [](const Position& a, const Position& b) { return to_point(a) < to_point(b); });
  std::uint32_t sum = 0;
  for (std::size_t i = 1; i < on_it.size(); ++i) {
    sum += BesideSegment(graph.nodes, on_it[i - 1], on_it[i]).least();
  }
  return sum;
}

std::unique_ptr<OwnedMesh> mesh_of_nodes(const Graph& graph) {
  return built({graph.name, graph.nodes, {}});
}

TEST(Bound, IsWhatTheNodesSay) {
  std::uint32_t sum = 0;
  for (std::uint64_t seed = 1; seed <= (is_slow ? 10u : 300u); ++seed) {
    inputs::Random random(seed);
    const Graph graph = graph_of_some_family(random);
    const auto nodes = mesh_of_nodes(graph);
    for (const FeatureEnds& feature : graph.features) {
      const std::uint32_t least = least_steiner(**nodes, feature);
      ASSERT_EQ(least, least_by_hand(graph, feature))
          << graph.name << ", seed " << seed << ": " << feature.from.value << "-"
          << feature.to.value;
      EXPECT_EQ(least_steiner(**nodes, {feature.to, feature.from}), least);
      sum += least;
    }
  }
  EXPECT_GT(sum, is_slow ? 10u : 2000u);
}

TEST(Bound, IsNeverAboveTheMesh) {
  for (const inputs::CorpusEntry& entry : inputs::corpus()) {
    const Graph& graph = entry.graph;
    if (graph.nodes.size() > (is_slow ? 100u : 1000u)) continue;
    const auto nodes = mesh_of_nodes(graph);
    const auto mesh = std::make_unique<OwnedMesh>(inputs::config_for(graph, 20'000));
    ASSERT_EQ((*mesh)->build(graph.nodes, graph.features), Status::ok) << graph.name;
    std::uint32_t least = 0;
    for (const FeatureEnds& feature : graph.features) least += least_steiner(**nodes, feature);
    EXPECT_LE(least, (*mesh)->steiner_count()) << graph.name;
  }
}

TEST(Bound, IsReachedByAFeatureThatIsAlone) {
  std::uint32_t sum = 0;
  for (std::uint64_t seed = 1; seed <= (is_slow ? 5u : 100u); ++seed) {
    Graph graph = inputs::random_graph(200 + 2 * static_cast<std::size_t>(seed),
                                       inputs::FeatureLength::any, seed);
    graph.features.resize(1);
    const std::uint32_t least = least_steiner(**mesh_of_nodes(graph), graph.features.front());
    EXPECT_EQ((*built(graph))->steiner_count(), least) << graph.name;
    sum += least;
  }
  EXPECT_GT(sum, is_slow ? 20u : 400u);
}

TEST(Bound, IsReachedByFeaturesFarFromEachOther) {
  // Three squares of nodes, far apart, and a feature across each.
  Graph graph = inputs::random_graph(200, inputs::FeatureLength::any, 9);
  const std::vector<Position> nodes = graph.nodes;
  const FeatureEnds across = graph.features.front();
  graph.features.clear();
  graph.nodes.clear();
  for (std::size_t i = 0; i < 3; ++i) {
    for (const Position& p : nodes) {
      graph.nodes.push_back({p.x + static_cast<std::int32_t>(i) * 100'000, p.y});
    }
    graph.features.push_back(between_nodes(i * nodes.size() + inputs::node_index_of(across.from),
                                           i * nodes.size() + inputs::node_index_of(across.to)));
  }
  const auto plain = mesh_of_nodes(graph);
  std::uint32_t least = 0;
  for (const FeatureEnds& feature : graph.features) least += least_steiner(**plain, feature);
  EXPECT_GT(least, 10u);
  EXPECT_EQ((*built(graph))->steiner_count(), least);
}

}  // namespace
}  // namespace etcm::test
