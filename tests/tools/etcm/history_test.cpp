#include "history.h"

#include <gtest/gtest.h>

#include <random>

#include "conformity.h"
#include "etcm/files/mesh_image.h"
#include "inputs/owned_mesh.h"

namespace etcm::cli {
namespace {

// After any history, what stands must be a mesh of what the history says there is.
TEST(History, AgreesWithTheMesh) {
  std::mt19937 random(11);
  const auto below = [&](int bound) {
    return static_cast<int>(random() % static_cast<unsigned>(bound));
  };
  for (int round = 0; round < 20; ++round) {
    const files::ConstraintGraph empty;
    inputs::OwnedMesh mesh({.vertices_max = 4000, .features_max = 1000});
    ASSERT_EQ(mesh.opened(), Status::ok);
    History history(*mesh, empty);
    // The tighter the square, the more nodes meet features and each other.
    const int side = round % 2 == 0 ? 12 : 1000;
    int applied = 0;
    for (int i = 0; i < 200; ++i) {
      Event event;
      event.kind = static_cast<EventKind>(below(5));
      event.id =
          event.kind == EventKind::join || event.kind == EventKind::feature ? i : below(i + 1);
      event.position = {below(side), below(side)};
      event.from = below(i + 1);
      event.to = below(i + 1);
      applied += history.apply(event) == Status::ok;
    }
    EXPECT_GT(applied, 20);
    files::ConstraintGraph graph = history.graph();
    files::MeshImage image = files::image_of(*mesh, Exterior::hull, {});
    files::carry_through(graph, {}, image);
    std::erase_if(graph.features, [](const auto& feature) { return feature.from == feature.to; });
    EXPECT_EQ(graph.features.size(), mesh->feature_count());
    const files::GridGraph grid = files::place_on_grid(graph, {});
    EXPECT_EQ(first_violation({graph, grid, image}).value_or(""), "");
    EXPECT_EQ(grid.nodes.size(), mesh->node_count());
  }
}

}  // namespace
}  // namespace etcm::cli
