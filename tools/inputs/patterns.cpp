#include "inputs/patterns.h"

#include <algorithm>

#include "inputs/direction.h"
#include "inputs/placer.h"
#include "inputs/random.h"

namespace etcm::inputs {
namespace {

std::string number(auto value) { return std::to_string(value); }

std::int32_t times(std::size_t count, std::int32_t step) noexcept {
  return static_cast<std::int32_t>(count) * step;
}

void add_feature(Graph& graph, Position from, Position to) {
  graph.nodes.push_back(from);
  graph.nodes.push_back(to);
  graph.features.push_back(between_nodes(graph.nodes.size() - 2, graph.nodes.size() - 1));
}

void add_loop(Graph& graph, std::size_t first, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    graph.features.push_back(between_nodes(first + i, first + (i + 1) % count));
  }
}

void add_random_features(Graph& graph, std::size_t wanted, Random& random) {
  Placer placer(graph.nodes, 2 * position_max);
  for (std::size_t tries = 0; tries < 1000 * wanted && placer.features().size() < wanted; ++tries) {
    const std::size_t from = random.index(graph.nodes.size());
    const std::size_t to = random.index(graph.nodes.size());
    placer.try_add(from, to);
  }
  graph.features = placer.features();
}

}  // namespace

Graph fan(const Fan& shape) {
  Random random(shape.seed);
  Graph graph;
  graph.name = "fan-" + number(shape.features) + "-step-" + number(shape.step_millidegrees) +
               "-length-" + number(shape.shortest) + "-" + number(shape.longest);
  graph.nodes.push_back({0, 0});
  for (std::size_t i = 0; i < shape.features; ++i) {
    const std::int32_t length = random.between(shape.shortest, shape.longest);
    graph.nodes.push_back(at_angle({0, 0}, times(i, shape.step_millidegrees), length));
    graph.features.push_back(between_nodes(0, i + 1));
  }
  return graph;
}

Graph comb(std::size_t teeth, std::int32_t spacing, std::int32_t length, std::int32_t stagger) {
  Graph graph{"comb-" + number(teeth) + "-stagger-" + number(stagger), {}, {}};
  for (std::size_t i = 0; i < teeth; ++i) {
    const std::int32_t bottom = i % 2 == 0 ? 0 : stagger;
    add_feature(graph, {times(i, spacing), bottom}, {times(i, spacing), bottom + length});
  }
  return graph;
}

Graph parallels(std::size_t features, std::int32_t apart, std::int32_t length, std::size_t around,
                std::uint64_t seed) {
  Random random(seed);
  Graph graph{
      "parallels-" + number(features) + "-apart-" + number(apart) + "-around-" + number(around),
      {},
      {}};
  for (std::size_t i = 0; i < features; ++i) {
    add_feature(graph, {0, times(i, apart)}, {length, times(i, apart)});
  }
  const std::int32_t top = times(features, apart);
  const std::int32_t margin = std::max(length / 20, 1);
  for (std::size_t i = 0; i < around; ++i) {
    // An x of its own for each keeps the nodes distinct.
    const std::int32_t slot = length / static_cast<std::int32_t>(around);
    const std::int32_t x = times(i, slot) + random.between(0, slot - 1);
    const std::int32_t away = random.between(1, margin);
    graph.nodes.push_back({x, random.below(2) == 0 ? -away : top + away});
  }
  return graph;
}

Graph grid(std::size_t side, std::int32_t spacing, GridFeatures features, std::uint64_t seed) {
  Random random(seed);
  Graph graph{"grid-" + number(side), {}, {}};
  for (std::size_t row = 0; row < side; ++row) {
    for (std::size_t column = 0; column < side; ++column) {
      graph.nodes.push_back({times(column, spacing), times(row, spacing)});
    }
  }
  const auto at = [side](std::size_t column, std::size_t row) { return row * side + column; };
  switch (features) {
    case GridFeatures::cell_diagonals:
      graph.name += "-cell-diagonals";
      for (std::size_t row = 0; row + 1 < side; ++row) {
        for (std::size_t column = 0; column + 1 < side; ++column) {
          const bool rising = random.below(2) == 0;
          graph.features.push_back(rising
                                       ? between_nodes(at(column, row), at(column + 1, row + 1))
                                       : between_nodes(at(column + 1, row), at(column, row + 1)));
        }
      }
      break;
    case GridFeatures::long_diagonals:
      graph.name += "-long-diagonals";
      for (std::size_t start = 0; start + 1 < side; start += 3) {
        graph.features.push_back(between_nodes(at(start, 0), at(side - 1, side - 1 - start)));
      }
      break;
    case GridFeatures::knight_moves:
      graph.name += "-knight-moves";
      for (std::size_t row = 0; row + 1 < side; row += 2) {
        for (std::size_t column = 0; column + 2 < side; column += 3) {
          graph.features.push_back(between_nodes(at(column, row), at(column + 2, row + 1)));
        }
      }
      break;
    case GridFeatures::random_segments:
      graph.name += "-random-segments";
      add_random_features(graph, graph.nodes.size() * 15 / 100, random);
      break;
  }
  return graph;
}

Graph spiral(std::size_t nodes, std::int32_t millidegrees, std::int32_t outwards) {
  Graph graph{"spiral-" + number(nodes) + "-step-" + number(millidegrees), {}, {}};
  for (std::size_t i = 0; i < nodes; ++i) {
    graph.nodes.push_back(at_angle({0, 0}, times(i, millidegrees), times(i + 4, outwards)));
    if (i > 0) graph.features.push_back(between_nodes(i - 1, i));
  }
  return graph;
}

Graph nearly_collinear(std::size_t nodes, std::int32_t deviation, std::size_t reach,
                       std::uint64_t seed) {
  Random random(seed);
  Graph graph{"nearly-collinear-" + number(nodes) + "-deviation-" + number(deviation), {}, {}};
  for (std::size_t i = 0; i < nodes; ++i) {
    graph.nodes.push_back({times(i, 1000), random.between(-deviation, deviation)});
  }
  Placer placer(graph.nodes, 2 * position_max);
  for (std::size_t tries = 0; tries < 4 * nodes; ++tries) {
    const std::size_t from = random.index(nodes);
    const std::size_t to = std::min(from + 2 + random.index(reach - 1), nodes - 1);
    placer.try_add(from, to);
  }
  graph.features = placer.features();
  return graph;
}

Graph circle(std::size_t nodes, std::int32_t radius, std::size_t chords, std::uint64_t seed) {
  Random random(seed);
  Graph graph{"circle-" + number(nodes), {}, {}};
  const std::int32_t step = full_turn_millidegrees / static_cast<std::int32_t>(nodes);
  for (std::size_t i = 0; i < nodes; ++i) {
    graph.nodes.push_back(at_angle({0, 0}, times(i, step), radius));
  }
  add_random_features(graph, chords, random);
  return graph;
}

Graph exact_circle(std::size_t chords, std::uint64_t seed) {
  constexpr std::int64_t radius = std::int64_t{5} * 13 * 17 * 29;
  Random random(seed);
  Graph graph{"exact-circle-" + number(chords), {}, {}};
  std::int64_t y = radius;
  for (std::int64_t x = 0; x <= radius; ++x) {
    while (x * x + y * y > radius * radius) --y;
    if (x * x + y * y != radius * radius) continue;
    for (const std::int64_t sign_x : {1, -1}) {
      for (const std::int64_t sign_y : {1, -1}) {
        if ((x == 0 && sign_x < 0) || (y == 0 && sign_y < 0)) continue;
        graph.nodes.push_back(
            {static_cast<std::int32_t>(sign_x * x), static_cast<std::int32_t>(sign_y * y)});
      }
    }
  }
  shuffle(graph.nodes, random);
  add_random_features(graph, chords, random);
  return graph;
}

Graph star(std::size_t points, std::int32_t inner, std::int32_t outer) {
  Graph graph{"star-" + number(points), {}, {}};
  const std::int32_t step = full_turn_millidegrees / static_cast<std::int32_t>(2 * points);
  for (std::size_t i = 0; i < 2 * points; ++i) {
    graph.nodes.push_back(at_angle({0, 0}, times(i, step), i % 2 == 0 ? outer : inner));
  }
  add_loop(graph, 0, 2 * points);
  return graph;
}

Graph ladder(std::size_t rungs, std::int32_t spacing, std::int32_t width, std::int32_t lean) {
  Graph graph{"ladder-" + number(rungs) + "-lean-" + number(lean), {}, {}};
  for (std::size_t i = 0; i < rungs; ++i) {
    add_feature(graph, {0, times(i, spacing)}, {width, times(i, spacing) + lean});
    if (i == 0) continue;
    graph.features.push_back(between_nodes(2 * i - 2, 2 * i));
    graph.features.push_back(between_nodes(2 * i - 1, 2 * i + 1));
  }
  return graph;
}

Graph nested_squares(std::size_t squares, std::int32_t step, std::int32_t turn_millidegrees) {
  Graph graph{"nested-squares-" + number(squares) + "-turn-" + number(turn_millidegrees), {}, {}};
  for (std::size_t i = 0; i < squares; ++i) {
    for (std::int32_t corner = 0; corner < 4; ++corner) {
      const std::int32_t angle = 45'000 + corner * 90'000 + times(i, turn_millidegrees);
      graph.nodes.push_back(at_angle({0, 0}, angle, times(i + 1, step)));
    }
    add_loop(graph, 4 * i, 4);
  }
  return graph;
}

Graph zigzag(std::size_t features, std::int32_t millidegrees, std::int32_t length) {
  Graph graph{"zigzag-" + number(features) + "-angle-" + number(millidegrees), {}, {}};
  // Over and back: the way over is level, the way back leaves it by the angle.
  Position at{0, 0};
  graph.nodes.push_back(at);
  for (std::size_t i = 0; i < features; ++i) {
    at = at_angle(at, i % 2 == 0 ? 0 : 180'000 - millidegrees, length);
    graph.nodes.push_back(at);
    graph.features.push_back(between_nodes(i, i + 1));
  }
  return graph;
}

Graph collinear(std::size_t nodes, std::size_t through) {
  Graph graph{"collinear-" + number(nodes), {}, {}};
  for (std::size_t i = 0; i < nodes; ++i) {
    graph.nodes.push_back({times(i, 30), times(i, 10)});
  }
  for (std::size_t i = 0; i + through < nodes; i += through) {
    graph.features.push_back(between_nodes(i, i + through));
  }
  return graph;
}

}  // namespace etcm::inputs
