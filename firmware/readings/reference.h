// The value of one sensor that belongs to the learned state of its site.
//
// Readings are compared by how they have changed from their references, so that the curvature of
// the field, which offsets each place from what its neighbours predict, and a neighbour that goes
// missing, change nothing.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace etcm::firmware {

class Reference {
 public:
  // It begins with the median of so many values, of which two may be anything.
  static constexpr std::size_t first_count = 5;

  Reference() = default;
  // One that was learned before: value() and followed() of it.
  Reference(double value, double followed)
      : count_(first_count), value_(value), followed_(followed) {}

  bool has_begun() const { return count_ == first_count; }
  // REQUIRES: has_begun().
  double value() const { return value_; }
  // How far it has gone from where it was learned.
  double followed() const { return followed_; }

  // REQUIRES: not has_begun().
  void begin_with(double value) {
    first_[count_++] = value;
    if (!has_begun()) return;
    value_ = median_of(first_);
  }
  // Median of the magnitudes by which the first values differ from it. REQUIRES: has_begun().
  double first_difference() const {
    auto differences = first_;
    for (double& difference : differences) difference = std::abs(difference - value_);
    return median_of(differences);
  }

  // As long as the site is being learned it goes where it is drawn.
  void learn(double step) { value_ += step; }
  // After that it stays within `room` of where it was learned, so that no drift is followed for
  // long, however slow it is.
  void follow(double step, double room) {
    const double followed = std::clamp(followed_ + step, -room, room);
    value_ += followed - followed_;
    followed_ = followed;
  }
  // Takes back of what it has followed as much as makes this residual smaller: some of it was the
  // doing of a neighbour that is no longer believed. Returns the residual that is left.
  double take_back(double residual) {
    const double step = std::clamp(residual, std::min(0.0, -followed_), std::max(0.0, -followed_));
    value_ += step;
    followed_ += step;
    return residual - step;
  }

 private:
  static double median_of(std::array<double, first_count> values) {
    std::sort(values.begin(), values.end());
    return values[first_count / 2];
  }

  std::array<double, first_count> first_{};
  std::size_t count_ = 0;
  double value_ = 0;
  double followed_ = 0;
};

}  // namespace etcm::firmware
