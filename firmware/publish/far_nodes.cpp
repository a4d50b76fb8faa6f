#include "firmware/publish/far_nodes.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

namespace {

bool is_node(const SnapshotVertex& vertex) {
  return vertex.kind == VertexKind::node && !vertex.is_anchor;
}

Position place_of(const Point& point) {
  return {.x = static_cast<std::int32_t>(point.x / subunits_per_unit),
          .y = static_cast<std::int32_t>(point.y / subunits_per_unit)};
}
Position place_of(const SnapshotVertex& vertex) { return place_of(vertex.point); }

// What the settings say of where the site is. The origin that nobody gave is no place.
std::vector<Position> places_of(const Settings& settings) {
  std::vector<Position> places;
  for (const NodeSettings& node : settings.nodes) {
    if (node.position) places.push_back(*node.position);
  }
  for (const AnchorSettings& anchor : settings.anchors) places.push_back(anchor.position);
  for (const DomainEdge& edge : settings.domain.outline()) places.push_back(place_of(edge.from));
  return places;
}

// From the first to the last of those around `middle` with no gap wider than this between them.
std::pair<std::int64_t, std::int64_t> range_around(std::vector<std::int64_t>& values,
                                                   std::int64_t middle, std::int64_t gap) {
  std::sort(values.begin(), values.end());
  const auto at = std::lower_bound(values.begin(), values.end(), middle);
  auto first = at;
  while (first != values.begin() && *first - *(first - 1) <= gap) --first;
  auto last = at;
  while (last + 1 != values.end() && *(last + 1) - *last <= gap) ++last;
  return {*first, *last};
}

// The element of this rank; they are in another order then.
std::int64_t pick(std::vector<std::int64_t>& values, std::size_t rank) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

bool FarNodes::Box::contains(Position place) const {
  return left <= place.x && place.x <= right && bottom <= place.y && place.y <= top;
}

std::int64_t FarNodes::Box::squared_distance_to(Position place) const {
  const std::int64_t x = place.x - std::clamp<std::int64_t>(place.x, left, right);
  const std::int64_t y = place.y - std::clamp<std::int64_t>(place.y, bottom, top);
  return x * x + y * y;
}

FarNodes::FarNodes(std::uint32_t vertices_max) { sorted_.reserve(vertices_max); }

void FarNodes::set_site(const Settings& settings) {
  const SitePlane plane = settings.site.plane();
  const double known = metres_per_unit(plane);
  const auto units_of = [](std::int64_t length, double metres) {
    // No two nodes are farther apart than this.
    constexpr double most = 4.0 * position_max;
    return static_cast<std::int64_t>(std::min(static_cast<double>(length) / metres, most));
  };
  least_ =
      units_of(far_metres_min, known > 0 ? known : static_cast<double>(plane.unit_length) / 1e9);
  from_site_ = known > 0 ? units_of(far_from_site_metres, known) : 0;
  one_place_ = known > 0 ? units_of(one_place_metres, known) : 0;
  site_ = box_of_site(settings);
}

std::optional<FarNodes::Box> FarNodes::box_of_site(const Settings& settings) const {
  if (one_place_ == 0) return std::nullopt;
  std::vector<Position> places = places_of(settings);
  const bool has_origin = settings.site.origin != SiteOrigin{};
  if (has_origin) places.push_back({});
  if (places.empty()) return std::nullopt;
  std::vector<std::int64_t> columns, rows;
  for (const Position place : places) {
    columns.push_back(place.x);
    rows.push_back(place.y);
  }
  const std::size_t rank = (places.size() - 1) / 2;
  const std::int64_t middle_x = has_origin ? 0 : pick(columns, rank);
  const std::int64_t middle_y = has_origin ? 0 : pick(rows, rank);
  const auto [left, right] = range_around(columns, middle_x, one_place_);
  const auto [bottom, top] = range_around(rows, middle_y, one_place_);
  const Box box{.left = left, .right = right, .bottom = bottom, .top = top};
  const auto count = static_cast<std::size_t>(std::count_if(
      places.begin(), places.end(), [&](Position place) { return box.contains(place); }));
  return 2 * count > places.size() ? std::optional(box) : std::nullopt;
}

void FarNodes::mark(Snapshot& snapshot) {
  for (SnapshotVertex& vertex : snapshot.vertices) vertex.far_from = FarFrom::nothing;
  snapshot.far_count = 0;
  if (site_) {
    mark_far_from_site(snapshot);
  } else if (one_place_ > 0) {
    mark_apart(snapshot);
  }
  mark_far_from_others(snapshot);
  for (const SnapshotVertex& vertex : snapshot.vertices) {
    if (vertex.far_from != FarFrom::nothing) ++snapshot.far_count;
  }
}

void FarNodes::mark_far_from_site(Snapshot& snapshot) const {
  snapshot.site_middle = {.x = static_cast<std::int32_t>((site_->left + site_->right) / 2),
                          .y = static_cast<std::int32_t>((site_->bottom + site_->top) / 2)};
  for (SnapshotVertex& vertex : snapshot.vertices) {
    if (!is_node(vertex)) continue;
    const bool is_far = site_->squared_distance_to(place_of(vertex)) > from_site_ * from_site_;
    if (is_far) vertex.far_from = FarFrom::site;
  }
}

// Where most are in one place it is the others that are wrong; else nobody can say who.
void FarNodes::mark_apart(Snapshot& snapshot) {
  std::array<std::uint32_t, 4>& outermost = snapshot.outermost;
  outermost = {};
  std::size_t count = 0;
  const auto place_in = [&](std::uint32_t row) { return place_of(snapshot.vertices[row]); };
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    if (!is_node(snapshot.vertices[row])) continue;
    if (count++ == 0) outermost.fill(row);
    const Position place = place_in(row);
    if (place.x < place_in(outermost[0]).x) outermost[0] = row;
    if (place.x > place_in(outermost[1]).x) outermost[1] = row;
    if (place.y < place_in(outermost[2]).y) outermost[2] = row;
    if (place.y > place_in(outermost[3]).y) outermost[3] = row;
  }
  if (count < 2) return;
  const std::int64_t width = std::int64_t{place_in(outermost[1]).x} - place_in(outermost[0]).x;
  const std::int64_t height = std::int64_t{place_in(outermost[3]).y} - place_in(outermost[2]).y;
  if (width <= one_place_ && height <= one_place_) return;
  const auto range = [&](auto&& take) {
    sorted_.clear();
    for (const SnapshotVertex& vertex : snapshot.vertices) {
      if (is_node(vertex)) sorted_.push_back(take(place_of(vertex)));
    }
    const std::int64_t middle = pick(sorted_, (count - 1) / 2);
    return range_around(sorted_, middle, one_place_);
  };
  const auto [left, right] = range([](Position place) { return place.x; });
  const auto [bottom, top] = range([](Position place) { return place.y; });
  const Box box{.left = left, .right = right, .bottom = bottom, .top = top};
  std::size_t inside = 0;
  for (const SnapshotVertex& vertex : snapshot.vertices) {
    if (is_node(vertex) && box.contains(place_of(vertex))) ++inside;
  }
  if (inside == count) return;
  const bool is_known_who = count >= far_nodes_min && 2 * inside > count;
  snapshot.middle = {.x = static_cast<std::int32_t>((left + right) / 2),
                     .y = static_cast<std::int32_t>((bottom + top) / 2)};
  for (SnapshotVertex& vertex : snapshot.vertices) {
    if (!is_node(vertex)) continue;
    if (!is_known_who) {
      vertex.far_from = FarFrom::another;
    } else if (!box.contains(place_of(vertex))) {
      vertex.far_from = FarFrom::others;
    }
  }
}

// Of those that are not far already.
void FarNodes::mark_far_from_others(Snapshot& snapshot) {
  const auto is_to_be_judged = [](const SnapshotVertex& vertex) {
    return is_node(vertex) && vertex.far_from == FarFrom::nothing;
  };
  const auto each_node = [&](auto&& take) {
    sorted_.clear();
    for (const SnapshotVertex& vertex : snapshot.vertices) {
      if (is_to_be_judged(vertex)) sorted_.push_back(take(place_of(vertex)));
    }
    return sorted_.size();
  };
  const std::size_t count = each_node([](Position place) { return place.x; });
  if (count < far_nodes_min) return;
  snapshot.middle.x = static_cast<std::int32_t>(pick(sorted_, (count - 1) / 2));
  each_node([](Position place) { return place.y; });
  snapshot.middle.y = static_cast<std::int32_t>(pick(sorted_, (count - 1) / 2));
  each_node([&](Position place) { return squared_distance(place, snapshot.middle); });
  const std::int64_t limit =
      std::max(far_times * far_times * pick(sorted_, (3 * count - 1) / 4), least_ * least_);
  for (SnapshotVertex& vertex : snapshot.vertices) {
    if (!is_to_be_judged(vertex)) continue;
    if (squared_distance(place_of(vertex), snapshot.middle) > limit) {
      vertex.far_from = FarFrom::others;
    }
  }
}

const SnapshotVertex& farthest_from(const Snapshot& snapshot, const SnapshotVertex& vertex) {
  const auto distance_to = [&](std::uint32_t row) {
    return squared_distance(place_of(snapshot.vertices[row]), place_of(vertex));
  };
  const auto found = std::max_element(
      snapshot.outermost.begin(), snapshot.outermost.end(),
      [&](std::uint32_t a, std::uint32_t b) { return distance_to(a) < distance_to(b); });
  return snapshot.vertices[*found];
}

}  // namespace etcm::firmware
