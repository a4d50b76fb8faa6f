#include "moving_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace etcm::test {

namespace {

constexpr double day_samples = 1440;
constexpr double two_pi = 2 * std::numbers::pi;

double half_open_unit(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

}  // namespace

MovingField::MovingField(const firmware::Snapshot& snapshot, const FieldManner& manner,
                         std::uint64_t seed)
    : manner_(manner), values_(snapshot.vertices.size()), random_(seed) {
  double side = 1;
  for (std::uint32_t row = 0; row < values_.size(); ++row) {
    side = std::max({side, x_of(snapshot, row), y_of(snapshot, row)});
  }
  for (double& phase : phase_) phase = two_pi * half_open_unit(random_);
  std::vector<double> sum(values_.size());
  for (int i = 0; i < pattern_count; ++i) {
    pattern_[i] = smooth_field(snapshot, manner.length * side, random_());
    for (std::size_t row = 0; row < sum.size(); ++row) sum[row] += pattern_[i][row];
  }
  const auto [least, greatest] = std::minmax_element(sum.begin(), sum.end());
  const double range = *greatest - *least;
  for (auto& pattern : pattern_) {
    for (double& value : pattern) value /= range;
  }
  for (std::uint32_t row = 0; row < values_.size(); ++row) {
    along_.push_back((0.8 * x_of(snapshot, row) + 0.6 * y_of(snapshot, row)) / (1.4 * side));
  }
}

double MovingField::normal() {
  has_spare_ = !has_spare_;
  if (!has_spare_) return spare_normal_;
  const double radius = std::sqrt(-2 * std::log(1 - half_open_unit(random_)));
  const double angle = two_pi * half_open_unit(random_);
  spare_normal_ = radius * std::sin(angle);
  return radius * std::cos(angle);
}

std::vector<double>& MovingField::next() {
  const double day = two_pi * sample_ / day_samples;
  double share[pattern_count];
  for (int i = 0; i < pattern_count; ++i) {
    share[i] = 1 + manner_.shape_swing * std::sin((1 + 0.3 * i) * day + phase_[i]);
  }
  const double common = 0.5 * manner_.common_swing * std::sin(day + phase_[pattern_count]);
  const double front = (sample_ - manner_.front_at) / double(manner_.front_samples);
  for (std::size_t row = 0; row < values_.size(); ++row) {
    double value = common;
    for (int i = 0; i < pattern_count; ++i) value += share[i] * pattern_[i][row];
    if (manner_.front_step != 0) {
      // As wide as a fifth of the site.
      value += 0.5 * manner_.front_step * (1 + std::tanh(10 * (front - along_[row])));
    }
    values_[row] = value + (manner_.noise > 0 ? manner_.noise * normal() : 0);
  }
  ++sample_;
  return values_;
}

}  // namespace etcm::test
