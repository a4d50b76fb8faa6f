// A smooth surface through readings at irregular places, asked at the place where there is none.
//
// A thin-plate smoothing spline (Duchon 1977; Wahba, Spline Models for Observational Data, 1990,
// section 2.4), which is kriging with a linear trend and the generalised covariance d^2 log d
// (Cressie, Statistics for Spatial Data, 1993, section 5.4): so it comes with a variance, and a
// linear field is predicted exactly.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace etcm::firmware {

// Noise of the readings, as a share of the kernel at the farthest place. README.md has the errors
// by which it was chosen; the second is for readings whose noise is larger than what the field
// does.
inline constexpr double usual_smoothing = 0.05;
inline constexpr double noisy_smoothing = 0.5;

// The surface goes through so many places; more add nothing but time.
inline constexpr std::size_t thin_plate_max = 16;
// A place whose prediction would have more than this many times the noise of the readings is too
// far outside of them.
inline constexpr double noise_gain_max = 3.0;

// From the place that is asked about to one that has a reading, in any one unit.
struct Offset {
  double x = 0;
  double y = 0;
};

// The weights depend on places alone, so they are worked out once and serve many samples.
class ThinPlate {
 public:
  // False where there is no answer: fewer than three places; or all of them on one line (of which
  // two will do) and the place asked about is not; or it is beyond noise_gain_max. REQUIRES: at
  // most thin_plate_max, no two equal, none at 0. About 20 000 multiplications, 8 KiB of stack.
  bool fit(std::span<const Offset> places, double smoothing = usual_smoothing);

  std::size_t size() const { return size_; }
  // The rest REQUIRES that fit() was true, and as many values, in the order of the places.
  double value(std::span<const double> values) const;
  // Standard deviation of value() where each reading has independent noise of deviation 1.
  double noise_gain() const { return noise_gain_; }
  // Whether something is left to judge the readings by: one more than a plane, or a line, takes.
  bool has_deviation() const { return size_ > trend_size_; }
  // Standard deviation of a sound reading at the place from value(), judged by how far these
  // readings are from a plane: noise and curvature alike. 0 where they are in a plane.
  // REQUIRES: has_deviation().
  double deviation(std::span<const double> values) const;
  // Its root mean square where the readings are noise of deviation 1 and nothing else. REQUIRES:
  // has_deviation().
  double deviation_of_noise() const { return deviation_of_noise_; }

 private:
  double deviation_of(double form) const;

  std::array<double, thin_plate_max> weight_{};
  // Of the quadratic form that is the roughness of the surface; lower triangle, row by row.
  std::array<double, thin_plate_max*(thin_plate_max + 1) / 2> roughness_{};
  std::size_t size_ = 0;
  std::size_t trend_size_ = 0;  // 3 of a plane, 2 of a line
  double noise_gain_ = 0;
  double variance_factor_ = 0;
  double deviation_of_noise_ = 0;
};

}  // namespace etcm::firmware
