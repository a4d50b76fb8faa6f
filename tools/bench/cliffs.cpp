#include "bench/cliffs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <ostream>
#include <stdexcept>
#include <vector>

#include "bench/cliff_families.h"

namespace etcm::bench {
namespace {

constexpr std::size_t sizes_count = 4;
constexpr int repetitions = 3;
constexpr double seconds_most = 5;

// What takes a moment is measured more than once, for the least time.
Cost least_cost(const CliffFamily& family, std::size_t n) {
  Cost least = family.cost(n);
  for (int i = 1; i < repetitions && least.seconds < 1; ++i) {
    least.seconds = std::min(least.seconds, family.cost(n).seconds);
  }
  return least;
}

// The slope of a straight line through logarithms: sizes double, so these are 0, 1, 2, ...
double exponent_of(const std::vector<double>& seconds) {
  const auto count = static_cast<double>(seconds.size());
  const double middle = (count - 1) / 2;
  double products = 0, squares = 0;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    products += x * std::log2(seconds[i]);
    squares += x * x;
  }
  return products / squares;
}

void print_row(const CliffFamily& family, std::ostream& out) {
  out << "| " << family.name << " | " << family.size_min << " | " << std::flush;
  std::vector<double> seconds;
  std::size_t n = family.size_min;
  for (std::size_t i = 0; i < sizes_count; ++i, n *= 2) {
    if (!seconds.empty() && seconds.back() > seconds_most) {
      out << "| ";
      continue;
    }
    seconds.push_back(least_cost(family, n).seconds);
    out << std::fixed << std::setprecision(1) << 1e3 * seconds.back() << " | " << std::flush;
  }
  out << std::setprecision(2) << exponent_of(seconds) << " |\n";
}

void print_counted_row(const CliffFamily& family, std::ostream& out) {
  const Growth growth = growth_of(family);
  out << "| " << family.name << " | " << family.size_min << " | " << growth.units << " | "
      << std::fixed << std::setprecision(2) << growth.exponent << " |\n";
}

bool has(const CliffFamily& family, const std::string& filter) {
  return std::string(family.name).find(filter) != std::string::npos;
}

}  // namespace

bool print_cliffs(const std::string& filter, std::ostream& out) {
  out << "| what | n | ms | at 2 n | at 4 n | at 8 n | exponent |\n"
         "|---|---:|---:|---:|---:|---:|---:|\n";
  bool is_good = true;
  for (const CliffFamily& family : cliff_families()) {
    if (!has(family, filter)) continue;
    try {
      print_row(family, out);
    } catch (const std::runtime_error& error) {
      out << error.what() << " |\n";
      is_good = false;
    }
  }
  if (!is_good) return false;
  out << "\n| what | n | units | exponent |\n|---|---:|---:|---:|\n";
  for (const CliffFamily& family : cliff_families()) {
    if (has(family, filter)) print_counted_row(family, out);
  }
  return true;
}

}  // namespace etcm::bench
