#include "bench/cliff_families.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/cliff_graphs.h"
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

void expect(Status status, Status wanted = Status::ok) {
  if (status != wanted) throw std::runtime_error(to_string(status));
}

// The calls of one mesh: what they answer, and the work that they take, also what no limit knows
// of.
class Calls {
 public:
  explicit Calls(Mesh& mesh) : mesh_(mesh) {
    mesh.keep_alive({[](void* units) noexcept {
                       *static_cast<std::uint64_t*>(units) += KeepAlive::units_between;
                     },
                     &units_});
  }
  Calls(const Calls&) = delete;
  Calls& operator=(const Calls&) = delete;
  ~Calls() { mesh_.keep_alive({}); }

  void expect(Status status, Status wanted = Status::ok) {
    count(status);
    bench::expect(status, wanted);
  }
  // Whatever it answered.
  void count([[maybe_unused]] Status status) { units_ += mesh_.work_used().units; }

  std::uint64_t units() const { return units_; }

 private:
  Mesh& mesh_;
  std::uint64_t units_ = 0;
};

// Time is that of the processor, so that others on the machine do not show.
template <class Operation>
Cost cost_of(Mesh& mesh, const Operation& operation) {
  Calls calls(mesh);
  const std::clock_t start = std::clock();
  operation(calls);
  return {static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, calls.units()};
}

struct Built {
  explicit Built(const Graph& graph, std::size_t room = 0) : mesh(inputs::config_for(graph, room)) {
    expect(mesh->build(graph.nodes, graph.features));
  }
  OwnedMesh mesh;
};

Cost build_cost(const Graph& graph, std::size_t room = 0) {
  OwnedMesh mesh(inputs::config_for(graph, room));
  return cost_of(*mesh,
                 [&](Calls& calls) { calls.expect(mesh->build(graph.nodes, graph.features)); });
}

Cost restore_cost(const Graph& graph, std::size_t room) {
  Built built(graph, room);
  std::vector<SteinerPlace> steiner;
  for (IdValue i = 1; i < built.mesh->vertex_id_end(); ++i) {
    const VertexId v{i};
    if (built.mesh->kind(v) == VertexKind::steiner) {
      steiner.push_back({built.mesh->feature_of(v).value, built.mesh->point(v)});
    }
  }
  OwnedMesh mesh(inputs::config_for(graph, room));
  return cost_of(*mesh, [&](Calls& calls) {
    calls.expect(mesh->restore(graph.nodes, graph.features, steiner));
  });
}

Cost first_leaves(const Graph& graph) {
  Built built(graph);
  return cost_of(*built.mesh, [&](Calls& calls) { calls.expect(built.mesh->leave(vertex_of(0))); });
}

Cost ring_hub_leaves(std::size_t n) { return first_leaves(ring(n)); }
Cost line_hub_leaves(std::size_t n) { return first_leaves(line(n)); }

// A feature runs through the hub. Without it one Steiner vertex is needed, and there is no room.
Cost hub_stays(std::size_t n) {
  Graph graph = ring(n);
  graph.nodes.push_back({far_away / 2, 0});
  graph.nodes.push_back({-far_away / 2, 0});
  graph.features.push_back(between_nodes(1 + n / 4, 1 + 3 * n / 4));
  Built built(graph);
  return cost_of(*built.mesh, [&](Calls& calls) {
    calls.expect(built.mesh->leave(vertex_of(0)), Status::out_of_vertices);
  });
}

Cost grid_leaves(std::size_t n) {
  const Graph graph = grid(n);
  Built built(graph);
  return cost_of(*built.mesh, [&](Calls& calls) {
    for (std::size_t i = 0; i < graph.nodes.size(); ++i)
      calls.expect(built.mesh->leave(vertex_of(i)));
  });
}

Cost feature_builds(std::size_t n) { return build_cost(beset_feature(n), 4 * n); }
Cost feature_restores(std::size_t n) { return restore_cost(beset_feature(n), 4 * n); }

Cost feature_goes_and_comes(std::size_t n) {
  Built built(beset_feature(n), 4 * n);
  FeatureId id{0};
  return cost_of(*built.mesh, [&](Calls& calls) {
    const FeatureEnds ends = built.mesh->ends(id);
    calls.expect(built.mesh->remove_feature(id));
    calls.expect(built.mesh->add_feature(ends, id));
  });
}

Cost feature_nodes_leave(std::size_t n) {
  Built built(long_feature(n));
  return cost_of(*built.mesh, [&](Calls& calls) {
    for (std::size_t i = 1; i + 1 < n; ++i) calls.expect(built.mesh->leave(vertex_of(i)));
  });
}

// Off the line and back.
Cost feature_nodes_move(std::size_t n) {
  const Graph graph = beset_feature(n);
  Built built(graph, 4 * n);
  return cost_of(*built.mesh, [&](Calls& calls) {
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const Position place = graph.nodes[i];
      calls.expect(built.mesh->move(vertex_of(i), {place.x, place.y + 1}));
      calls.expect(built.mesh->move(vertex_of(i), place));
    }
  });
}

Cost star_builds(std::size_t n) { return build_cost(star(n), 4 * n); }

Cost star_restores(std::size_t n) { return restore_cost(star(n), 4 * n); }

Cost star_goes(std::size_t n) {
  Built built(star(n), 4 * n);
  return cost_of(*built.mesh, [&](Calls& calls) {
    for (std::size_t i = 0; i < n; ++i) {
      calls.expect(built.mesh->remove_feature(FeatureId{static_cast<IdValue>(i)}));
    }
  });
}

Cost star_comes(std::size_t n) {
  const Graph graph = star(n);
  OwnedMesh mesh(inputs::config_for(graph, 4 * n));
  expect(mesh->build(graph.nodes, {}));
  return cost_of(*mesh, [&](Calls& calls) {
    FeatureId id;
    for (const FeatureEnds& ends : graph.features) calls.expect(mesh->add_feature(ends, id));
  });
}

Cost star_moves(std::size_t n) {
  Built built(star(n), 4 * n);
  return cost_of(*built.mesh, [&](Calls& calls) {
    calls.expect(built.mesh->move(vertex_of(0), {1, 1}));
  });
}

Cost cluster_builds(std::size_t n) { return build_cost(cluster(n)); }

Cost joins_cost(OwnedMesh& mesh, std::size_t n) {
  inputs::Random random(2);
  const std::int32_t side = inputs::random_graph_side(n);
  return cost_of(*mesh, [&](Calls& calls) {
    for (std::size_t i = 0; i < n; ++i) {
      VertexId id;
      const std::int32_t x = random.between(0, side);
      calls.count(mesh->join({x, random.between(0, side)}, id));
    }
  });
}

Cost even_joins(std::size_t n) {
  Built built(inputs::random_nodes(n, 1), n);
  return joins_cost(built.mesh, n);
}

Cost cluster_joins(std::size_t n) {
  Built built(cluster(n), n);
  return joins_cost(built.mesh, n);
}

Cost cluster_joins_after(std::size_t n) {
  Built built(cluster(n), n);
  expect(built.mesh->leave(vertex_of(0)));
  return joins_cost(built.mesh, n);
}

constexpr int few_changes = 100;

Cost node_wanders(std::size_t n) {
  Built built(cluster(n));
  return cost_of(*built.mesh, [&](Calls& calls) {
    for (int i = 0; i < few_changes; ++i) {
      calls.expect(built.mesh->move(vertex_of(0), {i % 2 == 0 ? far_away : -far_away, 0}));
    }
  });
}

Cost parallels_are_joined(std::size_t n) {
  Built built(parallels(n), 4 * n);
  inputs::Random random(3);
  return cost_of(*built.mesh, [&](Calls& calls) {
    for (int i = 0; i < few_changes; ++i) {
      VertexId id;
      const std::int32_t x = random.between(1, far_away - 1);
      calls.count(
          built.mesh->join({x, random.between(0, static_cast<std::int32_t>(100 * n - 100))}, id));
    }
  });
}

Cost parallels_build(std::size_t n) { return build_cost(parallels(n), 4 * n); }

Cost even_builds(std::size_t n) { return build_cost(even(n), n); }

Cost even_loads(std::size_t n) {
  Built built(even(n), n);
  std::vector<std::byte> saved(built.mesh->saved_bytes());
  expect(built.mesh->save(saved));
  OwnedMesh mesh(built.mesh->config());
  return cost_of(*mesh, [&](Calls& calls) { calls.expect(mesh->load(saved)); });
}

Cost even_is_made_canonical(std::size_t n) {
  Built built(even(n), n);
  inputs::Random random(4);
  const std::int32_t side = inputs::random_graph_side(n);
  return cost_of(*built.mesh, [&](Calls& calls) {
    for (int i = 0; i < few_changes; ++i) {
      VertexId id;
      const std::int32_t x = random.between(0, side);
      calls.count(built.mesh->join({x, random.between(0, side)}, id));
      calls.expect(built.mesh->canonicalize());
    }
  });
}

Cost circles_build(std::size_t n) { return build_cost(circles(n)); }

Cost circles_leave(std::size_t n) {
  const Graph graph = circles(n);
  Built built(graph);
  return cost_of(*built.mesh, [&](Calls& calls) {
    for (std::size_t i = 0; i < n; ++i) calls.expect(built.mesh->leave(vertex_of(i)));
  });
}

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
    {"the same: 100 nodes join between them", 1000, parallels_are_joined},
    {"n nodes, short features: build", 8000, even_builds},
    {"the same: load", 8000, even_loads},
    {"the same: 100 joins, canonical after each", 64'000, even_is_made_canonical},
    {"n nodes on circles of 324: build", 8000, circles_build},
    {"the same: all leave", 8000, circles_leave},
};

}  // namespace

std::span<const CliffFamily> cliff_families() { return families; }

Growth growth_of(const CliffFamily& family) {
  const std::uint64_t units = family.cost(family.size_min).units;
  const std::uint64_t before = family.cost(family.size_min / 4).units;
  const double ratio = static_cast<double>(units) / static_cast<double>(before);
  return {units, std::log2(ratio) / 2};
}

}  // namespace etcm::bench
