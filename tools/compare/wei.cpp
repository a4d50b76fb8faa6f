// Wei, Xiao, Zhou: always from the end that the user gave first, as far as its circle reaches. What
// they need and a split site does not have is that direction; the mesh that the site shows knows
// the feature, and the feature its ends.
#include "compare/rival.h"
#include "compare/system.h"

namespace etcm::compare {
namespace {

using namespace internal;

VertexId corner_at(const Mesh& mesh, TriangleId triangle, const Point& point) noexcept {
  for (const VertexId v : mesh.triangle(triangle).corner) {
    if (v != infinite_vertex && mesh.point(v) == point) return v;
  }
  return VertexId::none();
}

bool is_given_backwards(const SplitSite& site) noexcept {
  const Mesh& mesh = *site.mesh;
  const VertexId head = corner_at(mesh, site.head_triangle, site.at(site.head));
  const VertexId tail = corner_at(mesh, site.tail_triangle, site.at(site.tail));
  const MeshState& m = state_of(mesh);
  const FeatureEnds ends = mesh.ends(feature_of(m, section_of_edge(m, head, tail)));
  return mesh.point(ends.to) < mesh.point(ends.from);
}

Parameter split_wei(const SplitSite& site) noexcept {
  const Parameter reach = is_given_backwards(site) ? site.reach_tail : site.reach_head;
  // Where the circle reaches nothing or everything, the grid leaves no first end to finish.
  return reach > site.head && reach < site.tail ? reach : split_middle(site);
}

}  // namespace

Attempt run_wei(const inputs::Graph& graph, Depth depth) {
  return run_rival(graph, {.policy = split_wei}, depth);
}

}  // namespace etcm::compare
