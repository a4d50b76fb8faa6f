// What nodes are told of the mesh, and when.
#include "firmware/publish/neighbour_distributor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fakes.h"
#include "firmware/protocol/register_pairs.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class WritingBack : public testing::Test {
 protected:
  WritingBack() { rig_.settings.write_back.is_enabled = true; }

  void put(std::uint8_t unit, Position position, std::uint16_t boot_count = 0) {
    rig_.bus.set(unit, {.serial = Serial{1000u + unit},
                        .position = position,
                        .status = node_status::fix_valid,
                        .boot_count = boot_count});
  }
  struct DeliveredConfig {
    std::uint32_t generation = 0;
    std::vector<std::uint32_t> neighbours;
    friend bool operator==(const DeliveredConfig&, const DeliveredConfig&) = default;
  };
  // What stands in the registers of a unit.
  DeliveredConfig told(std::uint8_t unit) const {
    std::vector<std::uint16_t> registers(configuration_register_count);
    for (const ScriptedBus::Written& written : rig_.bus.written) {
      if (written.address != unit) continue;
      std::copy(written.values.begin(), written.values.end(),
                registers.begin() + written.first - configuration_register_first);
    }
    DeliveredConfig found{.generation = load_u32(registers, 0), .neighbours = {}};
    for (std::size_t i = 0; i < registers[2]; ++i) {
      found.neighbours.push_back(load_u32(registers, configuration_head_count + 2 * i));
    }
    return found;
  }
  std::string logged() const { return testing::PrintToString(rig_.log.lines); }

  Rig rig_;
};

using Serials = std::vector<std::uint32_t>;

TEST_F(WritingBack, EachNodeIsToldItsNeighboursAndTheGeneration) {
  put(1, {0, 0});
  put(2, {100, 0});
  put(3, {0, 100});
  rig_.run(1s);
  EXPECT_EQ(told(1).neighbours, (Serials{1002, 1003}));
  EXPECT_EQ(told(2).neighbours, (Serials{1001, 1003}));
  EXPECT_EQ(told(3).neighbours, (Serials{1001, 1002}));
  EXPECT_EQ(told(3).generation, rig_.gateway->generation());
  EXPECT_EQ(rig_.bus.written.size(), 3u) << "the third joined with the others";
}

// The mesh changes all the time, and masters see it a tenth of a second later.
TEST_F(WritingBack, AGenerationThatANodeIsToldHasBeenPublished) {
  put(1, {0, 0});
  put(2, {1000, 0});
  put(3, {0, 1000});
  rig_.run(10ms);
  std::size_t checked = 0;
  for (int step = 0; step < 500; ++step) {
    // From one side of the others to the opposite one: other neighbours each time.
    put(4, {step / 7 % 2 == 0 ? 2000 : -2000, step});
    rig_.run(10ms);
    for (; checked < rig_.bus.written.size(); ++checked) {
      const ScriptedBus::Written& written = rig_.bus.written[checked];
      ASSERT_EQ(written.first, configuration_register_first);
      const std::uint32_t generation = load_u32(written.values, 0);
      ASSERT_GE(generation, 1u);
      ASSERT_LE(generation, rig_.server.images.size()) << "not published yet";
      const Snapshot& snapshot = rig_.gateway->snapshot();
      // A step publishes last: what it wrote is of that generation, or of the one before.
      if (generation != snapshot.generation) continue;
      const auto row = std::find_if(snapshot.vertices.begin(), snapshot.vertices.end(),
                                    [&](const SnapshotVertex& vertex) {
                                      return vertex.kind == VertexKind::node &&
                                             vertex.serial == Serial{1000u + written.address};
                                    });
      ASSERT_NE(row, snapshot.vertices.end());
      Serials expected;
      for (const SnapshotNeighbour& neighbour :
           neighbours_of(snapshot, static_cast<std::uint32_t>(row - snapshot.vertices.begin()))) {
        expected.push_back(snapshot.vertices[neighbour.row].serial.value);
      }
      std::sort(expected.begin(), expected.end());
      ASSERT_EQ(told(written.address).neighbours, expected);
    }
  }
  EXPECT_GT(checked, 50u);
}

TEST_F(WritingBack, OnlyThoseWhoseNeighboursChangedAreWrittenAgain) {
  put(1, {0, 0});
  put(2, {100, 0});
  put(3, {0, 100});
  put(4, {-100, 0});
  put(5, {0, -100});
  rig_.run(1s);
  rig_.bus.written.clear();
  put(3, {0, 110});  // a new generation with the same edges
  rig_.run(1s);
  EXPECT_TRUE(rig_.bus.written.empty());
  put(6, {60, 60});
  rig_.run(1s);
  Serials units;
  for (const ScriptedBus::Written& written : rig_.bus.written) units.push_back(written.address);
  std::sort(units.begin(), units.end());
  EXPECT_EQ(units, (Serials{1, 2, 3, 6}));
}

TEST_F(WritingBack, NobodyIsWrittenWhereTheOperatorDidNotAskForIt) {
  rig_.settings.write_back.is_enabled = false;
  put(1, {0, 0});
  put(2, {100, 0});
  rig_.run(2s);
  EXPECT_TRUE(rig_.bus.writes.empty());
}

// Any number may wait there, and each would take it.
TEST_F(WritingBack, OneThatWaitsForAUnitOfItsOwnIsToldWhenItHasThat) {
  rig_.settings.buses[0].assign = {{.first = 10, .last = 10}};
  rig_.bus.set(10,
               {.serial = Serial{1010}, .position = {100, 0}, .status = node_status::fix_valid});
  put(1, {0, 0});
  put(247, {0, 100});
  rig_.run(3s);
  EXPECT_EQ(rig_.gateway->node_count(), 3u);
  EXPECT_EQ(rig_.log.count("no unit is free for node 1247"), 1u) << logged();
  EXPECT_EQ(told(1).neighbours, (Serials{1010, 1247}));
  EXPECT_EQ(std::ranges::count(rig_.bus.written, 247, &ScriptedBus::Written::address), 0);
  rig_.bus.silence(10);
  rig_.run(30s);
  EXPECT_EQ(rig_.log.count("node 1247 has unit 10 of yard now"), 1u) << logged();
  EXPECT_EQ(told(10).neighbours, (Serials{1001})) << "who left is no neighbour";
}

TEST_F(WritingBack, OneAtThatUnitOfABusThatGivesNoneIsToldToo) {
  rig_.settings.buses[0].units = {{.first = 1, .last = 1}, {.first = 247, .last = 247}};
  put(1, {0, 0});
  put(247, {0, 100});
  rig_.run(1s);
  EXPECT_EQ(told(247).neighbours, (Serials{1001}));
}

TEST_F(WritingBack, ANodeThatBootedIsToldAgain) {
  put(1, {0, 0});
  put(2, {100, 0});
  rig_.run(1s);
  rig_.bus.written.clear();
  put(1, {0, 0}, 1);
  rig_.run(1s);
  ASSERT_EQ(rig_.bus.written.size(), 1u);
  EXPECT_EQ(rig_.bus.written[0].address, 1);
}

TEST_F(WritingBack, ANodeThatDoesNotConfirmIsTriedThreeTimesThenWhenThingsChange) {
  put(1, {0, 0});
  rig_.bus.refuse_writes(1, port::BusResult::timeout);
  put(2, {100, 0});
  rig_.run(10s);
  EXPECT_EQ(rig_.bus.writes[1], 3u);
  EXPECT_EQ(rig_.bus.writes[2], 1u);
  EXPECT_EQ(rig_.log.count("node 1001 was not told its neighbours: no answer in time"), 1u)
      << logged();
  rig_.bus.refuse_writes(1, port::BusResult::ok);
  rig_.run(5s);
  EXPECT_EQ(rig_.bus.writes[1], 3u);
  put(3, {0, 100});
  rig_.run(2s);
  EXPECT_EQ(told(1).neighbours, (Serials{1002, 1003}));
}

TEST_F(WritingBack, ANodeWithoutSuchRegistersIsLeftAloneUntilItBoots) {
  put(1, {0, 0});
  rig_.bus.refuse_writes(1, port::BusResult::exception, 2);
  put(2, {100, 0});
  rig_.run(5s);
  put(3, {0, 100});
  rig_.run(5s);
  EXPECT_EQ(rig_.bus.writes[1], 1u);
  EXPECT_EQ(rig_.log.count("node 1001 has no registers for its neighbours"), 1u) << logged();
  rig_.bus.refuse_writes(1, port::BusResult::ok);
  put(1, {0, 0}, 5);
  rig_.run(1s);
  EXPECT_EQ(told(1).neighbours, (Serials{1002, 1003}));
}

TEST_F(WritingBack, AListThatIsLongerThanAWriteComesBeforeItsHead) {
  // A wheel: the hub has 99 neighbours, on a circle that has no whole numbers to spare.
  rig_.settings.buses[0].units = {{.first = 1, .last = 100}};
  rig_.settings.mesh.vertices_max = 200;
  put(1, {0, 0});
  for (int spoke = 0; spoke < 99; ++spoke) {
    const double angle = 2 * 3.14159265358979 * spoke / 99;
    put(static_cast<std::uint8_t>(spoke + 2),
        {static_cast<std::int32_t>(100000 * std::cos(angle)),
         static_cast<std::int32_t>(100000 * std::sin(angle))});
  }
  rig_.run(3s);
  ASSERT_EQ(rig_.mesh.neighbours(VertexId{1}, {}), 99u);
  EXPECT_EQ(told(1).neighbours.size(), 99u);
  EXPECT_EQ(told(1).neighbours.front(), 1002u);
  EXPECT_EQ(told(1).neighbours.back(), 1100u);
  std::vector<ScriptedBus::Written> of_hub;
  for (const ScriptedBus::Written& written : rig_.bus.written) {
    if (written.address == 1) of_hub.push_back(written);
  }
  ASSERT_GE(of_hub.size(), 3u);
  EXPECT_EQ(of_hub.back().first, 200);
  EXPECT_EQ(of_hub.back().values.size(), 3u);
  EXPECT_EQ(of_hub[of_hub.size() - 2].first, 203 + 122);
  EXPECT_EQ(of_hub[of_hub.size() - 3].first, 203);
  EXPECT_EQ(of_hub[of_hub.size() - 3].values.size(), 122u);
}

TEST_F(WritingBack, ANodeThatLeftIsToldThatItHasNoNeighbours) {
  put(1, {0, 0});
  put(2, {100, 0});
  rig_.run(1s);
  rig_.bus.set(1, {.serial = Serial{1001},
                   .position = {0, 0},
                   .status = node_status::fix_valid | node_status::leaving});
  rig_.run(1s);
  EXPECT_EQ(rig_.mesh.node_count(), 1u);
  EXPECT_EQ(told(1).neighbours, Serials{});
  EXPECT_EQ(told(2).neighbours, Serials{});
}

TEST_F(WritingBack, TheWordOrderOfTheBusIsHeeded) {
  std::array<std::uint16_t, configuration_register_count> registers{};
  const std::array neighbours{Serial{0x01020304}};
  EXPECT_EQ(encode_configuration(0x0a0b0c0d, neighbours, WordOrder::cdab, registers), 5u);
  EXPECT_EQ(registers[0], 0x0c0d);
  EXPECT_EQ(registers[2], 1);
  EXPECT_EQ(registers[3], 0x0304);
  encode_configuration(0x0a0b0c0d, neighbours, WordOrder::badc, registers);
  EXPECT_EQ(registers[0], 0x0b0a);
  EXPECT_EQ(registers[2], 0x0100);
  EXPECT_EQ(registers[3], 0x0201);
}

TEST_F(WritingBack, ABusyLineGivesItASixteenthOfItsTime) {
  rig_.bus.outstanding_max = 1;
  rig_.settings.buses[0].outstanding_max = 1;
  rig_.settings.poll.interval = 10ms;
  for (std::uint8_t unit = 1; unit <= 20; ++unit) put(unit, {unit * unit, 7 * unit % 11});
  rig_.run(20s);
  // Ever other neighbours for all.
  const auto reads = [&] {
    std::uint32_t sum = 0;
    for (const auto& [unit, count] : rig_.bus.reads) sum += count;
    return sum;
  };
  const std::uint32_t before = reads();
  std::uint32_t written = 0;
  for (int round = 0; round < 40; ++round) {
    const std::size_t count = rig_.bus.written.size();
    put(20, {round % 2 == 0 ? -500 : 500, round});
    rig_.run(500ms);
    written += static_cast<std::uint32_t>(rig_.bus.written.size() - count);
  }
  EXPECT_GT(written, 40u);
  EXPECT_GE(reads() - before, 1800u) << "of 2000 turns of the line";
}

// What a Steiner vertex beside a node stands for.
TEST(NeighbourList, AlongAFeatureTheNextNodeIsTheNeighbour) {
  Rig rig({feature(1001, 1002)});
  rig.put(1, 0, 0);
  rig.put(2, 1000, 0);
  rig.put(3, 500, 60);
  rig.put(4, 500, -60);
  rig.put(5, 300, 50);
  rig.run(1s);
  const Snapshot& snapshot = rig.gateway->snapshot();
  ASSERT_EQ(snapshot.node_count, 5u);
  ASSERT_EQ(snapshot.features_active, 1u);
  ASSERT_GT(snapshot.steiner_count, 0u);
  NeighbourList list(100);
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    if (snapshot.vertices[row].kind != VertexKind::node) continue;
    const std::uint32_t serial = snapshot.vertices[row].serial.value;
    const auto all = list.of(snapshot, row);
    const auto contains = [&](std::uint32_t other) {
      return std::find(all.begin(), all.end(), Serial{other}) != all.end();
    };
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
    EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
    EXPECT_FALSE(contains(serial));
    // Those beside the feature see its Steiner vertices, which are nobody's ends for them.
    if (serial <= 1002) {
      EXPECT_TRUE(contains(2003 - serial));
    }
    for (const Serial other : all) {
      EXPECT_GE(other, Serial{1001});
      EXPECT_LE(other, Serial{1005});
    }
  }
}

}  // namespace
}  // namespace etcm::firmware
