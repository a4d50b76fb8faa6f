// Who counts as being around a node.
#include "firmware/readings/nearest_nodes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "simulated_site.h"
#include "support/allocation_watch.h"
#include "support/meshes.h"

namespace etcm::firmware {
namespace {

std::set<std::uint32_t> rows_around(const NearestNodes& nodes, std::uint32_t row) {
  std::set<std::uint32_t> rows;
  for (const NearNode& node : nodes.around(row)) rows.insert(node.row);
  return rows;
}

NearestNodes nearest_of(const Snapshot& snapshot) {
  const auto count = static_cast<std::uint32_t>(snapshot.vertices.size());
  NearestNodes nodes(count, count);
  nodes.take(snapshot, test::rows_of(snapshot));
  return nodes;
}

TEST(NearestNodes, AreThoseWithinTwoEdgesTheNearestFirst) {
  const Snapshot snapshot = test::snapshot_of({"", test::scattered(150, 100'000, 1), {}});
  const NearestNodes nodes = nearest_of(snapshot);
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    std::vector<std::pair<double, std::uint32_t>> wanted;
    std::set<std::uint32_t> rows;
    for (const auto& first : neighbours_of(snapshot, row)) {
      rows.insert(first.row);
      for (const auto& second : neighbours_of(snapshot, first.row)) rows.insert(second.row);
    }
    rows.erase(row);
    for (const std::uint32_t other : rows) {
      wanted.emplace_back(std::hypot(test::x_of(snapshot, other) - test::x_of(snapshot, row),
                                     test::y_of(snapshot, other) - test::y_of(snapshot, row)),
                          other);
    }
    std::sort(wanted.begin(), wanted.end());
    const auto around = nodes.around(row);
    // Farther rings are found from the nearest nodes of the first one, which here are all of it.
    ASSERT_EQ(around.size(), std::min(wanted.size(), nearest_nodes_max));
    for (std::size_t i = 0; i < around.size(); ++i) {
      EXPECT_EQ(around[i].row, wanted[i].second) << "row " << row;
      EXPECT_NEAR(std::hypot(around[i].x, around[i].y), wanted[i].first, 1e-6);
    }
  }
}

// Two rows of nodes on either side of a long feature that has Steiner vertices between them.
TEST(NearestNodes, LookThroughSteinerVertices) {
  std::vector<Position> positions{{0, 0}, {10'000, 0}};
  for (int i = 1; i < 10; ++i) {
    positions.push_back({1000 * i + 130, 90});
    positions.push_back({1000 * i - 70, -60});
  }
  const Snapshot snapshot = test::snapshot_of({"", positions, {test::between_nodes(0, 1)}});
  ASSERT_GT(snapshot.vertices.size(), positions.size() + 5);
  const NearestNodes nodes = nearest_of(snapshot);
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    for (const std::uint32_t other : rows_around(nodes, row)) {
      EXPECT_EQ(snapshot.vertices[other].kind, VertexKind::node);
      EXPECT_NE(other, row);
    }
    if (row >= positions.size()) {
      EXPECT_TRUE(nodes.around(row).empty());
    }
  }
  for (std::uint32_t row = 2; row < positions.size(); ++row) {
    const auto around = rows_around(nodes, row);
    // The node on the other side, and both ends of the feature.
    EXPECT_TRUE(around.contains(row ^ 1u)) << row;
    EXPECT_TRUE(around.contains(0)) << row;
    EXPECT_TRUE(around.contains(1)) << row;
  }
}

TEST(NearestNodes, OfAHubAreManyAndBounded) {
  std::vector<Position> positions{{0, 0}};
  for (int i = 0; i < 1000; ++i) {
    const double angle = 2 * 3.14159265358979 * i / 1000;
    positions.push_back({static_cast<std::int32_t>(std::lround(1e6 * std::cos(angle))),
                         static_cast<std::int32_t>(std::lround(1e6 * std::sin(angle)))});
  }
  const Snapshot snapshot = test::snapshot_of({"", positions, {}});
  const NearestNodes nodes = nearest_of(snapshot);
  EXPECT_EQ(nodes.around(0).size(), nearest_nodes_max);
  for (std::uint32_t row = 1; row <= 1000; ++row) EXPECT_GE(nodes.around(row).size(), 4u);
}

TEST(NearestNodes, OfSitesTooSmallAreFew) {
  EXPECT_TRUE(NearestNodes(0, 0).around(0).empty());
  EXPECT_TRUE(NearestNodes(5, 5).around(0).empty());
  const NearestNodes none = nearest_of(Snapshot{});
  EXPECT_TRUE(none.around(0).empty());
  EXPECT_TRUE(nearest_of(test::snapshot_of({"", {{3, 3}}, {}})).around(0).empty());
  EXPECT_EQ(nearest_of(test::snapshot_of({"", {{3, 3}, {5, 5}}, {}})).around(0).size(), 1u);
}

TEST(NearestNodes, RowsBeyondTheRoomAreLeftOut) {
  const Snapshot snapshot = test::snapshot_of({"", test::scattered(50, 1000, 2), {}});
  NearestNodes nodes(20, 50);
  nodes.take(snapshot, test::rows_of(snapshot));
  EXPECT_EQ(nodes.row_count(), 20u);
  for (std::uint32_t row = 0; row < 60; ++row) {
    for (const std::uint32_t other : rows_around(nodes, row)) EXPECT_LT(other, 20u);
    if (row >= 20) {
      EXPECT_TRUE(nodes.around(row).empty());
    }
  }
}

TEST(NearestNodes, AreOfThoseThatAreAskedAbout) {
  const Snapshot snapshot = test::snapshot_of({"", test::scattered(50, 1000, 2), {}});
  const NearestNodes all = nearest_of(snapshot);
  NearestNodes nodes(50, 3);
  nodes.take(snapshot, std::vector<std::uint32_t>{40, 7, 7, 99, 11, 12});
  for (const std::uint32_t row : {40u, 7u, 11u}) {
    EXPECT_EQ(rows_around(nodes, row), rows_around(all, row));
  }
  EXPECT_TRUE(nodes.around(12).empty()) << "there is no room for it";
  EXPECT_TRUE(nodes.around(8).empty());
  nodes.set_room(4);
  nodes.take(snapshot, std::vector<std::uint32_t>{12, 8, 7, 40});
  EXPECT_EQ(rows_around(nodes, 40), rows_around(all, 40));
  EXPECT_TRUE(nodes.around(11).empty());
}

TEST(NearestNodes, TakeNoMemoryLater) {
  const Snapshot large = test::snapshot_of({"", test::scattered(200, 100'000, 3), {}});
  const Snapshot small = test::snapshot_of({"", test::scattered(20, 100'000, 4), {}});
  const std::vector<std::uint32_t> rows = test::rows_of(large);
  const std::span few = std::span(rows).first(20);
  NearestNodes nodes(200, 200);
  const test::AllocationWatch watch;
  nodes.take(small, few);
  nodes.take(large, rows);
  nodes.take(small, few);
  EXPECT_EQ(watch.allocations(), 0u);
  EXPECT_EQ(nodes.row_count(), 20u);
}

}  // namespace
}  // namespace etcm::firmware
