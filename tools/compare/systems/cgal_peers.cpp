// CGAL's conforming and constrained Delaunay triangulations, kernel EPICK: the outside view. The
// one file that CGAL's headers and flags reach.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_conformer_2.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "compare/systems/stopwatch.h"
#include "compare/systems/system.h"
#include "inputs/random.h"

namespace etcm::compare {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel>;
using Vertex = Triangulation::Vertex_handle;
using CgalPoint = Kernel::Point_2;

std::vector<CgalPoint> places_of(std::span<const Position> nodes) {
  std::vector<CgalPoint> places;
  places.reserve(nodes.size());
  for (const Position node : nodes) places.emplace_back(node.x, node.y);
  return places;
}

// By index of the node.
std::vector<Vertex> vertices_of(const Triangulation& mesh, const std::vector<CgalPoint>& places) {
  std::map<CgalPoint, Vertex> by_place;
  for (const Vertex v : mesh.finite_vertex_handles()) by_place.emplace(v->point(), v);
  std::vector<Vertex> vertices;
  vertices.reserve(places.size());
  for (const CgalPoint& place : places) vertices.push_back(by_place.at(place));
  return vertices;
}

bool is_delaunay(const Triangulation& mesh) {
  return std::all_of(mesh.finite_edges_begin(), mesh.finite_edges_end(), [&](const auto& edge) {
    const auto face = edge.first;
    const auto beyond = face->neighbor(edge.second);
    if (mesh.is_infinite(face) || mesh.is_infinite(beyond)) return true;
    const Vertex apex = beyond->vertex(beyond->index(face));
    return mesh.side_of_oriented_circle(face, apex->point()) != CGAL::ON_POSITIVE_SIDE;
  });
}

// The next vertex on the way to the end of a feature along constrained edges; null where there is
// none. CGAL rounds the points that it adds, so "on the way" allows for a billionth of the length.
Vertex step_towards(const Triangulation& mesh, Vertex from, Vertex end) {
  const auto way = end->point() - from->point();
  Triangulation::Edge_circulator edge = mesh.incident_edges(from);
  const Triangulation::Edge_circulator first = edge;
  do {
    if (mesh.is_infinite(edge) || !mesh.is_constrained(*edge)) continue;
    const Vertex a = edge->first->vertex(Triangulation::cw(edge->second));
    const Vertex b = edge->first->vertex(Triangulation::ccw(edge->second));
    const Vertex next = a == from ? b : a;
    const auto step = next->point() - from->point();
    const double off = std::abs(way.x() * step.y() - way.y() * step.x());
    if (way * step > 0 && off <= 1e-9 * way.squared_length()) return next;
  } while (++edge != first);
  return {};
}

bool has_features(const Triangulation& mesh, const inputs::Graph& graph,
                  const std::vector<Vertex>& nodes) {
  return std::all_of(graph.features.begin(), graph.features.end(), [&](const FeatureEnds& ends) {
    const Vertex end = nodes[inputs::node_index_of(ends.to)];
    Vertex at = nodes[inputs::node_index_of(ends.from)];
    while (at != Vertex() && at != end) at = step_towards(mesh, at, end);
    return at == end;
  });
}

std::uint64_t mix(std::uint64_t value) { return inputs::Random(value).next(); }

std::uint64_t hash_of(const Triangulation& mesh) {
  std::uint64_t sum = 0;
  for (const auto face : mesh.finite_face_handles()) {
    std::array<CgalPoint, 3> corners{face->vertex(0)->point(), face->vertex(1)->point(),
                                     face->vertex(2)->point()};
    std::sort(corners.begin(), corners.end());
    std::uint64_t triangle = 0;
    for (const CgalPoint& corner : corners) {
      triangle = mix(triangle ^ std::bit_cast<std::uint64_t>(corner.x()));
      triangle = mix(triangle ^ std::bit_cast<std::uint64_t>(corner.y()));
    }
    sum += triangle;
  }
  return sum;
}

// Rounded to our grid, which is finer than any picture or mean shows.
Point on_grid(const CgalPoint& place) {
  return {std::llround(std::ldexp(place.x(), subunit_bits)),
          std::llround(std::ldexp(place.y(), subunit_bits))};
}

files::MeshImage image_of(const Triangulation& mesh, const inputs::Graph& graph,
                          const std::vector<Vertex>& nodes) {
  files::MeshImage image;
  image.node_count = static_cast<std::uint32_t>(nodes.size());
  image.feature_count = static_cast<std::uint32_t>(graph.features.size());
  std::map<Vertex, std::uint32_t> indices;
  const auto add = [&](Vertex v) {
    if (!indices.emplace(v, static_cast<std::uint32_t>(image.vertices.size())).second) return;
    image.vertices.push_back(
        {.point = on_grid(v->point()), .is_steiner = image.vertices.size() >= nodes.size()});
  };
  for (const Vertex v : nodes) add(v);
  for (const Vertex v : mesh.finite_vertex_handles()) add(v);
  for (const auto face : mesh.finite_face_handles()) {
    image.triangles.push_back(
        {indices.at(face->vertex(0)), indices.at(face->vertex(1)), indices.at(face->vertex(2))});
  }
  for (const auto& edge : mesh.finite_edges()) {
    const auto ends = std::minmax(indices.at(edge.first->vertex(Triangulation::cw(edge.second))),
                                  indices.at(edge.first->vertex(Triangulation::ccw(edge.second))));
    const bool constrained = mesh.is_constrained(edge);
    image.edges.push_back({.from = ends.first, .to = ends.second, .is_constrained = constrained});
    if (constrained) image.subsegments.push_back({.from = ends.first, .to = ends.second});
  }
  return image;
}

Attempt run_cgal(const inputs::Graph& graph, bool conforming, Depth depth) {
  const std::vector<CgalPoint> places = places_of(graph.nodes);
  Triangulation mesh;
  Attempt attempt;
  CpuStopwatch watch;
  mesh.insert(places.begin(), places.end());
  attempt.delaunay_us = watch.lap_us();
  const std::vector<Vertex> nodes = vertices_of(mesh, places);
  watch.lap_us();
  for (const FeatureEnds& ends : graph.features) {
    mesh.insert_constraint(nodes[inputs::node_index_of(ends.from)],
                           nodes[inputs::node_index_of(ends.to)]);
  }
  if (conforming) CGAL::make_conforming_Delaunay_2(mesh);
  attempt.total_us = attempt.delaunay_us + watch.lap_us();
  attempt.added = attempt.added_after_pruning =
      static_cast<std::uint32_t>(mesh.number_of_vertices() - graph.nodes.size());
  if (depth == Depth::times) return attempt;
  if (!has_features(mesh, graph, nodes)) {
    attempt.verdict = Verdict::not_conforming;
  } else if (conforming ? !is_delaunay(mesh) : !mesh.is_valid()) {
    attempt.verdict = Verdict::not_delaunay;
  }
  attempt.hash = hash_of(mesh);
  attempt.image = image_of(mesh, graph, nodes);
  return attempt;
}

}  // namespace

Attempt run_cgal_conforming(const inputs::Graph& graph, Depth depth) {
  return run_cgal(graph, true, depth);
}

Attempt run_cgal_constrained(const inputs::Graph& graph, Depth depth) {
  return run_cgal(graph, false, depth);
}

}  // namespace etcm::compare
