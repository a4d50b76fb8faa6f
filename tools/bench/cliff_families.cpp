#include "bench/cliff_families.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <stdexcept>
#include <string>
#include <vector>

#include "inputs/direction.h"
#include "inputs/graph.h"
#include "inputs/owned_mesh.h"
#include "inputs/random.h"
#include "inputs/random_graph.h"

namespace etcm::bench {
namespace {

using inputs::between_nodes;
using inputs::Graph;
using inputs::OwnedMesh;
using inputs::vertex_of;

constexpr std::int32_t far_away = position_max;
constexpr std::int32_t ring_radius = position_max - 1;

void expect(Status status, Status wanted = Status::ok) {
  if (status != wanted) throw std::runtime_error(to_string(status));
}

// Of the processor, so that others on the machine do not show.
template <class Operation>
double seconds_of(const Operation& operation) {
  const std::clock_t start = std::clock();
  operation();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

std::int32_t to_coordinate(std::size_t i) { return static_cast<std::int32_t>(i); }

// The hub is the first node.
Graph ring(std::size_t count) {
  Graph graph{"ring", {{0, 0}}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const auto angle =
        static_cast<std::int32_t>(std::uint64_t{inputs::full_turn_millidegrees} * i / count);
    graph.nodes.push_back(inputs::at_angle({0, 0}, angle, ring_radius));
  }
  return graph;
}

// The hub stands beside a line of nodes.
Graph line(std::size_t count) {
  Graph graph{"line", {{to_coordinate(count / 2), far_away}}, {}};
  for (std::size_t i = 0; i < count; ++i) graph.nodes.push_back({to_coordinate(i), 0});
  return graph;
}

Graph star(std::size_t count) {
  Graph graph = ring(count);
  for (std::size_t i = 1; i <= count; ++i) graph.features.push_back(between_nodes(0, i));
  return graph;
}

// Nodes on a square grid in the order of rows.
Graph grid(std::size_t count) {
  Graph graph{"grid", {}, {}};
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)));
  for (std::size_t i = 0; i < side * side; ++i) {
    graph.nodes.push_back({to_coordinate(100 * (i % side)), to_coordinate(100 * (i / side))});
  }
  return graph;
}

// One feature along a line, through all nodes but its ends.
Graph long_feature(std::size_t count) {
  Graph graph{"feature", {}, {}};
  for (std::size_t i = 0; i < count; ++i) graph.nodes.push_back({to_coordinate(100 * i), 0});
  graph.features.push_back(between_nodes(0, count - 1));
  return graph;
}

// And two nodes beside each part of it, so that each needs a Steiner vertex.
Graph beset_feature(std::size_t count) {
  Graph graph = long_feature(count);
  for (std::size_t i = 1; i < count; ++i) {
    const std::int32_t x = to_coordinate(100 * i - 50);
    graph.nodes.push_back({x, 3});
    graph.nodes.push_back({x + 1, -3});
  }
  return graph;
}

Graph parallels(std::size_t count) {
  Graph graph{"parallels", {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t y = to_coordinate(100 * i);
    graph.nodes.push_back({0, y});
    graph.nodes.push_back({far_away, y});
    graph.features.push_back(between_nodes(2 * i, 2 * i + 1));
  }
  return graph;
}

// A cluster, and the first node far away from it.
Graph cluster(std::size_t count) {
  Graph graph = inputs::random_nodes(count, 1);
  graph.nodes.insert(graph.nodes.begin(), {-far_away, -far_away});
  return graph;
}

struct Built {
  explicit Built(const Graph& graph, std::size_t room = 0) : mesh(inputs::config_for(graph, room)) {
    expect(mesh->build(graph.nodes, graph.features));
  }
  OwnedMesh mesh;
};

double build_seconds(const Graph& graph, std::size_t room = 0) {
  OwnedMesh mesh(inputs::config_for(graph, room));
  return seconds_of([&] { expect(mesh->build(graph.nodes, graph.features)); });
}

double restore_seconds(const Graph& graph, std::size_t room) {
  Built built(graph, room);
  std::vector<SteinerPlace> steiner;
  for (IdValue i = 1; i < built.mesh->vertex_id_end(); ++i) {
    const VertexId v{i};
    if (built.mesh->kind(v) == VertexKind::steiner) {
      steiner.push_back({built.mesh->feature_of(v).value, built.mesh->point(v)});
    }
  }
  OwnedMesh mesh(inputs::config_for(graph, room));
  return seconds_of([&] { expect(mesh->restore(graph.nodes, graph.features, steiner)); });
}

double first_leaves(const Graph& graph) {
  Built built(graph);
  return seconds_of([&] { expect(built.mesh->leave(vertex_of(0))); });
}

double ring_hub_leaves(std::size_t n) { return first_leaves(ring(n)); }
double line_hub_leaves(std::size_t n) { return first_leaves(line(n)); }

// A feature runs through the hub. Without it one Steiner vertex is needed, and there is no room.
double hub_stays(std::size_t n) {
  Graph graph = ring(n);
  graph.nodes.push_back({far_away / 2, 0});
  graph.nodes.push_back({-far_away / 2, 0});
  graph.features.push_back(between_nodes(1 + n / 4, 1 + 3 * n / 4));
  Built built(graph);
  return seconds_of([&] { expect(built.mesh->leave(vertex_of(0)), Status::out_of_vertices); });
}

double grid_leaves(std::size_t n) {
  const Graph graph = grid(n);
  Built built(graph);
  return seconds_of([&] {
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) expect(built.mesh->leave(vertex_of(i)));
  });
}

double feature_builds(std::size_t n) { return build_seconds(beset_feature(n), 4 * n); }
double feature_restores(std::size_t n) { return restore_seconds(beset_feature(n), 4 * n); }

double feature_goes_and_comes(std::size_t n) {
  Built built(beset_feature(n), 4 * n);
  FeatureId id{0};
  return seconds_of([&] {
    const FeatureEnds ends = built.mesh->ends(id);
    expect(built.mesh->remove_feature(id));
    expect(built.mesh->add_feature(ends, id));
  });
}

double feature_nodes_leave(std::size_t n) {
  Built built(long_feature(n));
  return seconds_of([&] {
    for (std::size_t i = 1; i + 1 < n; ++i) expect(built.mesh->leave(vertex_of(i)));
  });
}

// Off the line and back.
double feature_nodes_move(std::size_t n) {
  const Graph graph = beset_feature(n);
  Built built(graph, 4 * n);
  return seconds_of([&] {
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const Position place = graph.nodes[i];
      expect(built.mesh->move(vertex_of(i), {place.x, place.y + 1}));
      expect(built.mesh->move(vertex_of(i), place));
    }
  });
}

double star_builds(std::size_t n) { return build_seconds(star(n), 4 * n); }

double star_restores(std::size_t n) { return restore_seconds(star(n), 4 * n); }

double star_goes(std::size_t n) {
  Built built(star(n), 4 * n);
  return seconds_of([&] {
    for (std::size_t i = 0; i < n; ++i) {
      expect(built.mesh->remove_feature(FeatureId{static_cast<IdValue>(i)}));
    }
  });
}

double star_comes(std::size_t n) {
  const Graph graph = star(n);
  OwnedMesh mesh(inputs::config_for(graph, 4 * n));
  expect(mesh->build(graph.nodes, {}));
  return seconds_of([&] {
    FeatureId id;
    for (const FeatureEnds& ends : graph.features) expect(mesh->add_feature(ends, id));
  });
}

double star_moves(std::size_t n) {
  Built built(star(n), 4 * n);
  return seconds_of([&] { expect(built.mesh->move(vertex_of(0), {1, 1})); });
}

double cluster_builds(std::size_t n) { return build_seconds(cluster(n)); }

double joins_seconds(OwnedMesh& mesh, std::size_t n) {
  inputs::Random random(2);
  const std::int32_t side = inputs::random_graph_side(n);
  return seconds_of([&] {
    for (std::size_t i = 0; i < n; ++i) {
      VertexId id;
      const std::int32_t x = random.between(0, side);
      (void)mesh->join({x, random.between(0, side)}, id);
    }
  });
}

double even_joins(std::size_t n) {
  Built built(inputs::random_nodes(n, 1), n);
  return joins_seconds(built.mesh, n);
}

double cluster_joins(std::size_t n) {
  Built built(cluster(n), n);
  return joins_seconds(built.mesh, n);
}

double cluster_joins_after(std::size_t n) {
  Built built(cluster(n), n);
  expect(built.mesh->leave(vertex_of(0)));
  return joins_seconds(built.mesh, n);
}

constexpr int few_changes = 100;

double node_wanders(std::size_t n) {
  Built built(cluster(n));
  return seconds_of([&] {
    for (int i = 0; i < few_changes; ++i) {
      expect(built.mesh->move(vertex_of(0), {i % 2 == 0 ? far_away : -far_away, 0}));
    }
  });
}

double parallels_are_joined(std::size_t n) {
  Built built(parallels(n), 4 * n);
  inputs::Random random(3);
  return seconds_of([&] {
    for (int i = 0; i < few_changes; ++i) {
      VertexId id;
      const std::int32_t x = random.between(1, far_away - 1);
      (void)built.mesh->join({x, random.between(0, to_coordinate(100 * n - 100))}, id);
    }
  });
}

double parallels_build(std::size_t n) { return build_seconds(parallels(n), 4 * n); }

constexpr CliffFamily families[] = {
    {"a hub in a ring of n leaves", 4000, ring_hub_leaves},
    {"a hub beside a line of n leaves", 4000, line_hub_leaves},
    {"a hub of n/3 neighbours cannot leave", 4000, hub_stays},
    {"n nodes of a grid leave by rows", 4000, grid_leaves},
    {"a feature through n nodes: build", 4000, feature_builds},
    {"the same: restore", 4000, feature_restores},
    {"the same: goes and comes back", 4000, feature_goes_and_comes},
    {"the same: its nodes leave", 2000, feature_nodes_leave},
    {"the same: its nodes move off and back", 2000, feature_nodes_move},
    {"n features at a node: build", 2000, star_builds},
    {"the same: restore", 2000, star_restores},
    {"the same: one by one they come", 2000, star_comes},
    {"the same: one by one they go", 2000, star_goes},
    {"the same: the node moves", 2000, star_moves},
    {"n nodes, n more join", 37'500, even_joins},
    {"n nodes in a cluster, one far away: build", 37'500, cluster_builds},
    {"the same: n more join", 37'500, cluster_joins},
    {"the same: n more join when the one has left", 37'500, cluster_joins_after},
    {"the same: the one moves 100 times, far to far", 37'500, node_wanders},
    {"n parallels: build", 2000, parallels_build},
    {"the same: 100 nodes join between them", 2000, parallels_are_joined},
};

}  // namespace

std::span<const CliffFamily> cliff_families() { return families; }

}  // namespace etcm::bench
