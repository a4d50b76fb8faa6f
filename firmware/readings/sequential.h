// Statistics that are kept sample by sample, in a few numbers each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace etcm::firmware {

// The median of a magnitude, followed by stochastic approximation (Robbins and Monro 1951) on its
// logarithm: each sample moves it by one step up or down, however far off the sample is.
class MedianTracker {
 public:
  MedianTracker() = default;
  // One of before, of so many samples.
  MedianTracker(double median, std::uint32_t count) : median_(median), count_(count) {}

  // REQUIRES: first >= 0.
  void begin(double first) {
    median_ = first;
    count_ = 1;
  }
  // `least`, above 0, is where it ends on the way down.
  void add(double magnitude, double least) {
    // 1.17 is the step of least variance where the magnitude is that of a normal distribution.
    const double step = 1.17 / std::min<double>(++count_, memory_samples);
    median_ = std::max(least, median_ * std::exp(magnitude > median_ ? step : -step));
  }
  double median() const { return median_; }
  // Samples, as far as they count.
  std::uint32_t count() const {
    return std::min(count_, static_cast<std::uint32_t>(memory_samples));
  }
  // The standard deviation that belongs to it, were the distribution normal; larger by the doubt
  // that is left while few samples are in.
  double deviation() const {
    const double samples = std::min<double>(count_, memory_samples);
    return 1.4826 * median_ * (1 + 1 / std::sqrt(samples));
  }

 private:
  static constexpr double memory_samples = 1440;
  double median_ = 0;
  std::uint32_t count_ = 0;
};

// Two cumulative sums (Page 1954), one for either sign, of standardised residuals.
class TwoSidedCusum {
 public:
  // Half of the shift that is found soonest, in standard deviations.
  static constexpr double allowance = 1.0;
  // By Siegmund's approximation (Sequential Analysis, 1985, section 2.6) the sums of independent
  // normal residuals go beyond it once in 3.1 million samples: six years of one a minute.
  static constexpr double threshold = 7.0;
  // One residual counts no more than this: it takes three to go beyond the threshold.
  static constexpr double residual_max = 2.5;
  // A sum grows no farther, so that a sensor which agrees again is clear after about ten samples.
  static constexpr double sum_max = threshold + 3.0;

  TwoSidedCusum() = default;
  // One of before.
  TwoSidedCusum(double rise, double fall)
      : rise_(std::clamp(rise, 0.0, sum_max)), fall_(std::clamp(fall, 0.0, sum_max)) {}

  void add(double residual) {
    const double z = std::clamp(residual, -residual_max, residual_max);
    rise_ = std::clamp(rise_ + z - allowance, 0.0, sum_max);
    fall_ = std::clamp(fall_ - z - allowance, 0.0, sum_max);
  }
  double rise() const { return rise_; }
  double fall() const { return fall_; }
  double sum() const { return std::max(rise_, fall_); }
  bool is_beyond() const { return sum() > threshold; }
  bool is_suspicious() const { return sum() > threshold / 2; }
  bool is_clear() const { return sum() == 0; }

 private:
  double rise_ = 0;
  double fall_ = 0;
};

}  // namespace etcm::firmware
