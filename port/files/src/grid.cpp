#include "etcm/files/grid.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "etcm/files/error.h"

namespace etcm::files {

namespace {

class Placer {
 public:
  Placer(const std::string& file, const Placement& placement)
      : file_(file), placement_(placement) {}

  std::int32_t place(const char* axis, const Decimal& given, std::size_t line) const {
    Decimal value = placement_.scale ? given * *placement_.scale : given;
    if (placement_.round) value = value.rounded();
    if (!value.is_integer()) {
      fail(line, axis, given, value,
           placement_.scale ? " is no integer; use another --scale, or --round as well"
                            : " is no integer; use --scale S to multiply all coordinates, or "
                              "--round to take the nearest");
    }
    const auto integer = value.to_integer();
    if (!integer || *integer < -position_max || *integer > position_max) {
      fail(line, axis, given, value,
           " is out of range; coordinates run from -16777216 to 16777216, use a smaller --scale");
    }
    return static_cast<std::int32_t>(*integer);
  }

 private:
  [[noreturn]] void fail(std::size_t line, const char* axis, const Decimal& given,
                         const Decimal& value, const char* what) const {
    std::string message = std::string(axis) + " " + given.to_string();
    if (!(value == given)) message += ", scaled to " + value.to_string() + ",";
    throw InputError(file_, line, message + what);
  }

  const std::string& file_;
  const Placement& placement_;
};

std::string describe_duplicate(const ConstraintGraph& graph, const GridGraph& grid) {
  std::vector<std::uint32_t> order(grid.nodes.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) { return std::tuple(grid.nodes[i].x, grid.nodes[i].y, i); };
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return key(a) < key(b); });
  // The first repetition in the order of the file.
  std::uint32_t first = 0;
  std::uint32_t second = static_cast<std::uint32_t>(order.size());
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (grid.nodes[order[i]] == grid.nodes[order[i - 1]] && order[i] < second) {
      first = order[i - 1];
      second = order[i];
    }
  }
  if (second == order.size()) return graph.node_file + ": two nodes stand at one place";
  const GraphNode& node = graph.nodes[second];
  return graph.node_file + ":" + std::to_string(node.line_number) + ": node " +
         std::to_string(graph.node_number(second)) + " stands at " +
         std::to_string(grid.nodes[second].x) + " " + std::to_string(grid.nodes[second].y) +
         ", where node " + std::to_string(graph.node_number(first)) + " (line " +
         std::to_string(graph.nodes[first].line_number) + ") is; remove one of them";
}

}  // namespace

std::optional<std::int64_t> subunits_of(const Decimal& coordinate, const Placement& placement) {
  Decimal value = coordinate * Decimal::of(subunits_per_unit);
  if (placement.scale) value = value * *placement.scale;
  const auto integer = value.rounded().to_integer();
  constexpr std::int64_t most = position_max * subunits_per_unit;
  if (!integer || *integer < -most || *integer > most) return std::nullopt;
  return integer;
}

Position place_on_grid(const std::string& file, std::size_t line, const Decimal& x,
                       const Decimal& y, const Placement& placement) {
  const Placer placer(file, placement);
  return {placer.place("x", x, line), placer.place("y", y, line)};
}

GridGraph place_on_grid(const ConstraintGraph& graph, const Placement& placement) {
  GridGraph grid;
  grid.nodes.reserve(graph.nodes.size());
  for (const GraphNode& node : graph.nodes) {
    grid.nodes.push_back(
        place_on_grid(graph.node_file, node.line_number, node.x, node.y, placement));
  }
  grid.features.reserve(graph.features.size());
  for (const GraphFeature& feature : graph.features) {
    grid.features.push_back({VertexId(static_cast<IdValue>(feature.from + 1)),
                             VertexId(static_cast<IdValue>(feature.to + 1))});
  }
  for (const GraphHole& hole : graph.holes) {
    const auto x = subunits_of(hole.x, placement);
    const auto y = subunits_of(hole.y, placement);
    if (x && y) grid.holes.push_back({*x, *y});
  }
  return grid;
}

std::string describe_refusal(const ConstraintGraph& graph, const GridGraph& grid,
                             const ErrorDetail& error_detail) {
  if (error_detail.status == Status::duplicate_vertex) return describe_duplicate(graph, grid);
  if (error_detail.feature.is_none() || error_detail.feature.value >= graph.features.size()) {
    return graph.poly_file + ": " + explain(error_detail.status);
  }
  const bool has_other =
      !error_detail.other.is_none() && error_detail.other.value < graph.features.size();
  // Two features in each other's way: the later one is named.
  const std::size_t feature = has_other
                                  ? std::max(error_detail.feature.value, error_detail.other.value)
                                  : error_detail.feature.value;
  const std::size_t earlier = std::min(error_detail.feature.value, error_detail.other.value);
  const std::string text = graph.poly_file + ":" +
                           std::to_string(graph.features[feature].line_number) + ": " +
                           feature_name(graph, feature) + " ";
  const std::string other = has_other
                                ? feature_name(graph, earlier) + " (line " +
                                      std::to_string(graph.features[earlier].line_number) + ")"
                                : "another feature";
  switch (error_detail.status) {
    case Status::crossing_features:
      return text + "crosses " + other + "; put a node where they meet";
    case Status::overlapping_features:
      return text + "runs along a part of " + other + "; split them where they part";
    case Status::repeated_feature:
      return text + "repeats " + other + "; remove one of them";
    case Status::zero_length_feature:
      return text + "has no length; remove it";
    default:
      return text + "is refused: " + explain(error_detail.status);
  }
}

}  // namespace etcm::files
