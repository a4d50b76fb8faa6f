// Devices that measure, added while the gateway runs: through reload(), to everywhere where
// readings are published.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "firmware/config/reload.h"
#include "firmware/protocol/register_pairs.h"
#include "firmware/publish/reading_register_tables.h"
#include "firmware/publish/snapshot_taker.h"
#include "measuring.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

constexpr const char* barometer = R"(
[[profile]]
name = "barometer"
[[profile.reading]]
name = "pressure"
unit = "hPa"
value = { register = 40, type = "u16", scale = "0.1" }
[[profile.reading]]
name = "level"
unit = "m"
value = { register = 3, type = "i16", scale = "0.001" }
[[profile.reading]]
name = "humidity"
unit = "%"
value = { register = 41 }
)";
constexpr const char* barometer_at_9 =
    "[[bus.device]]\nunits = \"9\"\nprofile = \"barometer\"\n"
    "[[node]]\nunit = 9\nx = 50\ny = 50\n";

class AddedReadings : public Measuring {
 protected:
  bool reload_with(const std::string& text, const std::vector<port::NodeBus*>& added = {}) {
    folder_.write("site.toml", text);
    rig_.log.lines.clear();
    const auto files = std::exchange(rig_.settings.files, std::nullopt);  // not of the file
    std::string refusal;
    const auto next = reload(folder_.path("site.toml"), rig_.settings, nullptr, rig_.log, refusal);
    rig_.settings.files = files;
    if (next == nullptr) return false;
    rig_.settings = *next;
    rig_.settings.files = files;
    rig_.update_settings(added);
    return true;
  }
  static std::string with(const std::string& from, const std::string& to) {
    std::string text = measuring_settings;
    return text.replace(text.find(from), from.size(), to);
  }
  static std::string text_at(std::span<const std::uint16_t> registers) {
    std::string text;
    for (const std::uint16_t two : registers) {
      for (const int letter : {two >> 8, two & 255}) {
        if (letter != 0) text += static_cast<char>(letter);
      }
    }
    return text;
  }
  // What a master finds that goes by the head of the readings: "1002 level m 1500000000".
  std::vector<std::string> registers() const {
    const std::vector<std::uint16_t>& all = rig_.server.images.back()->registers;
    const auto block = [&](std::uint32_t number) {
      return std::span(all).subspan(std::size_t{number} * block_size, block_size);
    };
    const std::uint32_t head_block = rig_.server.header("reading_head_block");
    std::vector<std::string> found;
    if (head_block == 0) return found;
    const auto head = block(head_block);
    EXPECT_EQ(load_u32(head, 0), rig_.server.header("generation"));
    for (std::uint32_t i = 0; i < load_u32(head, 16); ++i) {
      const auto of_block = block(load_u32(head, 18) + i / block_readings);
      EXPECT_EQ(load_u32(of_block, 0), load_u32(head, 0));
      EXPECT_EQ(load_u32(of_block, 2), load_u32(head, 2));
      const auto entry = of_block.subspan(
          reading_generation_registers + i % block_readings * reading_registers, reading_registers);
      const std::uint32_t quantity = entry[4] - 1u;
      EXPECT_LT(quantity, load_u32(head, 9));
      const auto names =
          block(load_u32(head, 11) + quantity / block_quantities)
              .subspan(generation_registers + quantity % block_quantities * quantity_registers,
                       quantity_registers);
      const auto value =
          static_cast<std::int64_t>(std::uint64_t{load_u32(entry, 8)} << 32 | load_u32(entry, 10));
      found.push_back(std::to_string(load_u32(entry, 0)) + " " + text_at(names.first(24)) + " " +
                      text_at(names.last(12)) + " " + std::to_string(value));
    }
    return found;
  }
  void put_barometer(std::uint8_t unit) {
    put_tank(unit, 4321);
    bus_.put(unit, 40, {10'132, 55});
  }
};

TEST_F(AddedReadings, AUnitOfAKnownProfileMeasuresAtOnce) {
  put_tank(2, 1500);
  put_tank(4, 2500);
  start();
  rig_.run(1s);
  const std::vector<Quantity> quantities = published().quantities;
  const port::Instant before = reading(1002, "level")->taken_at;
  ASSERT_TRUE(reload_with(with("units = \"2-3\"", "units = \"2-4\"") +
                          "[[node]]\nunit = 4\nx = 100\ny = 100\n"));
  EXPECT_EQ(rig_.log.count("needs a restart"), 0u) << testing::PrintToString(rig_.log.lines);
  EXPECT_EQ(rig_.log.count("1 unit more than before"), 1u);
  EXPECT_EQ(nano(1002), 1'500'000'000) << "nothing is forgotten";
  rig_.run(1s);
  EXPECT_EQ(nano(1004), 2'500'000'000);
  EXPECT_GT(reading(1002, "level")->taken_at, before);
  EXPECT_EQ(published().quantities, quantities);
  EXPECT_EQ(registers(),
            (std::vector<std::string>{"1002 level m 1500000000", "1004 level m 2500000000"}));
  const auto& image = *rig_.files.last;
  ASSERT_EQ(image.node_count, 2u);
  EXPECT_EQ(image.value_names.back(), "serial");
}

TEST_F(AddedReadings, WhatIsMeasuredFirstComesBehindWhatIsKnown) {
  put_tank(2, 1500);
  put_well(5, 77, 21.5f, 5);
  put_barometer(9);
  start();
  rig_.run(1s);
  const auto pinned = rig_.server.images.back();
  const std::vector<std::uint16_t> registers_before = pinned->registers;
  std::vector<Quantity> quantities = published().quantities;
  const MeshRegisterLayout layout = mesh_register_layout(register_capacity(rig_.settings));
  // In front of the others in the file.
  ASSERT_TRUE(reload_with(barometer +
                          with("[[bus.device]]", std::string(barometer_at_9) + "[[bus.device]]")));
  EXPECT_EQ(rig_.log.count("needs a restart"), 0u) << testing::PrintToString(rig_.log.lines);
  rig_.run(1s);
  quantities.push_back({"pressure", "hPa"});
  quantities.push_back({"humidity", "%"});
  EXPECT_EQ(published().quantities, quantities);
  EXPECT_EQ(nano(1009, "pressure"), 1'013'200'000'000);
  EXPECT_EQ(registers(), (std::vector<std::string>{
                             "77 level m 5", "77 temperature °C 21500000000",
                             "1002 level m 1500000000", "1009 level m 4321000000",
                             "1009 pressure hPa 1013200000000", "1009 humidity % 55000000000"}));
  EXPECT_EQ(pinned->registers, registers_before) << "who reads an older image still can";
  const MeshRegisterLayout after = mesh_register_layout(register_capacity(rig_.settings));
  EXPECT_EQ(after.reading_head.first, layout.reading_head.first);
  EXPECT_EQ(after.quantities.first, layout.quantities.first);
  const auto& names = rig_.files.last->value_names;
  EXPECT_EQ(names.size(), 2 * quantities.size() + 1);
  for (const auto& value : rig_.files.last->values) {
    ASSERT_LT(value.name, names.size());
    if (value.nano == 1'013'200'000'000) {
      EXPECT_EQ(names[value.name], "reading pressure (hPa)");
    }
  }
}

TEST_F(AddedReadings, MayBeTheFirstOfTheSite) {
  std::string text = measuring_settings;
  text.erase(text.find("[[bus.device]]"));
  start(text);
  put_barometer(9);
  const NodeRegisters node =
      encode_node({.serial = Serial{5}, .position = {20, 20}, .status = node_status::fix_valid}, 7);
  bus_.put(1, 0, {node.begin(), node.end()});
  rig_.run(1s);
  EXPECT_TRUE(registers().empty());
  EXPECT_EQ(rig_.server.header("reading_head_block"), 0u);
  ASSERT_TRUE(reload_with(barometer + text + barometer_at_9));
  rig_.run(1s);
  EXPECT_EQ(registers().size(), 3u);
  EXPECT_EQ(nano(1009), 4'321'000'000);
  EXPECT_EQ(rig_.files.last->value_names.size(), 7u);
}

TEST_F(AddedReadings, ANewBusMayBringThem) {
  std::string text = measuring_settings;
  for (std::size_t at = 0; (at = text.find("[[node]]\n", at)) != std::string::npos; at += 9) {
    text.insert(at + 9, "bus = \"yard\"\n");
  }
  put_tank(2, 1500);
  start(text);
  rig_.run(1s);
  DeviceBus gate;
  gate.put(2, 3, {7});
  gate.put(2, 40, {10'000, 44});
  const std::string more = R"(
[[bus]]
tcp = "127.0.0.1:503"
name = "gate"
[[bus.device]]
units = "2"
profile = "barometer"
[[node]]
bus = "gate"
unit = 2
x = 10
y = 10
)";
  ASSERT_TRUE(reload_with(barometer + text + more, {&gate}))
      << testing::PrintToString(rig_.log.lines);
  rig_.run(1s);
  EXPECT_EQ(nano(1002), 1'500'000'000);
  EXPECT_EQ(nano(2002, "humidity"), 44'000'000'000);
  EXPECT_EQ(registers().size(), 4u);
}

TEST_F(AddedReadings, ARefusedReloadLeavesAllAsItWas) {
  put_tank(2, 1500);
  put_barometer(9);
  start();
  rig_.run(1s);
  const std::vector<Quantity> quantities = published().quantities;
  const std::size_t size = rig_.server.images.back()->registers.size();
  const std::string more =
      barometer + with("[[bus.device]]", std::string(barometer_at_9) + "[[bus.device]]");
  EXPECT_FALSE(reload_with(more + "[[node]]\nunit = 99\n"));
  EXPECT_EQ(rig_.log.count("the old one stays"), 1u);
  std::string other = more;
  ASSERT_TRUE(reload_with(other.replace(other.find("none = 32767"), 12, "none = 32766")));
  EXPECT_EQ(rig_.log.count("needs a restart: [[profile]] name = \"tank\""), 1u);
  rig_.run(1s);
  EXPECT_EQ(published().quantities, quantities);
  EXPECT_EQ(rig_.server.images.back()->registers.size(), size);
  EXPECT_EQ(nano(1002), 1'500'000'000);
  EXPECT_EQ(nano(1009), std::nullopt) << "what would have been added waits too";
  // A profile that no device has says nothing of any.
  std::string unused = more;
  ASSERT_TRUE(
      reload_with(unused.replace(unused.find("name = \"nothing\""), 16, "name = \"else\"")));
  EXPECT_EQ(rig_.log.count("needs a restart"), 0u);
  rig_.run(1s);
  EXPECT_EQ(nano(1009), 4'321'000'000);
}

TEST_F(AddedReadings, MayComeOneAfterTheOtherUntilThereIsNoRoom) {
  std::string text = with("vertices_max = 100", "vertices_max = 20");
  text.erase(text.find("[[bus.device]]"));
  start(text + "[[bus.device]]\nunits = \"2\"\nprofile = \"tank\"\n");
  for (int last = 3; last <= 20; ++last) {
    for (int unit = 2; unit <= last; ++unit) {
      put_tank(static_cast<std::uint8_t>(unit), static_cast<std::int16_t>(unit));
    }
    ASSERT_TRUE(reload_with(text + "[[bus.device]]\nunits = \"2-" + std::to_string(last) +
                            "\"\nprofile = \"tank\"\n"));
    EXPECT_EQ(rig_.log.count("needs a restart"), 0u) << last;
    rig_.run(100ms);
  }
  rig_.run(2s);
  EXPECT_EQ(registers().size(), 19u);
  ASSERT_TRUE(reload_with(text + "[[bus.device]]\nunits = \"2-21\"\nprofile = \"tank\"\n"));
  EXPECT_EQ(rig_.log.count("(they are 21, and there is room for 20; raise vertices_max in [mesh])"),
            1u);
  rig_.run(2s);
  EXPECT_EQ(registers().size(), 19u);
}

}  // namespace
}  // namespace etcm::firmware
