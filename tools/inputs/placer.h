// Places features one by one so that the graph stays planar.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "inputs/graph.h"
#include "inputs/random.h"

namespace etcm::inputs {

// Keeps nodes and features in square cells, so that a short feature is tested against its
// surroundings only. A cell as large as the input makes it a plain list.
class Placer {
 public:
  // `nodes` must outlive the placer, be distinct and not empty. cell_size >= 1.
  Placer(std::span<const Position> nodes, std::int32_t cell_size);

  // Adds the feature if it has a length, repeats and crosses none, and no node lies on its inside.
  bool try_add(std::size_t from, std::size_t to);

  // A random node of the cells around that of `node`: all nodes within cell_size are among them,
  // each equally likely.
  std::size_t random_near(std::size_t node, Random& random) const;

  const std::vector<FeatureEnds>& features() const noexcept { return features_; }

 private:
  struct Cells {
    std::int32_t left, right, bottom, top;  // inclusive
  };
  struct Cell {
    std::vector<std::uint32_t> nodes;
    std::vector<std::uint32_t> features;
  };

  std::int32_t column(std::int32_t x) const noexcept;
  std::int32_t row(std::int32_t y) const noexcept;
  Cells covered(Position a, Position b) const noexcept;
  std::size_t index(std::int32_t cell_column, std::int32_t cell_row) const noexcept;
  bool blocked_by_feature(const Cell& cell, std::size_t from, std::size_t to) const noexcept;
  bool blocked_by_node(const Cell& cell, std::size_t from, std::size_t to) const noexcept;

  std::span<const Position> nodes_;
  Position low_;
  std::int32_t cell_size_;
  std::int32_t columns_;
  std::int32_t rows_;
  std::vector<Cell> cells_;
  std::vector<FeatureEnds> features_;
};

}  // namespace etcm::inputs
