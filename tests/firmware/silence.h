// What tests of silence ask of a gateway.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "fakes.h"

namespace etcm::firmware {

// Many times leave_after.
inline constexpr port::Duration long_silence = std::chrono::minutes(5);

inline std::string logged(const Rig& rig) { return testing::PrintToString(rig.log.lines); }

inline void expect_nobody_left(const Rig& rig) {
  EXPECT_EQ(rig.log.count("left (silent)"), 0u) << logged(rig);
  EXPECT_EQ(rig.log.count("is missing"), 0u) << logged(rig);
}

}  // namespace etcm::firmware
