#include "circle_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "etcm/predicates.h"

namespace etcm::cli {

namespace {

constexpr std::uint32_t leaf_size = 8;

// The circle through a, b, c as p -> alpha x + beta y - area (x^2 + y^2), with p taken from a:
// positive inside. Differences of coordinates are exact in a double; what is rounded after that is
// bounded by the errors.
class Circle {
 public:
  Circle(const Point& a, const Point& b, const Point& c) : origin_(a) {
    const double bx = static_cast<double>(b.x - a.x);
    const double by = static_cast<double>(b.y - a.y);
    const double cx = static_cast<double>(c.x - a.x);
    const double cy = static_cast<double>(c.y - a.y);
    const double bb = bx * bx + by * by;
    const double cc = cx * cx + cy * cy;
    alpha_ = bb * cy - cc * by;
    beta_ = cc * bx - bb * cx;
    alpha_error_ = (bb * std::abs(cy) + cc * std::abs(by)) * 0x1p-50;
    beta_error_ = (bb * std::abs(cx) + cc * std::abs(bx)) * 0x1p-50;
    area_ = difference_of_products(bx, cy, by, cx);
  }

  // False only where no point of the box can be inside.
  bool may_reach(const Point& low, const Point& high) const {
    return greatest(alpha_, alpha_error_, low.x - origin_.x, high.x - origin_.x) +
               greatest(beta_, beta_error_, low.y - origin_.y, high.y - origin_.y) >=
           0;
  }

 private:
  // p q - r s, to two roundings even where it cancels (Kahan).
  static double difference_of_products(double p, double q, double r, double s) {
    const double rs = r * s;
    return std::fma(p, q, -rs) - std::fma(r, s, -rs);
  }

  // At least the greatest value of slope * x - area * x^2 for x in [low, high].
  double greatest(double slope, double slope_error, std::int64_t low, std::int64_t high) const {
    const double from = static_cast<double>(low);
    const double to = static_cast<double>(high);
    const double best = std::clamp(slope / (2 * area_), from, to);
    const double reach = std::max(std::abs(from), std::abs(to));
    const double slack =
        slope_error * reach + (std::abs(slope) * reach + area_ * reach * reach) * 0x1p-47;
    return (slope - area_ * best) * best + slack;
  }

  Point origin_;
  double alpha_;
  double beta_;
  double alpha_error_;
  double beta_error_;
  double area_;
};

}  // namespace

CircleSearch::CircleSearch(std::span<const Point> points) : points_(points) {
  order_.resize(points.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (!points.empty()) divide({0, static_cast<std::uint32_t>(points.size()), 0});
}

CircleSearch::Box CircleSearch::bounds(const Range& range) const {
  Box box{points_[order_[range.begin]], points_[order_[range.begin]]};
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    const Point& point = points_[order_[i]];
    box.low = {std::min(box.low.x, point.x), std::min(box.low.y, point.y)};
    box.high = {std::max(box.high.x, point.x), std::max(box.high.y, point.y)};
  }
  return box;
}

void CircleSearch::divide(const Range& range) {
  if (boxes_.size() <= range.box) boxes_.resize(std::size_t{range.box} + 1);
  const Box box = bounds(range);
  boxes_[range.box] = box;
  if (range.end - range.begin <= leaf_size) return;
  const bool by_x = box.high.x - box.low.x >= box.high.y - box.low.y;
  const std::uint32_t middle = range.begin + (range.end - range.begin) / 2;
  std::nth_element(order_.begin() + range.begin, order_.begin() + middle,
                   order_.begin() + range.end, [&](std::uint32_t a, std::uint32_t b) {
                     return by_x ? points_[a].x < points_[b].x : points_[a].y < points_[b].y;
                   });
  divide({range.begin, middle, 2 * range.box + 1});
  divide({middle, range.end, 2 * range.box + 2});
}

std::optional<std::uint32_t> CircleSearch::inside(const Point& a, const Point& b,
                                                  const Point& c) const {
  const Circle circle(a, b, c);
  std::vector<Range> open;
  if (!order_.empty()) open.push_back({0, static_cast<std::uint32_t>(order_.size()), 0});
  while (!open.empty()) {
    const Range range = open.back();
    open.pop_back();
    if (!circle.may_reach(boxes_[range.box].low, boxes_[range.box].high)) continue;
    if (range.end - range.begin <= leaf_size) {
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        if (incircle(a, b, c, points_[order_[i]]) > 0) return order_[i];
      }
      continue;
    }
    const std::uint32_t middle = range.begin + (range.end - range.begin) / 2;
    open.push_back({range.begin, middle, 2 * range.box + 1});
    open.push_back({middle, range.end, 2 * range.box + 2});
  }
  return std::nullopt;
}

}  // namespace etcm::cli
