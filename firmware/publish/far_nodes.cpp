#include "firmware/publish/far_nodes.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

bool is_node(const SnapshotVertex& vertex) {
  return vertex.kind == VertexKind::node && !vertex.is_anchor;
}

Position place_of(const SnapshotVertex& vertex) {
  return {.x = static_cast<std::int32_t>(vertex.point.x / subunits_per_unit),
          .y = static_cast<std::int32_t>(vertex.point.y / subunits_per_unit)};
}

}  // namespace

FarNodes::FarNodes(std::uint32_t vertices_max) { sorted_.reserve(vertices_max); }

void FarNodes::set_plane(const SitePlane& plane) {
  const double known = metres_per_unit(plane);
  const double metres = known > 0 ? known : static_cast<double>(plane.unit_length) / 1e9;
  // No two nodes are farther apart than this.
  constexpr double most = 4.0 * position_max;
  least_ = static_cast<std::int64_t>(std::min(static_cast<double>(far_metres_min) / metres, most));
}

void FarNodes::mark(Snapshot& snapshot) {
  snapshot.far_count = 0;
  // The element of this rank; they are in another order then.
  const auto pick = [this](std::size_t rank) {
    const auto at = sorted_.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(sorted_.begin(), at, sorted_.end());
    return *at;
  };
  const auto each_node = [&](auto&& take) {
    sorted_.clear();
    for (const SnapshotVertex& vertex : snapshot.vertices) {
      if (is_node(vertex)) sorted_.push_back(take(place_of(vertex)));
    }
    return sorted_.size();
  };
  const std::size_t count = each_node([](Position place) { return place.x; });
  if (count < far_nodes_min) return;
  snapshot.middle.x = static_cast<std::int32_t>(pick((count - 1) / 2));
  each_node([](Position place) { return place.y; });
  snapshot.middle.y = static_cast<std::int32_t>(pick((count - 1) / 2));
  each_node([&](Position place) { return squared_distance(place, snapshot.middle); });
  const std::int64_t limit =
      std::max(far_times * far_times * pick((3 * count - 1) / 4), least_ * least_);
  for (SnapshotVertex& vertex : snapshot.vertices) {
    vertex.is_far = is_node(vertex) && squared_distance(place_of(vertex), snapshot.middle) > limit;
    if (vertex.is_far) ++snapshot.far_count;
  }
}

}  // namespace etcm::firmware
