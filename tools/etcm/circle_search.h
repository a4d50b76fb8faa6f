// Is any of these points strictly inside that circle? Exactly, and without asking all of them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "etcm/types.h"

namespace etcm::cli {

// A k-d tree. Boxes are passed over by a bound in floating point that errs on the safe side; what
// is left is decided by the exact incircle.
class CircleSearch {
 public:
  explicit CircleSearch(std::span<const Point> points);

  // The index of a point strictly inside the circumcircle of the counter-clockwise a, b, c.
  std::optional<std::uint32_t> inside(const Point& a, const Point& b, const Point& c) const;

 private:
  struct Box {
    Point low;
    Point high;
  };
  struct Range {
    std::uint32_t begin;
    std::uint32_t end;
    std::uint32_t box;  // in boxes_; the halves of a range have 2 * box + 1 and 2 * box + 2
  };
  void divide(const Range& range);
  Box bounds(const Range& range) const;

  std::span<const Point> points_;
  std::vector<std::uint32_t> order_;
  std::vector<Box> boxes_;
};

}  // namespace etcm::cli
