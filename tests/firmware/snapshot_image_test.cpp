// A snapshot as files show it: the same mesh, whatever its ids and its history.
#include "firmware/publish/snapshot_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

#include "etcm/files/mesh_text.h"
#include "fakes.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

// What is in an image, without its numbers: those of Steiner vertices are its own.
struct Content {
  std::set<Point> nodes, steiner;
  std::set<std::array<Point, 3>> triangles;
  std::set<std::pair<std::pair<Point, Point>, bool>> edges;
  std::set<std::pair<Point, Point>> subsegments;
  friend bool operator==(const Content&, const Content&) = default;
};

std::pair<Point, Point> ends_of(const files::MeshImage& image, std::uint32_t a, std::uint32_t b) {
  return std::minmax({image.vertices[a].point, image.vertices[b].point});
}

Content content_of(const files::MeshImage& image) {
  Content content;
  for (const files::ImageVertex& vertex : image.vertices) {
    (vertex.is_steiner ? content.steiner : content.nodes).insert(vertex.point);
    EXPECT_EQ(vertex.marker, vertex.is_steiner ? -1 : 0);
  }
  for (const auto& triangle : image.triangles) {
    std::array<Point, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = image.vertices[triangle[i]].point;
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    content.triangles.insert(corners);
  }
  for (const files::ImageEdge& edge : image.edges) {
    EXPECT_LT(edge.from, edge.to);
    EXPECT_EQ(edge.marker, edge.is_constrained ? 1 : 0);
    content.edges.insert({ends_of(image, edge.from, edge.to), edge.is_constrained});
  }
  for (const files::ImageSubsegment& subsegment : image.subsegments) {
    EXPECT_TRUE(subsegment.is_edge);
    content.subsegments.insert(ends_of(image, subsegment.from, subsegment.to));
  }
  return content;
}

void expect_same(const Rig& rig) {
  const files::MeshImage expected = files::image_of(rig.mesh, Exterior::automatic, {});
  const files::MeshImage& image = *rig.files.last;
  EXPECT_EQ(image.node_count, expected.node_count);
  EXPECT_EQ(image.feature_count, expected.feature_count);
  EXPECT_EQ(image.vertices.size(), expected.vertices.size());
  EXPECT_EQ(image.triangles.size(), expected.triangles.size());
  EXPECT_EQ(image.edges.size(), expected.edges.size());
  EXPECT_EQ(image.subsegments.size(), expected.subsegments.size());
  EXPECT_EQ(content_of(image), content_of(expected));
  EXPECT_TRUE(std::is_sorted(image.triangles.begin(), image.triangles.end()));
  EXPECT_TRUE(std::is_sorted(image.edges.begin(), image.edges.end(),
                             [](const files::ImageEdge& a, const files::ImageEdge& b) {
                               return std::pair(a.from, a.to) < std::pair(b.from, b.to);
                             }));
}

TEST(SnapshotImage, IsThatOfTheMeshWhereverNodesStand) {
  Rig rig({feature(1001, 1002), feature(1003, 1004), feature(1001, 1005)});
  std::uint32_t number = 12345;
  const auto next = [&](std::uint32_t below) {
    number = number * 1664525u + 1013904223u;
    return static_cast<std::int32_t>((number >> 8) % below);
  };
  std::uint32_t most_steiner = 0;
  for (int round = 0; round < 60; ++round) {
    // Few places, so that features run through nodes and beside them.
    const auto unit = static_cast<std::uint8_t>(1 + next(20));
    if (next(4) == 0) {
      rig.put(unit, 0, 0, node_status::fix_valid | node_status::leaving);
    } else {
      rig.put(unit, next(7) * 100, next(7) * 37);
    }
    rig.run(800ms);
    if (rig.files.last == nullptr) continue;
    ASSERT_EQ(rig.mesh.hash(), rig.gateway->snapshot().mesh_hash);
    expect_same(rig);
    most_steiner = std::max(most_steiner, rig.mesh.steiner_count());
  }
  EXPECT_GT(most_steiner, 0u);
}

TEST(SnapshotImage, ShowsWhatClosedFeaturesEnclose) {
  Rig rig({feature(1001, 1002), feature(1002, 1003), feature(1003, 1004), feature(1004, 1005),
           feature(1005, 1001)});
  // The fourth corner is pushed in: what is outside it is no part of the domain.
  rig.put_square();
  rig.put(4, 30, 50);
  rig.put(5, 0, 100);
  rig.run(1s);
  ASSERT_EQ(rig.gateway->snapshot().features_active, 5u);
  expect_same(rig);
  EXPECT_LT(rig.files.last->triangles.size(), rig.mesh.finite_triangle_count());
}

TEST(SnapshotImage, ExistsForEveryNumberOfNodes) {
  Rig rig;
  for (std::uint8_t count = 1; count <= 5; ++count) {
    // The first four are on one line.
    rig.put(count, 100 * count, count == 5 ? 70 : 0);
    rig.run(1s);
    ASSERT_EQ(rig.files.nodes_written.back(), count);
    expect_same(rig);
  }
}

TEST(SnapshotImage, HasTheSerialsOfNodesAndNoneOfAnchors) {
  Rig rig;
  rig.settings.anchors.push_back({.position = {50, 50}, .source = "site.geojson:1"});
  rig.put_square();
  rig.run(1s);
  const std::string node = files::text_of(files::write_node, *rig.files.last);
  EXPECT_NE(node.find(" 50 50 -1 0\n"), std::string::npos) << node;
  EXPECT_NE(node.find(" 100 0 1002 0\n"), std::string::npos) << node;
  EXPECT_NE(node.find(" 0 100 1004 0\n"), std::string::npos) << node;
}

}  // namespace
}  // namespace etcm::firmware
