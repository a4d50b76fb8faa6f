#include "hull.h"

#include <algorithm>
#include <numeric>

#include "etcm/predicates.h"

namespace etcm::cli {

std::vector<files::DirectedEdge> hull_edges(std::span<const Point> points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return points[a] < points[b]; });
  // Andrew's monotone chain; points on the hull stay.
  const auto half = [&](auto begin, auto end) {
    std::vector<std::uint32_t> chain;
    for (auto at = begin; at != end; ++at) {
      while (chain.size() > 1 &&
             orient2d(points[chain[chain.size() - 2]], points[chain.back()], points[*at]) < 0) {
        chain.pop_back();
      }
      chain.push_back(*at);
    }
    return chain;
  };
  const auto lower = half(order.begin(), order.end());
  const auto upper = half(order.rbegin(), order.rend());
  std::vector<files::DirectedEdge> edges;
  for (const auto* chain : {&lower, &upper}) {
    for (std::size_t i = 1; i < chain->size(); ++i) {
      edges.emplace_back((*chain)[i - 1], (*chain)[i]);
    }
  }
  std::sort(edges.begin(), edges.end());
  const bool is_flat = std::any_of(edges.begin(), edges.end(), [&](const auto& edge) {
    return std::binary_search(edges.begin(), edges.end(),
                              files::DirectedEdge(edge.second, edge.first));
  });
  if (is_flat) edges.clear();
  return edges;
}

}  // namespace etcm::cli
