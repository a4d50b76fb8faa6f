// Devices that somebody else made, from the settings to the mesh.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "device_test.h"
#include "firmware/polling/device.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

// Position of 32 bits in two blocks far apart, and whether it is good in the second.
const std::string settings_text = R"(
[[profile]]
name = "rover"
function = 4
valid = { register = 500, equals = 1 }
x = { register = 10, type = "i32", scale = "0.001" }
y = { register = 501, type = "i32", scale = "0.001" }
[[profile]]
name = "meter"
[[profile.reading]]
name = "level"
value = { register = 3, type = "u16" }
)" + device_line + R"([[bus.device]]
units = "2-3"
profile = "rover"
[[bus.device]]
units = "7"
profile = "meter"
pause = "40ms"
[[node]]
unit = 7
x = "2.6"
y = "-400"
)";

class Devices : public DeviceTest {
 protected:
  void start(const std::string& more = "") { DeviceTest::start(settings_text + more); }
  void start_at_speed(const std::string& speed_max) {
    std::string text = settings_text;
    const std::string rovers = "units = \"2-3\"\n";
    text.insert(text.find(rovers), "speed_max = \"" + speed_max + "\"\n");
    DeviceTest::start(text);
  }
  // A node of our own.
  void put_node(std::uint8_t unit, std::int32_t x, std::int32_t y) {
    const NodeRegisters registers =
        encode_node({.serial = Serial{9}, .position = {x, y}, .status = node_status::fix_valid}, 7);
    bus_.put(unit, 0, {registers.begin(), registers.end()});
  }
  void put_rover(std::uint8_t unit, std::int32_t x_mm, std::int32_t y_mm, bool is_valid = true) {
    const auto high = [](std::int32_t value) {
      return static_cast<std::uint16_t>(static_cast<std::uint32_t>(value) >> 16);
    };
    bus_.put(unit, 10, {high(x_mm), static_cast<std::uint16_t>(x_mm)});
    bus_.put(unit, 500, {is_valid, high(y_mm), static_cast<std::uint16_t>(y_mm)});
  }
  // Where the nodes of the mesh are, by serial.
  std::map<std::uint32_t, std::pair<std::int64_t, std::int64_t>> nodes() const {
    std::map<std::uint32_t, std::pair<std::int64_t, std::int64_t>> found;
    for (const SnapshotVertex& vertex : rig_.gateway->snapshot().vertices) {
      if (vertex.kind != VertexKind::node) continue;
      found[vertex.serial.value] = {vertex.point.x / subunits_per_unit,
                                    vertex.point.y / subunits_per_unit};
    }
    return found;
  }
};

using Places = std::map<std::uint32_t, std::pair<std::int64_t, std::int64_t>>;

TEST_F(Devices, OfThreeKindsAreInOneMesh) {
  put_node(1, 50, 60);
  put_rover(2, 100'400, -7'600);
  put_rover(3, 0, 200'500);
  bus_.put(7, 3, {1234});
  start();
  rig_.run(1s);
  EXPECT_EQ(nodes(),
            (Places{{9, {50, 60}}, {1002, {100, -8}}, {1003, {0, 201}}, {1007, {3, -400}}}));
  EXPECT_EQ(rig_.gateway->snapshot().state, 0);
}

TEST_F(Devices, AreReadInTheFewestBlocksWithTheirFunction) {
  put_rover(2, 0, 0);
  start();
  rig_.run(300ms);
  std::vector<DeviceBus::Asked> of_rover;
  for (DeviceBus::Asked asked : bus_.asked) {
    asked.at = {};
    if (asked.address == 2) of_rover.push_back(asked);
  }
  const std::vector<DeviceBus::Asked> sweep = {{2, port::RegisterKind::input, 10, 2, {}},
                                               {2, port::RegisterKind::input, 500, 3, {}}};
  ASSERT_GE(of_rover.size(), 2u);
  EXPECT_EQ((std::vector(of_rover.begin(), of_rover.begin() + 2)), sweep);
}

TEST_F(Devices, APositionThatJumpsIsAskedForOnceMoreBeforeItCounts) {
  put_rover(2, 100'000, 100'000);
  start_at_speed("30");
  rig_.run(500ms);
  ASSERT_EQ(nodes().at(1002), (std::pair<std::int64_t, std::int64_t>{100, 100}));
  // One sweep is torn: its x is that of a place where the device comes later.
  put_rover(2, 900'000, 100'000);
  bus_.on_answer = [&](const DeviceBus::Asked& asked) {
    if (asked.address == 2 && asked.first == 500) put_rover(2, 100'000, 100'000);
  };
  rig_.run(300ms);
  EXPECT_EQ(nodes().at(1002), (std::pair<std::int64_t, std::int64_t>{100, 100}));
  const UnitIndex unit = rig_.gateway->poller().unit_at(BusIndex{0}, ModbusAddress{2});
  EXPECT_EQ(rig_.gateway->poller().counters(unit).jumped, 1u);
  // It is carried there for good: told twice.
  bus_.on_answer = nullptr;
  put_rover(2, 900'000, 100'000);
  rig_.run(300ms);
  EXPECT_EQ(nodes().at(1002), (std::pair<std::int64_t, std::int64_t>{900, 100}));
  EXPECT_EQ(rig_.gateway->poller().counters(unit).jumped, 1u);
  EXPECT_EQ(rig_.log.count("jumps farther"), 0u);
}

TEST_F(Devices, PositionsThatNeverAgreeAreDroppedAndTheLogSaysSo) {
  put_rover(2, 100'000, 100'000);
  start_at_speed("0.5");
  rig_.run(500ms);
  std::int32_t place = 1;
  bus_.on_answer = [&](const DeviceBus::Asked& asked) {
    if (asked.address != 2 || asked.first != 500) return;
    place = place % 7 + 1;
    put_rover(2, place * 1'000'000, -place * 1'000'000);
  };
  rig_.run(2500ms);
  EXPECT_EQ(nodes().at(1002), (std::pair<std::int64_t, std::int64_t>{100, 100}));
  const UnitIndex unit = rig_.gateway->poller().unit_at(BusIndex{0}, ModbusAddress{2});
  EXPECT_GE(rig_.gateway->poller().counters(unit).jumped, 3u);
  EXPECT_EQ(rig_.log.count("unit 2 of yard: its position jumps farther than speed_max allows"), 1u);
}

// Half of the old place and half of the new one would be a place where it never was.
TEST_F(Devices, APlaceComesFromOneCompleteSweep) {
  put_rover(2, 100'000, 100'000);
  start();
  rig_.run(500ms);
  ASSERT_TRUE(nodes().contains(1002));
  int second_blocks = 0;
  bus_.on_answer = [&](const DeviceBus::Asked& asked) {
    if (asked.address != 2 || asked.first != 10 || ++second_blocks != 1) return;
    // The second block of this sweep is lost; meanwhile the device moves.
    put_rover(2, 900'000, 900'000);
    bus_.devices[2].erase(500);
  };
  rig_.run(100ms);
  EXPECT_EQ(nodes().at(1002), (std::pair<std::int64_t, std::int64_t>{100, 100}));
  put_rover(2, 900'000, 900'000);
  rig_.run(2s);
  EXPECT_EQ(nodes().at(1002), (std::pair<std::int64_t, std::int64_t>{900, 900}));
}

TEST_F(Devices, ASweepWhoseNextBlockHasToWaitBeginsAnew) {
  put_rover(2, 100'000, 100'000);
  start();
  rig_.run(500ms);
  bus_.on_answer = [&](const DeviceBus::Asked& asked) {
    bus_.is_closed = bus_.is_closed || (asked.address == 2 && asked.first == 10);
  };
  rig_.run(30s);
  ASSERT_TRUE(bus_.is_closed);
  put_rover(2, 900'000, 900'000);
  bus_.on_answer = nullptr;
  bus_.is_closed = false;
  const Places before{{1002, {100, 100}}}, after{{1002, {900, 900}}};
  for (int i = 0; i < 100; ++i) {
    rig_.run(10ms);
    EXPECT_TRUE(nodes() == before || nodes() == after || nodes().empty());
  }
  EXPECT_EQ(nodes(), after);
}

TEST_F(Devices, AnInvalidPlaceIsNone) {
  put_rover(2, 100'000, 100'000, false);
  start();
  rig_.run(500ms);
  EXPECT_TRUE(nodes().empty());
  EXPECT_EQ(rig_.gateway->snapshot().waiting_count, 1u);
  put_rover(2, 100'000, 100'000);
  rig_.run(500ms);
  EXPECT_EQ(nodes().size(), 1u);
}

TEST_F(Devices, APlaceBeyondThePlaneIsNamedWithItsCure) {
  put_rover(2, 0, 0);
  start("[site]\nunit = \"0.0001\"\n");
  put_rover(2, 2'000'000, 0);
  rig_.run(500ms);
  EXPECT_EQ(
      rig_.log.count(
          "beyond the plane of the mesh: correct 'order', 'scale' or 'format' in its profile"),
      1u);
}

TEST_F(Devices, ASurveyedOneIsThereWhileItsUnitAnswers) {
  put_rover(2, 0, 0);
  bus_.put(7, 3, {1234});
  start();
  rig_.run(500ms);
  ASSERT_TRUE(nodes().contains(1007));
  bus_.silence(7);
  rig_.run(5s);
  EXPECT_FALSE(nodes().contains(1007));
  EXPECT_EQ(rig_.gateway->snapshot().missing_count, 1u);
  bus_.put(7, 3, {0});
  rig_.run(3s);
  EXPECT_TRUE(nodes().contains(1007)) << "a replaced device is the same node";
}

TEST_F(Devices, ThatNeverAnswerAreAbsentWhereTheyWereSurveyed) {
  put_rover(2, 0, 0);
  start();
  rig_.run(2900ms);
  EXPECT_EQ(rig_.gateway->snapshot().absent_count, 0u) << "leave_after has not passed";
  EXPECT_EQ(rig_.log.count("has not answered since the start"), 0u);
  rig_.run(1500ms);
  EXPECT_EQ(rig_.log.count("unit 7 of yard has not answered since the start; look at its supply"),
            1u);
  const Snapshot& snapshot = rig_.gateway->snapshot();
  EXPECT_EQ(snapshot.absent_count, 2u) << "units 3 and 7";
  EXPECT_EQ(snapshot.missing_count, 0u);
  ASSERT_EQ(snapshot.unplaced_nodes.size(), 1u) << "unit 3 tells its place itself";
  EXPECT_EQ(snapshot.unplaced_nodes[0].serial, Serial{1007});
  EXPECT_TRUE(snapshot.unplaced_nodes[0].is_absent);
  EXPECT_EQ(snapshot.unplaced_nodes[0].position, (Position{3, -400}));
  bus_.put(7, 3, {1234});
  rig_.run(30s);
  EXPECT_EQ(rig_.gateway->snapshot().absent_count, 1u);
  EXPECT_TRUE(rig_.gateway->snapshot().unplaced_nodes.empty());
  EXPECT_EQ(rig_.log.count("has not answered since the start"), 2u) << "each once";
  // Who was there is missing from then on.
  bus_.silence(7);
  rig_.run(5s);
  EXPECT_EQ(rig_.gateway->snapshot().absent_count, 1u);
  EXPECT_EQ(rig_.gateway->snapshot().missing_count, 1u);
}

TEST_F(Devices, HaveTheSerialThatTheyAreGiven) {
  put_rover(2, 0, 0);
  start("[[node]]\nunit = 2\nserial = 77\n");
  rig_.run(500ms);
  EXPECT_EQ(nodes(), (Places{{77, {0, 0}}}));
}

TEST_F(Devices, TellTheirSerialWhereTheyHaveOne) {
  std::string text = R"(
[[profile]]
name = "named"
serial = { register = 20, type = "u32" }
x = { register = 30, type = "i16" }
y = { register = 31, type = "i16" }
[[bus]]
tcp = "127.0.0.1:503"
name = "gate"
outstanding = 1
[[bus.device]]
units = "5"
profile = "named"
)";
  DeviceBus gate;
  gate.put(5, 20, {1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 10, 20});
  std::vector<std::string> mistakes;
  rig_.settings =
      read_configuration(folder_.write("site.toml", settings_text + text), nullptr, mistakes);
  ASSERT_FALSE(mistakes.empty()) << "two buses, and a [[node]] that names none";
  text = "[[node]]\nbus = \"gate\"\nunit = 5\nx = 9\ny = 9\n" + text;
  std::string all = settings_text;
  all.replace(all.find("[[node]]\n"), 9, "[[node]]\nbus = \"yard\"\n");
  mistakes.clear();
  rig_.settings = read_configuration(folder_.write("site.toml", all + text), nullptr, mistakes);
  ASSERT_TRUE(mistakes.empty()) << mistakes.front();
  rig_.settings.files = FileSettings{.folder = "", .name = "", .interval = 500ms};
  rig_.start_with({&bus_, &gate});
  rig_.run(500ms);
  EXPECT_EQ(nodes(), (Places{{65538, {9, 9}}})) << "surveyed comes before told";
}

// DeviceBus fails the test at any write.
TEST_F(Devices, AreToldNothing) {
  for (const std::uint8_t unit : {std::uint8_t{2}, std::uint8_t{3}})
    put_rover(unit, 1000 * unit, 0);
  bus_.put(7, 3, {1});
  start("[write_back]\nenabled = true\n");
  rig_.run(3s);
  EXPECT_EQ(nodes().size(), 3u);
}

TEST_F(Devices, TheBusIsSilentForThePauseAfterAnAnswer) {
  put_node(1, 0, 0);
  bus_.put(7, 3, {1});
  start();
  rig_.run(2s);
  int pauses = 0;
  for (std::size_t i = 1; i < bus_.asked.size(); ++i) {
    if (bus_.asked[i - 1].address != 7) continue;
    ++pauses;
    EXPECT_GE(bus_.asked[i].at - bus_.asked[i - 1].at, bus_.latency + 40ms);
  }
  EXPECT_GT(pauses, 10);
}

}  // namespace
}  // namespace etcm::firmware
