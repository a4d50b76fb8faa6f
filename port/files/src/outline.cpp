#include "etcm/files/outline.h"

#include <algorithm>

namespace etcm::files {

std::vector<DirectedEdge> outline_edges(const MeshImage& image) {
  std::vector<DirectedEdge> all;
  all.reserve(image.triangles.size() * 3);
  for (const auto& corner : image.triangles) {
    for (std::size_t i = 0; i < 3; ++i) all.emplace_back(corner[i], corner[(i + 1) % 3]);
  }
  std::sort(all.begin(), all.end());
  std::vector<DirectedEdge> outline;
  for (const DirectedEdge& edge : all) {
    if (!std::binary_search(all.begin(), all.end(), DirectedEdge(edge.second, edge.first))) {
      outline.push_back(edge);
    }
  }
  return outline;
}

std::vector<std::vector<std::uint32_t>> outline_loops(const MeshImage& image) {
  const std::vector<DirectedEdge> edges = outline_edges(image);
  std::vector<bool> used(edges.size(), false);
  std::vector<std::vector<std::uint32_t>> loops;
  for (std::size_t start = 0; start < edges.size(); ++start) {
    if (used[start]) continue;
    std::vector<std::uint32_t> loop;
    std::size_t at = start;
    while (at < edges.size() && !used[at]) {
      used[at] = true;
      loop.push_back(edges[at].first);
      const std::uint32_t here = edges[at].second;
      at = static_cast<std::size_t>(
          std::lower_bound(edges.begin(), edges.end(), DirectedEdge(here, 0)) - edges.begin());
      while (at < edges.size() && edges[at].first == here && used[at]) ++at;
      if (at < edges.size() && edges[at].first != here) break;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace etcm::files
