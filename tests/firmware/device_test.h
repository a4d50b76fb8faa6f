// A gateway on a line with devices, from the text of its settings on.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "device_bus.h"
#include "fakes.h"
#include "firmware/config/configuration.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {

// What settings of such a gateway have between their profiles and their devices.
inline const std::string device_line = R"(
[mesh]
vertices_max = 100
[poll]
interval = "100ms"
timeout = "50ms"
stale_after = "1s"
leave_after = "3s"
[[bus]]
tcp = "127.0.0.1:502"
name = "yard"
outstanding = 1
units = "1"
)";

class DeviceTest : public testing::Test {
 protected:
  void start(const std::string& text, port::ProjectionSource* projections = nullptr) {
    std::vector<std::string> mistakes;
    rig_.settings = read_configuration(folder_.write("site.toml", text), projections, mistakes);
    ASSERT_TRUE(mistakes.empty()) << mistakes.front();
    rig_.settings.files =
        FileSettings{.folder = "", .name = "", .interval = std::chrono::milliseconds(500)};
    rig_.start_with({&bus_});
  }

  test::ScratchFolder folder_;
  DeviceBus bus_;
  Rig rig_;
};

}  // namespace etcm::firmware
