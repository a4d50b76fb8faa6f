// A field that lives: what a site of sensors reads from minute to minute.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "simulated_site.h"

namespace etcm::test {

struct FieldManner {
  double noise = 0.01;       // standard deviation, of the range of the field
  double length = 0.4;       // of its correlation, of the side of the site
  double common_swing = 1;   // of the whole field within a day
  double shape_swing = 0.1;  // of each of its patterns within a day, for itself
  double front_step = 0;     // a step of this height passes the site
  int front_samples = 60;    // and takes so long
  int front_at = 0;          // from this sample on
};

// Values of a field with range 1, one sample a minute. Standard deviations are those of normal
// noise, the same on every machine up to its logarithm.
class MovingField {
 public:
  MovingField(const firmware::Snapshot& snapshot, const FieldManner& manner, std::uint64_t seed);

  // The next sample; good until the next call, and free to be spoiled.
  std::vector<double>& next();
  int sample() const { return sample_; }
  std::vector<double>& last() { return values_; }

 private:
  double normal();

  static constexpr int pattern_count = 4;
  FieldManner manner_;
  std::vector<double> pattern_[pattern_count];
  double phase_[pattern_count + 1];
  std::vector<double> along_;  // the way of the front, 0 to 1
  std::vector<double> values_;
  std::mt19937_64 random_;
  double spare_normal_ = 0;
  bool has_spare_ = false;
  int sample_ = 0;
};

}  // namespace etcm::test
