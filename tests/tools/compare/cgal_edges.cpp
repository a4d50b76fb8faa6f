#include "cgal_edges.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_data_structure_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <utility>

namespace etcm::test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::size_t, Kernel>;
using Delaunay =
    CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex>>;

}  // namespace

std::vector<DelaunayEdge> cgal_delaunay_edges(std::span<const Point> points) {
  std::vector<std::pair<Kernel::Point_2, std::size_t>> numbered;
  for (std::size_t i = 0; i < points.size(); ++i) {
    numbered.emplace_back(
        Kernel::Point_2(static_cast<double>(points[i].x), static_cast<double>(points[i].y)), i);
  }
  Delaunay mesh(numbered.begin(), numbered.end());
  const auto index_of = [&mesh](Delaunay::Vertex_handle v) {
    return mesh.is_infinite(v) ? no_point : v->info();
  };
  std::vector<DelaunayEdge> edges;
  const bool is_flat = mesh.dimension() < 2;
  for (auto e = mesh.finite_edges_begin(); e != mesh.finite_edges_end(); ++e) {
    const auto [face, side] = *e;
    DelaunayEdge edge{0, 0, no_point, no_point};
    if (is_flat) {
      edge.from = face->vertex(0)->info();
      edge.to = face->vertex(1)->info();
    } else {
      edge.from = face->vertex(Delaunay::ccw(side))->info();
      edge.to = face->vertex(Delaunay::cw(side))->info();
      edge.apex = index_of(face->vertex(side));
      edge.other_apex = index_of(mesh.mirror_vertex(face, side));
    }
    edges.push_back(edge);
  }
  return edges;
}

}  // namespace etcm::test
