#include "firmware/readings/thin_plate.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace etcm::firmware {

namespace {

// Places that are no farther from a line than this share of their spread along it are on it.
constexpr double line_tolerance = 1e-9;

constexpr std::size_t system_max = thin_plate_max + 3;
using Matrix = std::array<std::array<double, system_max>, system_max>;

double kernel(double x, double y) {
  const double squared = x * x + y * y;
  return squared > 0 ? 0.5 * squared * std::log(squared) : 0;
}

// The trend 1, u, v along the principal axes of the places, each in units of their spread: so a
// site along a pipe is as well conditioned as a round one.
struct Trend {
  std::array<std::array<double, 3>, thin_plate_max> at{};
  std::array<double, 3> here{};
  std::size_t size = 0;  // 0: there is none
};

Trend trend_of(std::span<const Offset> places) {
  const auto count = static_cast<double>(places.size());
  Offset mean;
  for (const Offset& place : places) {
    mean.x += place.x / count;
    mean.y += place.y / count;
  }
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (const Offset& place : places) {
    xx += (place.x - mean.x) * (place.x - mean.x);
    xy += (place.x - mean.x) * (place.y - mean.y);
    yy += (place.y - mean.y) * (place.y - mean.y);
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  // x along the line that fits best, y beside it.
  const auto turned = [&](const Offset& place) {
    return Offset{c * (place.x - mean.x) + s * (place.y - mean.y),
                  c * (place.y - mean.y) - s * (place.x - mean.x)};
  };
  double spread_u = 0;
  double spread_v = 0;
  for (const Offset& place : places) {
    const auto [u, v] = turned(place);
    spread_u += u * u / count;
    spread_v += v * v / count;
  }
  spread_u = std::sqrt(spread_u);
  spread_v = std::sqrt(spread_v);
  const auto [here_u, here_v] = turned({});
  Trend trend;
  if (spread_v > line_tolerance * spread_u) {
    trend.size = 3;
  } else if (spread_u > 0 && std::abs(here_v) <= line_tolerance * spread_u) {
    trend.size = 2;
    spread_v = 1;
  }
  if (trend.size == 0 || places.size() < trend.size) return {};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto [u, v] = turned(places[i]);
    trend.at[i] = {1, u / spread_u, v / spread_v};
  }
  trend.here = {1, here_u / spread_u, here_v / spread_v};
  return trend;
}

// Gauss and Jordan in place, with partial pivoting; false where it is singular.
bool invert(Matrix& matrix, std::size_t size) {
  std::array<std::size_t, system_max> pivot{};
  for (std::size_t k = 0; k < size; ++k) {
    std::size_t best = k;
    for (std::size_t row = k + 1; row < size; ++row) {
      if (std::abs(matrix[row][k]) > std::abs(matrix[best][k])) best = row;
    }
    if (!(std::abs(matrix[best][k]) > 1e-14)) return false;
    std::swap(matrix[k], matrix[best]);
    pivot[k] = best;
    const double scale = 1 / matrix[k][k];
    matrix[k][k] = 1;
    for (std::size_t column = 0; column < size; ++column) matrix[k][column] *= scale;
    for (std::size_t row = 0; row < size; ++row) {
      if (row == k) continue;
      const double factor = std::exchange(matrix[row][k], 0);
      for (std::size_t column = 0; column < size; ++column) {
        matrix[row][column] -= factor * matrix[k][column];
      }
    }
  }
  for (std::size_t k = size; k-- > 0;) {
    for (std::size_t row = 0; row < size; ++row) std::swap(matrix[row][k], matrix[row][pivot[k]]);
  }
  return true;
}

}  // namespace

bool ThinPlate::fit(std::span<const Offset> places, double smoothing) {
  size_ = places.size();
  const Trend trend = trend_of(places);
  if (trend.size == 0) return false;
  trend_size_ = trend.size;
  double farthest = 0;
  for (const Offset& place : places) farthest = std::max(farthest, std::hypot(place.x, place.y));
  const auto between = [&](std::size_t i, const Offset& to) {
    return kernel((places[i].x - to.x) / farthest, (places[i].y - to.y) / farthest);
  };

  Matrix inverse{};
  for (std::size_t i = 0; i < size_; ++i) {
    for (std::size_t j = 0; j < size_; ++j) inverse[i][j] = between(i, places[j]);
    inverse[i][i] = smoothing;
    for (std::size_t t = 0; t < trend.size; ++t) {
      inverse[i][size_ + t] = inverse[size_ + t][i] = trend.at[i][t];
    }
  }
  if (!invert(inverse, size_ + trend.size)) return false;

  double squares = 0;
  double to_here = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    double weight = 0;
    for (std::size_t j = 0; j < size_; ++j) weight += inverse[i][j] * between(j, {});
    for (std::size_t t = 0; t < trend.size; ++t) weight += inverse[i][size_ + t] * trend.here[t];
    weight_[i] = weight;
    squares += weight * weight;
    to_here += weight * between(i, {});
  }
  noise_gain_ = std::sqrt(squares);
  if (!(noise_gain_ <= noise_gain_max)) return false;

  // The kriging variance in units of the scale of the covariance: that of the contrast between the
  // reading here and its prediction.
  double among = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    for (std::size_t j = 0; j < size_; ++j) {
      among += weight_[i] * weight_[j] * (i == j ? smoothing : between(i, places[j]));
    }
  }
  variance_factor_ = std::max(0.0, smoothing + among - 2 * to_here);
  double trace = 0;
  for (std::size_t i = 0, k = 0; i < size_; ++i) {
    for (std::size_t j = 0; j <= i; ++j, ++k) roughness_[k] = (i == j ? 1 : 2) * inverse[i][j];
    trace += inverse[i][i];
  }
  deviation_of_noise_ = has_deviation() ? deviation_of(trace) : 0;
  return true;
}

double ThinPlate::value(std::span<const double> values) const {
  // Differences from one of them: where all are equal, so is the sum, to the last bit.
  double sum = 0;
  for (std::size_t i = 0; i < size_; ++i) sum += weight_[i] * (values[i] - values[0]);
  return values[0] + sum;
}

double ThinPlate::deviation(std::span<const double> values) const {
  double form = 0;
  for (std::size_t i = 0, k = 0; i < size_; ++i) {
    double row = 0;
    for (std::size_t j = 0; j <= i; ++j, ++k) row += roughness_[k] * (values[j] - values[0]);
    form += row * (values[i] - values[0]);
  }
  return deviation_of(form);
}

// The scale by restricted maximum likelihood (Cressie, section 2.6).
double ThinPlate::deviation_of(double form) const {
  const auto freedom = static_cast<double>(size_ - trend_size_);
  return std::sqrt(std::max(0.0, form) / freedom * variance_factor_);
}

}  // namespace etcm::firmware
