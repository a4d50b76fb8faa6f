// A site of several gateways that lives through a schedule of faults and then rests.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gateway_model.h"

namespace etcm::test {

// What may happen; each is drawn by chance from the seed.
struct Theme {
  const char* name;
  bool deaths = false;   // of gateways, at any message, with or without their disks
  bool cuts = false;     // of single connections
  bool splits = false;   // of the site, at the bridge
  bool forgets = false;  // brokers that start again and have lost something
  bool doubles = false;  // messages that come again
  bool twins = false;    // two programs with one name
  bool rubbish = false;  // from gateways and strangers
  bool clocks = false;   // that differ and stand still; times of day that are wrong and jump
};

struct Outcome {
  std::string wrong;          // empty: all was as it should be
  double agreed_after_s = 0;  // from the last fault
  std::uint64_t messages = 0;
  std::uint32_t nodes = 0;  // in the end
};

Outcome simulate(const Theme& theme, std::uint64_t seed);

}  // namespace etcm::test
