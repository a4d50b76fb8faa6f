#include "bench/cgal_peer.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_conformer_2.h>

#include <utility>
#include <vector>

namespace etcm::bench {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel>;
using Constrained = CGAL::Constrained_Delaunay_triangulation_2<Kernel>;

std::vector<Kernel::Point_2> points_of(std::span<const Position> nodes) {
  std::vector<Kernel::Point_2> points;
  points.reserve(nodes.size());
  for (const Position node : nodes) points.emplace_back(node.x, node.y);
  return points;
}

void build_conforming(const inputs::Graph& graph, Constrained& triangulation) {
  std::vector<std::pair<std::size_t, std::size_t>> constraints;
  constraints.reserve(graph.features.size());
  for (const FeatureEnds& feature : graph.features) {
    constraints.emplace_back(inputs::node_index_of(feature.from),
                             inputs::node_index_of(feature.to));
  }
  const std::vector<Kernel::Point_2> points = points_of(graph.nodes);
  triangulation.insert_constraints(points.begin(), points.end(), constraints.begin(),
                                   constraints.end());
  CGAL::make_conforming_Delaunay_2(triangulation);
}

}  // namespace

std::size_t cgal_delaunay(std::span<const Position> nodes) {
  const std::vector<Kernel::Point_2> points = points_of(nodes);
  Delaunay triangulation;
  triangulation.insert(points.begin(), points.end());
  return triangulation.number_of_vertices();
}

std::size_t cgal_conforming(const inputs::Graph& graph) {
  Constrained triangulation;
  build_conforming(graph, triangulation);
  return triangulation.number_of_vertices();
}

struct CgalMesh::Triangulation {
  Constrained constrained;
};

CgalMesh::CgalMesh(const inputs::Graph& graph) : triangulation_(std::make_unique<Triangulation>()) {
  build_conforming(graph, triangulation_->constrained);
}

CgalMesh::~CgalMesh() = default;

void CgalMesh::insert_and_conform(Position position) {
  triangulation_->constrained.insert(Kernel::Point_2(position.x, position.y));
  CGAL::make_conforming_Delaunay_2(triangulation_->constrained);
}

}  // namespace etcm::bench
