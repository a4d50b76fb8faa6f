#include "firmware/config/site_poly.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "etcm/domain.h"
#include "etcm/files/constraint_graph.h"
#include "etcm/files/error.h"
#include "etcm/files/grid.h"
#include "etcm/mesh.h"
#include "firmware/config/site.h"

namespace etcm::firmware {

namespace {

using files::ConstraintGraph;
using files::InputError;

void add_by_serial(const ConstraintGraph& graph, Settings& settings) {
  if (!graph.holes.empty()) {
    throw InputError(graph.poly_file, graph.holes.front().line_number,
                     "holes need fixed points, but the node numbers of this file are serials; set "
                     "nodes = \"anchors\" in [site], or take the holes out");
  }
  for (const files::GraphFeature& feature : graph.features) {
    settings.features.push_back(
        {.from = Serial{static_cast<std::uint32_t>(graph.node_number(feature.from))},
         .to = Serial{static_cast<std::uint32_t>(graph.node_number(feature.to))},
         .name = {},
         .source = graph.poly_file + ":" + std::to_string(feature.line_number)});
  }
}

// The vertex after `to` and the Steiner vertices behind it, on the way from `from`.
VertexId next_node(const Mesh& mesh, VertexId from, VertexId to) {
  if (mesh.kind(to) == VertexKind::node) return to;
  const FeatureId feature = mesh.feature_of(to);
  std::vector<VertexId> chain(mesh.chain(feature, {}));
  chain.resize(mesh.chain(feature, chain));
  auto at = std::find(chain.begin(), chain.end(), to);
  const bool is_forward = *std::prev(at) == from;
  while (mesh.kind(*at) != VertexKind::node) at = is_forward ? std::next(at) : std::prev(at);
  return *at;
}

// Where triangles of a kind meet others, from node to node. The ghosts are of no kind.
template <class IsOfKind>
std::vector<DomainEdge> border(const Mesh& mesh, const IsOfKind& is_of_kind) {
  std::vector<DomainEdge> edges;
  for (std::uint32_t id = 0; id < mesh.triangle_count(); ++id) {
    if (!is_of_kind(id)) continue;
    const Triangle triangle = mesh.triangle(TriangleId{static_cast<IdValue>(id)});
    for (std::size_t side = 0; side < 3; ++side) {
      if (is_of_kind(triangle.neighbour[side].value)) continue;
      const VertexId from = triangle.corner[(side + 1) % 3], to = triangle.corner[(side + 2) % 3];
      if (mesh.kind(from) != VertexKind::node) continue;
      edges.push_back({.from = mesh.point(from), .to = mesh.point(next_node(mesh, from, to))});
    }
  }
  return edges;
}

// The domain of the graph alone, as Triangle has it: by the mesh of its nodes and segments.
SiteDomain domain_of(const ConstraintGraph& graph, const files::GridGraph& grid,
                     const std::vector<Point>& holes, const MeshConfig& config) {
  std::vector<std::byte> memory(storage_bytes(config));
  Mesh mesh;
  Status status = mesh.open(memory, config);
  if (status == Status::ok) status = mesh.build(grid.nodes, grid.features);
  if (status != Status::ok) {
    throw InputError(files::describe_refusal(graph, grid, mesh.error_detail()));
  }
  const std::size_t count = mesh.triangle_count();
  std::vector<Region> closed(count);
  std::vector<Region> regions(count);
  std::vector<TriangleId> scratch(count);
  status = label_domain(mesh, Exterior::features, holes, closed, scratch);
  if (status == Status::ok) {
    status = label_domain(mesh, Exterior::automatic, holes, regions, scratch);
  }
  if (status != Status::ok) throw InputError(graph.poly_file, 0, explain(status));

  const auto is_hole = [&](std::uint32_t id) { return regions[id] == Region::hole; };
  // Where closed segments do not hold all nodes, they bound nothing.
  if (regions != closed) return {{}, border(mesh, is_hole)};
  const auto is_within = [&](std::uint32_t id) { return regions[id] != Region::outside; };
  return {border(mesh, is_within), border(mesh, is_hole)};
}

void add_by_place(const ConstraintGraph& graph, Settings& settings) {
  const SiteGrid site_grid(settings.site);
  files::GridGraph grid;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const files::GraphNode& node = graph.nodes[i];
    grid.nodes.push_back(site_grid.place(node.line_number, "", node.x, node.y));
    settings.anchors.push_back(
        {.position = grid.nodes.back(),
         .source = graph.node_file + ":" + std::to_string(node.line_number)});
  }
  for (const files::GraphFeature& feature : graph.features) {
    grid.features.push_back({VertexId(static_cast<IdValue>(feature.from + 1)),
                             VertexId(static_cast<IdValue>(feature.to + 1))});
    settings.features.push_back(
        {.from = FeatureEnd::anchor(grid.nodes[feature.from]),
         .to = FeatureEnd::anchor(grid.nodes[feature.to]),
         .name = {},
         .source = graph.poly_file + ":" + std::to_string(feature.line_number)});
  }
  std::vector<Point> holes;
  for (const files::GraphHole& hole : graph.holes) holes.push_back(site_grid.near(hole.x, hole.y));
  settings.domain = domain_of(graph, grid, holes, settings.mesh);
}

}  // namespace

void read_site_poly(Settings& settings) {
  const ConstraintGraph graph = files::read_graph(settings.site.path);
  if (settings.site.poly_nodes == PolyNodes::serials) {
    add_by_serial(graph, settings);
  } else {
    add_by_place(graph, settings);
  }
}

}  // namespace etcm::firmware
