#include "firmware/publish/neighbour_list.h"

#include <algorithm>

#include "firmware/protocol/node_registers.h"

namespace etcm::firmware {

NeighbourList::NeighbourList(std::uint32_t vertices_max)
    : around_(vertices_max), around_steiner_(vertices_max) {
  list_.reserve(vertices_max);
}

std::span<const std::uint32_t> NeighbourList::of(const Mesh& mesh, VertexId node,
                                                 std::span<const std::uint32_t> serials) {
  list_.clear();
  const std::uint32_t degree = mesh.neighbours(node, around_);
  for (const Neighbour& neighbour : std::span(around_).first(degree)) {
    VertexId other = neighbour.vertex;
    if (mesh.kind(other) == VertexKind::steiner) {
      if (!neighbour.constrained) continue;
      other = end_of_stretch(mesh, node, other);
    }
    if (!other.is_none()) list_.push_back(serials[other.value]);
  }
  std::sort(list_.begin(), list_.end());
  list_.erase(std::unique(list_.begin(), list_.end()), list_.end());
  // Anchors: no serial is greater, and none can be asked.
  if (!list_.empty() && list_.back() == no_serial) list_.pop_back();
  return list_;
}

// The node at the other end of the row of Steiner vertices that begins with `over`.
VertexId NeighbourList::end_of_stretch(const Mesh& mesh, VertexId from, VertexId over) {
  for (std::uint32_t left = mesh.steiner_count(); left > 0; --left) {
    const std::uint32_t degree = mesh.neighbours(over, around_steiner_);
    VertexId next;
    for (const Neighbour& neighbour : std::span(around_steiner_).first(degree)) {
      if (neighbour.constrained && neighbour.vertex != from) next = neighbour.vertex;
    }
    if (next.is_none() || mesh.kind(next) == VertexKind::node) return next;
    from = over;
    over = next;
  }
  return VertexId::none();
}

}  // namespace etcm::firmware
