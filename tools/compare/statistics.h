// The few figures that the tables and fits need.
#pragma once

#include <span>
#include <vector>

namespace etcm::compare {

struct Spread {
  double lower = 0;  // quartile
  double median = 0;
  double upper = 0;
};
// Quartiles by linear interpolation; zeros without values.
Spread spread_of(std::vector<double> values);

// y = slope * x + offset by least squares.
struct FittedLine {
  double slope = 0;
  double offset = 0;
  double r_squared = 0;
  // Standard deviation of y about the line, over the mean of y.
  double relative_residual = 0;
};
// Needs as many y as x, at least three, not all x alike.
FittedLine fit_line(std::span<const double> x, std::span<const double> y);

}  // namespace etcm::compare
