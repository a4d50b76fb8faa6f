// How it went to put something on a disk.
#pragma once

#include <string_view>

namespace etcm::port {

struct DiskResult {
  bool ok = false;
  std::string_view why;  // what failed, and the cure; valid until the next call
};

}  // namespace etcm::port
