#include "etcm/files/mesh_image.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "etcm/files/error.h"
#include "etcm/files/exchange.h"
#include "etcm/files/grid.h"
#include "etcm/files/mesh_text.h"
#include "inputs/owned_mesh.h"
#include "support/scratch_folder.h"

namespace etcm::files {
namespace {

using test::ScratchFolder;

// A plate with a hole, and a feature that needs a Steiner vertex; attributes and markers.
const char* const plate =
    "12 2 1 1\n0 0 0 1.5 7\n1 200 0 2 7\n2 260 90 2 7\n3 200 160 2 7\n4 0 160 2 7\n5 60 60 2 8\n"
    "6 120 50 2 8\n7 130 100 2 8\n8 70 110 2 8\n9 20 80 1 0\n10 190 80 2 0\n11 100 140 3 -4\n"
    "10 1\n0 0 1 5\n1 1 2 5\n2 2 3 5\n3 3 4 5\n4 4 0 5\n5 5 6 9\n6 6 7 9\n7 7 8 9\n8 8 5 9\n"
    "9 9 11 0\n1\n1 100.5 80.25\n1\n1 10 10 0.25 -1\n";

MeshImage image_of_graph(const ConstraintGraph& graph, const Placement& placement = {},
                         Exterior exterior = Exterior::automatic) {
  const GridGraph grid = place_on_grid(graph, placement);
  inputs::OwnedMesh mesh({.vertices_max = 2000, .features_max = 2000});
  EXPECT_EQ(mesh->build(grid.nodes, grid.features), Status::ok);
  MeshImage image = image_of(*mesh, exterior, grid.holes);
  carry_through(graph, placement, image);
  return image;
}

TEST(MeshImage, CarriesMarkersAndAttributes) {
  const ScratchFolder folder;
  const ConstraintGraph graph = read_graph(folder.write("plate.poly", plate));
  const MeshImage image = image_of_graph(graph);
  ASSERT_EQ(image.node_count, 12u);
  ASSERT_GT(image.steiner_count(), 0u);
  EXPECT_EQ(image.index_base, 0);
  EXPECT_EQ(image.vertices[5].marker, 8);
  EXPECT_EQ(image.vertices.back().marker, -5);  // below the lowest of the nodes
  EXPECT_EQ(image.attributes[0], "1.5");
  const double between = std::stod(image.attributes.back());
  EXPECT_GT(between, 1);
  EXPECT_LT(between, 3);
  for (const ImageSubsegment& subsegment : image.subsegments) {
    EXPECT_TRUE(subsegment.is_edge);
    EXPECT_EQ(subsegment.marker, graph.features[subsegment.feature].marker);
    const ImageEdge& edge = image.edges[find_edge(image, subsegment.from, subsegment.to)];
    EXPECT_TRUE(edge.is_constrained);
    EXPECT_EQ(edge.marker, subsegment.marker == 0 ? 1 : subsegment.marker);
  }
  // The hole is the quadrilateral 5 6 7 8: no triangle has two opposite corners of it.
  for (const auto& corner : image.triangles) {
    EXPECT_FALSE(std::count(corner.begin(), corner.end(), 5u) +
                     std::count(corner.begin(), corner.end(), 7u) ==
                 2);
  }
}

TEST(MeshImage, SurvivesTheFiles) {
  const ScratchFolder folder;
  const ConstraintGraph graph = read_graph(folder.write("plate.poly", plate));
  const MeshImage image = image_of_graph(graph);
  FileSet files;
  add_mesh_files(image, folder.path("out"), files);
  files.commit();
  MeshImage back = read_mesh(folder.path("out"));
  EXPECT_EQ(back.feature_count, image.feature_count);
  EXPECT_EQ(back.vertices, image.vertices);
  EXPECT_EQ(back.node_count, image.node_count);
  EXPECT_EQ(back.triangles, image.triangles);
  EXPECT_EQ(back.edges, image.edges);
  EXPECT_EQ(back.attributes, image.attributes);
  // Which mesh it was stands in a comment.
  const std::string nodes = text_of(write_node, image);
  std::array<char, 17> hash{};
  std::snprintf(hash.data(), hash.size(), "%016llx",
                static_cast<unsigned long long>(image.mesh_hash));
  EXPECT_THAT(nodes.substr(0, nodes.find('\n')),
              ::testing::EndsWith(std::string(" triangles, mesh ") + hash.data()));
  EXPECT_EQ(nodes.substr(0, nodes.find('\n')),
            text_of(write_ele, image).substr(0, nodes.find('\n')));
  back.mesh_hash = image.mesh_hash;
  EXPECT_EQ(text_of(write_node, back), nodes);
  EXPECT_EQ(text_of(write_ele, back), text_of(write_ele, image));
  EXPECT_EQ(text_of(write_edge, back), text_of(write_edge, image));
  EXPECT_EQ(text_of(write_poly, back), text_of(write_poly, image));
}

TEST(MeshImage, SaysInWhatUnitItIs) {
  const ScratchFolder folder;
  const ConstraintGraph graph =
      read_graph(folder.write("d.node", "3 2\n1 0 0\n2 0.5 0\n3 0 0.5\n"));
  const std::string text =
      text_of(write_node, image_of_graph(graph, {Decimal::parse("2e1"), false}));
  EXPECT_THAT(text, ::testing::HasSubstr("coordinates are 20 times those of the input"));
  EXPECT_THAT(text, ::testing::HasSubstr("\n2 10 0 0\n"));
}

TEST(MeshImage, ExistsForEveryNumberOfNodes) {
  const ScratchFolder folder;
  const char* const rows[] = {"", "1 0 0\n", "2 5 5\n", "3 10 10\n", "4 15 15\n", "5 0 9\n"};
  std::string body;
  for (int count = 0; count <= 5; ++count) {
    body += rows[count];
    const ConstraintGraph graph =
        read_graph(folder.write("n.node", std::to_string(count) + " 2\n" + body));
    const MeshImage image = image_of_graph(graph);
    EXPECT_EQ(image.triangles.size(), count == 5 ? 3u : 0u);
    EXPECT_EQ(image.edges.size(),
              count == 5 ? 7u : static_cast<std::size_t>(std::max(count - 1, 0)));
    FileSet files;
    add_mesh_files(image, folder.path("out"), files);
    files.commit();
    EXPECT_EQ(read_mesh(folder.path("out")).edges, image.edges);
  }
}

TEST(MeshImage, DoesNotDependOnTheHistory) {
  const ScratchFolder folder;
  const ConstraintGraph graph = read_graph(folder.write("plate.poly", plate));
  const GridGraph grid = place_on_grid(graph, {});
  inputs::OwnedMesh mesh({.vertices_max = 2000, .features_max = 2000});
  for (const Position& node : grid.nodes) {
    VertexId id;
    ASSERT_EQ(mesh->join(node, id), Status::ok);
  }
  for (const FeatureEnds& ends : grid.features) {
    FeatureId id;
    ASSERT_EQ(mesh->add_feature(ends, id), Status::ok);
  }
  ASSERT_EQ(mesh->rebuild(), Status::ok);
  MeshImage image = image_of(*mesh, Exterior::automatic, grid.holes);
  carry_through(graph, {}, image);
  const MeshImage built = image_of_graph(graph);
  EXPECT_EQ(text_of(write_node, image), text_of(write_node, built));
  EXPECT_EQ(text_of(write_ele, image), text_of(write_ele, built));
  EXPECT_EQ(text_of(write_edge, image), text_of(write_edge, built));
  EXPECT_EQ(text_of(write_poly, image), text_of(write_poly, built));
}

TEST(MeshReader, RefusesWhatIsOffTheGrid) {
  const ScratchFolder folder;
  folder.write("m.poly", "0\n0 1\n0\n");
  folder.write("m.ele", "0 3 0\n");
  folder.write("m.edge", "0 1\n");
  const auto accepts = [&](const char* x) {
    folder.write("m.node", std::string("1 2 0 1\n1 ") + x + " 0 0\n");
    try {
      (void)read_mesh(folder.path("m"));
      return true;
    } catch (const InputError&) {
      return false;
    }
  };
  EXPECT_TRUE(accepts("0.0000000037252902984619140625"));
  EXPECT_FALSE(accepts("0.0000000037252902984619140626"));
  EXPECT_FALSE(accepts("0.1"));
  EXPECT_FALSE(accepts("1e30"));
}

TEST(MeshReader, RefusesBrokenLists) {
  const ScratchFolder folder;
  folder.write("m.poly", "0\n0 1\n0\n");
  folder.write("m.node", "3 2 0 1\n1 0 0 0\n2 1 0 0\n3 0 1 0\n");
  const auto accepts = [&](const char* ele, const char* edge) {
    folder.write("m.ele", ele);
    folder.write("m.edge", edge);
    try {
      (void)read_mesh(folder.path("m"));
      return true;
    } catch (const InputError&) {
      return false;
    }
  };
  EXPECT_TRUE(accepts("1 3 0\n1 1 2 3\n", "1 1\n1 1 2 0\n"));
  EXPECT_FALSE(accepts("1 3 0\n1 1 2 4\n", "1 1\n1 1 2 0\n"));
  EXPECT_FALSE(accepts("1 6 0\n1 1 2 3\n", "1 1\n1 1 2 0\n"));
  EXPECT_FALSE(accepts("2 3 0\n1 1 2 3\n", "1 1\n1 1 2 0\n"));
  EXPECT_FALSE(accepts("1 3 0\n1 1 2 3\n1\n", "1 1\n1 1 2 0\n"));
  EXPECT_FALSE(accepts("1 3 0\n1 1 2 3\n", "2 1\n1 1 2 0\n2 1 2 0\n"));
  EXPECT_FALSE(accepts("1 3 0\n1 1 2 3\n", "1 0\n1 1 2\n"));
}

TEST(Exchange, CountsWhatItHolds) {
  const ScratchFolder folder;
  const ConstraintGraph graph = read_graph(folder.write("plate.poly", plate));
  const MeshImage image = image_of_graph(graph);
  const auto occurrences = [](const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
      ++count;
    }
    return count;
  };
  const std::string geojson = geojson_text(image);
  EXPECT_EQ(occurrences(geojson, "\"Polygon\""), image.triangles.size());
  EXPECT_EQ(occurrences(geojson, "\"LineString\""), image.subsegments.size());
  EXPECT_EQ(occurrences(geojson, "\"steiner\""), image.steiner_count());
  EXPECT_EQ(occurrences(geojson, "{"), occurrences(geojson, "}"));
  const std::string vtk = vtk_text(image);
  const std::size_t cells =
      image.triangles.size() + image.subsegments.size() + image.vertices.size();
  EXPECT_THAT(vtk, ::testing::HasSubstr("CELL_TYPES " + std::to_string(cells) + "\n"));
}

TEST(Exchange, TellsWhatIsKnownOfAVertex) {
  const ScratchFolder folder;
  MeshImage image = image_of_graph(read_graph(folder.write("plate.poly", plate)));
  image.value_names = {"serial", "a \"b\" \\ (°C)"};
  image.values = {{.vertex = 0, .name = 0, .nano = 7'000'000'000},
                  {.vertex = 0, .name = 1, .nano = -1'250'000'000},
                  {.vertex = 2, .name = 1, .nano = std::nullopt}};
  const std::string geojson = geojson_text(image);
  const std::string id = std::to_string(image.index_base);
  const std::string third = std::to_string(image.index_base + 2);
  EXPECT_THAT(geojson,
              ::testing::ContainsRegex("\"id\":" + id + ",\"marker\":[0-9]+,\"serial\":7,\"a "));
  EXPECT_THAT(geojson, ::testing::HasSubstr("\"serial\":7,\"a \\\"b\\\" \\\\ (°C)\":-1.25}}"));
  EXPECT_THAT(geojson, ::testing::ContainsRegex("\"id\":" + third + ",\"marker\":[0-9]+,\"a "));
  EXPECT_THAT(geojson, ::testing::HasSubstr("(°C)\":null}}"));
}

}  // namespace
}  // namespace etcm::files
