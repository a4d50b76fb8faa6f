#include "bench/tiles/distribution.h"

#include <cstdio>

namespace etcm::bench {

double Distribution::quantile(double share) {
  std::sort(values_.begin(), values_.end(),
            [](const Value& a, const Value& b) { return a.value < b.value; });
  std::size_t seen = 0;
  for (const Value& each : values_) {
    seen += each.times;
    if (static_cast<double>(seen) >= share * static_cast<double>(count_)) return each.value;
  }
  return values_.empty() ? 0 : values_.back().value;
}

std::string Distribution::text(int decimals) {
  char text[100];
  std::snprintf(text, sizeof text, "%.*f / %.*f / %.*f", std::max(1, decimals), mean(), decimals,
                quantile(0.99), decimals, quantile(1));
  return text;
}

}  // namespace etcm::bench
