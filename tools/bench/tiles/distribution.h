// How something is spread over tiles, or over what happens on them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace etcm::bench {

class Distribution {
 public:
  // `times` as if it had been added so often.
  void add(double value, std::size_t times = 1) {
    if (times == 0) return;
    values_.push_back({.value = value, .times = times});
    count_ += times;
    sum_ += value * static_cast<double>(times);
  }
  std::size_t count() const { return count_; }
  double mean() const { return count_ == 0 ? 0 : sum_ / static_cast<double>(count_); }
  // The least value that this share of all does not exceed; 1 is the worst.
  double quantile(double share);
  // Mean, 99 % and worst, as a cell of a table.
  std::string text(int decimals);

 private:
  struct Value {
    double value;
    std::size_t times;
  };
  std::vector<Value> values_;
  std::size_t count_ = 0;
  double sum_ = 0;
};

}  // namespace etcm::bench
