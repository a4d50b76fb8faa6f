// What helps to find a fault from afar, in one archive.
#pragma once

#include <string>

namespace etcm::firmware {

struct BundleOptions {
  std::string config{};  // empty: that of the gateway that runs, else the one that is installed
  std::string output{};  // empty: named after the time
};

// Passwords and keys are in files of their own, and these are left out. What cannot be had is named
// in it. Says on the standard output which file it is, and returns the status to end with.
int make_bundle(const std::string& socket, const BundleOptions& options);

}  // namespace etcm::firmware
