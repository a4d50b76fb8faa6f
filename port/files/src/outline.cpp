#include "etcm/files/outline.h"

#include <algorithm>

namespace etcm::files {

void Outline::reserve(std::size_t vertices) {
  const std::size_t edges = 3 * vertices;
  all_.reserve(2 * edges);
  edges_.reserve(edges);
  used_.reserve(edges);
  vertices_.reserve(edges);
  loop_ends_.reserve(edges / 3);
}

void Outline::find(const MeshImage& image) {
  all_.clear();
  for (const auto& corner : image.triangles) {
    for (std::size_t i = 0; i < 3; ++i) all_.emplace_back(corner[i], corner[(i + 1) % 3]);
  }
  std::sort(all_.begin(), all_.end());
  edges_.clear();
  for (const DirectedEdge& edge : all_) {
    if (!std::binary_search(all_.begin(), all_.end(), DirectedEdge(edge.second, edge.first))) {
      edges_.push_back(edge);
    }
  }
  find_loops();
}

void Outline::find_loops() {
  used_.assign(edges_.size(), false);
  vertices_.clear();
  loop_ends_.clear();
  for (std::size_t start = 0; start < edges_.size(); ++start) {
    if (used_[start]) continue;
    std::size_t at = start;
    while (at < edges_.size() && !used_[at]) {
      used_[at] = true;
      vertices_.push_back(edges_[at].first);
      const std::uint32_t here = edges_[at].second;
      at = static_cast<std::size_t>(
          std::lower_bound(edges_.begin(), edges_.end(), DirectedEdge(here, 0)) - edges_.begin());
      while (at < edges_.size() && edges_[at].first == here && used_[at]) ++at;
      if (at < edges_.size() && edges_[at].first != here) break;
    }
    loop_ends_.push_back(vertices_.size());
  }
}

std::span<const std::uint32_t> Outline::loop(std::size_t index) const {
  const std::size_t begin = index == 0 ? 0 : loop_ends_[index - 1];
  return std::span(vertices_).subspan(begin, loop_ends_[index] - begin);
}

std::vector<DirectedEdge> outline_edges(const MeshImage& image) {
  Outline outline;
  outline.find(image);
  return outline.edges();
}

}  // namespace etcm::files
