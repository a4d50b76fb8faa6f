// The edges of a mesh are those that CGAL finds between the same vertices, but for ties.
//
// ETCM_INPUTS in the environment is how many meshes, of thirteen families.
#include "cgal_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>

#include "etcm/traverse.h"
#include "support/emulated.h"
#include "support/exact.h"
#include "support/families.h"
#include "support/meshes.h"

namespace etcm::test {
namespace {

using IndexPair = std::pair<std::size_t, std::size_t>;
using EdgeTable = std::map<IndexPair, DelaunayEdge>;

IndexPair pair_of(const DelaunayEdge& edge) {
  return {std::min(edge.from, edge.to), std::max(edge.from, edge.to)};
}

// A mesh as CGAL's are told, with the index of each vertex among those in use.
class EdgesOfMesh {
 public:
  explicit EdgesOfMesh(const Mesh& mesh) {
    for (IdValue i = 1; i < mesh.vertex_id_end(); ++i) {
      if (mesh.kind(VertexId{i}) == VertexKind::none) continue;
      index_[VertexId{i}] = points_.size();
      points_.push_back(mesh.point(VertexId{i}));
    }
    for (const MeshEdge& edge : edges_of(mesh)) {
      add({index_.at(edge.from), index_.at(edge.to), no_point, no_point});
    }
    for (IdValue t = 0; t < mesh.triangle_count(); ++t) {
      const Triangle triangle = mesh.triangle(TriangleId{t});
      if (!triangle.is_ghost()) add_apexes(triangle);
    }
  }

  const std::vector<Point>& points() const { return points_; }
  const EdgeTable& edges() const { return edges_; }

 private:
  void add(const DelaunayEdge& edge) { edges_[pair_of(edge)] = edge; }

  void add_apexes(const Triangle& triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      const DelaunayEdge side{index_.at(triangle.corner[(k + 1) % 3]),
                              index_.at(triangle.corner[(k + 2) % 3]), no_point, no_point};
      DelaunayEdge& edge = edges_.at(pair_of(side));
      (edge.apex == no_point ? edge.apex : edge.other_apex) = index_.at(triangle.corner[k]);
    }
  }

  std::map<VertexId, std::size_t> index_;
  std::vector<Point> points_;
  EdgeTable edges_;
};

// Whether another diagonal would do as well.
bool is_tie(const DelaunayEdge& edge, const std::vector<Point>& points) {
  if (edge.apex == no_point || edge.other_apex == no_point) return false;
  return exact_incircle(points[edge.from], points[edge.to], points[edge.apex],
                        points[edge.other_apex]) == 0;
}

std::size_t inputs_wanted() {
  const char* const wanted = std::getenv("ETCM_INPUTS");
  return wanted != nullptr ? std::stoul(wanted) : (is_emulated ? 30 : 300);
}

TEST(CgalEdges, AreThoseOfTheMeshButForTies) {
  std::size_t compared = 0, ties = 0;
  for (std::uint64_t seed = 1; seed <= inputs_wanted(); ++seed) {
    inputs::Random random(seed);
    const Graph graph = graph_of_some_family(random);
    const auto mesh = built(graph, seed % 4 == 0 ? split_paper : split_default, 8000);
    const EdgesOfMesh ours(**mesh);
    EdgeTable theirs;
    for (const DelaunayEdge& edge : cgal_delaunay_edges(ours.points())) {
      theirs[pair_of(edge)] = edge;
    }
    ASSERT_EQ(theirs.size(), ours.edges().size()) << "seed " << seed << ", " << graph.name;
    for (const auto& [pair, edge] : ours.edges()) {
      if (theirs.contains(pair)) continue;
      ASSERT_TRUE(is_tie(edge, ours.points())) << "seed " << seed << ", " << graph.name;
      ++ties;
    }
    for (const auto& [pair, edge] : theirs) {
      if (ours.edges().contains(pair)) continue;
      ASSERT_TRUE(is_tie(edge, ours.points())) << "seed " << seed << ", " << graph.name;
    }
    compared += theirs.size();
  }
  RecordProperty("edges", std::to_string(compared));
  RecordProperty("ties", std::to_string(ties));
  EXPECT_GT(compared, 100 * inputs_wanted());
}

}  // namespace
}  // namespace etcm::test
