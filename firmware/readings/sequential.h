// Statistics that are kept sample by sample, in a few numbers each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace etcm::firmware {

// A quantile of a magnitude, followed by stochastic approximation (Robbins and Monro 1951) on its
// logarithm: each sample moves it by one step up or down, however far off the sample is.
class QuantileTracker {
 public:
  // `share` of the samples are below it; `normal` is where that quantile of the magnitude of a
  // normal distribution of deviation 1 stands.
  constexpr QuantileTracker(double share, double normal) : share_(share), normal_(normal) {}
  static constexpr QuantileTracker median() { return {0.5, 0.6745}; }
  static constexpr QuantileTracker ninth_decile() { return {0.9, 1.6449}; }

  bool has_begun() const { return count_ > 0; }
  // With the first magnitude, or the value() of before, of so many samples. REQUIRES: first >= 0.
  void begin(double first, std::uint32_t count = 1) {
    value_ = first;
    count_ = count;
  }
  // `least`, above 0, is where it ends on the way down.
  void add(double magnitude, double least) {
    // Twice 1.17 is the step of least variance for the median of a normal magnitude.
    const double step = 2.34 / std::min<double>(++count_, memory_samples);
    value_ = std::max(least,
                      value_ * std::exp(magnitude > value_ ? step * share_ : -step * (1 - share_)));
  }
  double value() const { return value_; }
  // Samples, as far as they count.
  std::uint32_t count() const {
    return std::min(count_, static_cast<std::uint32_t>(memory_samples));
  }
  // The standard deviation that belongs to it, were the distribution normal.
  double deviation() const { return value_ / normal_; }
  // Larger by the doubt that is left while few samples are in.
  double doubted_deviation() const {
    return deviation() * (1 + 1 / std::sqrt(std::min<double>(count_, memory_samples)));
  }

 private:
  static constexpr double memory_samples = 1440;
  double share_;
  double normal_;
  double value_ = 0;
  std::uint32_t count_ = 0;
};

// Two cumulative sums (Page 1954), one for either sign, of standardised residuals.
class TwoSidedCusum {
 public:
  // Half of the shift that is found soonest, in standard deviations.
  static constexpr double allowance = 1.0;
  // By Siegmund's approximation (Sequential Analysis, 1985, section 2.6) the sums of independent
  // normal residuals go beyond it once in 420 000 samples of one minute, ten months; the deviations
  // that they are divided by are on the safe side, and make years of it.
  static constexpr double threshold = 6.0;
  // One residual counts no more than this: it takes five to go beyond the threshold.
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
  bool is_suspicious() const { return sum() > threshold / 3; }
  bool is_clear() const { return sum() == 0; }

 private:
  double rise_ = 0;
  double fall_ = 0;
};

}  // namespace etcm::firmware
