// A site gets another plane while a device is silent: it stands where it did, and nowhere else.
#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "device_test.h"
#include "memory_store.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class PlaneChange : public DeviceTest {
 protected:
  PlaneChange() {
    // The node of our own counts in units of the mesh, the rovers in what the site counts in.
    const NodeRegisters registers = encode_node(
        {.serial = Serial{9}, .position = {50, 60}, .status = node_status::fix_valid}, 7);
    bus_.put(1, 0, {registers.begin(), registers.end()});
    put_rover(2, 100, -10);
    put_rover(3, 0, 200);
  }
  void put_rover(std::uint8_t unit, std::int16_t x, std::int16_t y) {
    bus_.put(unit, 10, {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
  }
  static std::string text(const std::string& plane) {
    return "[site]\n" + plane + R"(
[[profile]]
name = "rover"
x = { register = 10, type = "i16" }
y = { register = 11, type = "i16" }
[[profile]]
name = "tracker"
serial = { register = 12, type = "u16" }
x = { register = 10, type = "i16" }
y = { register = 11, type = "i16" }
)" + device_line +
           "[[bus.device]]\nunits = \"2-3\"\nprofile = \"rover\"\n"
           "[[bus.device]]\nunits = \"4\"\nprofile = \"tracker\"\n";
  }
  // The rig begins with settings that save.
  void start_saving(Rig& rig, const std::string& plane) {
    std::vector<std::string> mistakes;
    rig.settings = read_configuration(folder_.write("site.toml", text(plane)), nullptr, mistakes);
    ASSERT_TRUE(mistakes.empty()) << mistakes.front();
    rig.settings.state = StateSettings{.folder = "/state", .interval = 1s};
    rig.settings.files = FileSettings{.folder = "", .name = "", .interval = 500ms};
    rig.store = &store_;
    rig.start_with({&bus_});
    rig.gateway->restore(rig.clock.now());
  }
  // A life of the rig that has been saved; these are silent from then on.
  void live_and_end(const std::string& plane, std::initializer_list<int> silent) {
    start_saving(rig_, plane);
    rig_.run(3s);
    rig_.gateway->finish(rig_.clock.now());
    for (const int unit : silent) bus_.silence(static_cast<std::uint8_t>(unit));
  }
  void reload(Rig& rig, const std::string& plane) {
    std::vector<std::string> mistakes;
    const Settings next =
        read_configuration(folder_.write("site.toml", text(plane)), nullptr, mistakes);
    ASSERT_TRUE(mistakes.empty()) << mistakes.front();
    rig.settings.site = next.site;
    rig.update_settings();
  }
  // By serial.
  using Places = std::map<std::uint32_t, std::pair<std::int64_t, std::int64_t>>;
  static Places nodes(const Rig& rig) {
    Places found;
    for (const SnapshotVertex& vertex : rig.gateway->snapshot().vertices) {
      if (vertex.kind != VertexKind::node) continue;
      found[vertex.serial.value] = {vertex.point.x / subunits_per_unit,
                                    vertex.point.y / subunits_per_unit};
    }
    return found;
  }

  MemoryStore store_;
};

TEST_F(PlaneChange, ASilentDeviceStandsWhereItDidAfterAReload) {
  start_saving(rig_, "unit = \"1\"\n");
  rig_.run(1s);
  ASSERT_EQ(nodes(rig_), (Places{{9, {50, 60}}, {1002, {100, -10}}, {1003, {0, 200}}}));
  bus_.silence(3);
  rig_.run(500ms);
  reload(rig_, "unit = \"0.5\"\norigin = [\"10\", \"0\"]\n");
  rig_.run(300ms);
  EXPECT_EQ(rig_.log.count("the site has another plane: 2 devices stand where before"), 1u);
  EXPECT_EQ(nodes(rig_), (Places{{9, {50, 60}}, {1002, {180, -20}}, {1003, {-20, 400}}}));
}

TEST_F(PlaneChange, OneThatAnotherHasReplacedStandsWhereItDidToo) {
  bus_.put(4, 10, {30, 40, 71});
  start_saving(rig_, "unit = \"1\"\n");
  rig_.run(1s);
  // The one that was there is sought, and not missed yet.
  bus_.put(4, 10, {30, 41, 72});
  rig_.run(1s);
  const NodeRecord* const before = rig_.gateway->nodes().find(Serial{71});
  ASSERT_NE(before, nullptr);
  ASSERT_TRUE(before->unit_index.is_none());
  ASSERT_FALSE(before->is_missing);
  reload(rig_, "unit = \"0.5\"\norigin = [\"10\", \"0\"]\n");
  rig_.run(300ms);
  const Places places = nodes(rig_);
  EXPECT_EQ(places.at(71), (std::pair<std::int64_t, std::int64_t>{40, 80}));
  EXPECT_EQ(places.at(72), (std::pair<std::int64_t, std::int64_t>{40, 82}));
}

TEST_F(PlaneChange, ASilentDeviceStandsWhereItDidAfterARestart) {
  live_and_end("unit = \"1\"\n", {1, 3});
  Rig after;
  start_saving(after, "unit = \"0.5\"\norigin = [\"10\", \"0\"]\n");
  EXPECT_EQ(nodes(after), (Places{{9, {50, 60}}, {1002, {180, -20}}, {1003, {-20, 400}}}));
  after.run(500ms);
  EXPECT_EQ(nodes(after), (Places{{9, {50, 60}}, {1002, {180, -20}}, {1003, {-20, 400}}}));
  EXPECT_EQ(after.log.count("no place in the plane"), 0u);
}

TEST_F(PlaneChange, OneThatIsMissingComesToNoFalsePlace) {
  start_saving(rig_, "unit = \"1\"\n");
  rig_.run(1s);
  bus_.silence(3);
  rig_.run(5s);
  const NodeRecord* node = rig_.gateway->nodes().find(Serial{1003});
  ASSERT_NE(node, nullptr);
  ASSERT_TRUE(node->is_missing);
  reload(rig_, "unit = \"0.5\"\n");
  EXPECT_EQ(node->position, (Position{0, 400}));
  rig_.run(2s);
  rig_.gateway->finish(rig_.clock.now());
  Rig after;
  start_saving(after, "unit = \"2\"\n");
  node = after.gateway->nodes().find(Serial{1003});
  ASSERT_NE(node, nullptr);
  EXPECT_TRUE(node->is_missing);
  EXPECT_EQ(node->position, (Position{0, 100}));
}

TEST_F(PlaneChange, WhatLiesBeyondTheNewPlaneHasNoPlaceUntilItIsHeard) {
  live_and_end("unit = \"1\"\n", {2, 3});
  const std::string far = "unit = \"0.00001\"\norigin = [\"100\", \"0\"]\n";
  Rig after;
  start_saving(after, far);
  EXPECT_EQ(nodes(after), (Places{{9, {50, 60}}, {1002, {0, -1'000'000}}}));
  EXPECT_EQ(after.log.count("1 device has no place in the plane of the site until heard"), 1u);

  // The same by a reload.
  put_rover(2, 100, -10);
  put_rover(3, 0, 200);
  Rig other;
  start_saving(other, "unit = \"1\"\n");
  other.run(1s);
  ASSERT_EQ(nodes(other).size(), 3u);
  bus_.silence(3);
  other.run(300ms);
  reload(other, far);
  other.run(300ms);
  EXPECT_EQ(nodes(other), (Places{{9, {50, 60}}, {1002, {0, -1'000'000}}}));
}

TEST_F(PlaneChange, TheSamePlaneKeepsTheMesh) {
  live_and_end("unit = \"0.5\"\norigin = [\"10\", \"0\"]\n", {1, 2, 3});
  const Places there = nodes(rig_);
  Rig after;
  start_saving(after, "origin = [\"10\", \"0\"]\nunit = \"0.5\"\n");
  EXPECT_EQ(nodes(after), there);
  EXPECT_EQ(after.log.count("restored the mesh of generation"), 1u);
}

}  // namespace
}  // namespace etcm::firmware
