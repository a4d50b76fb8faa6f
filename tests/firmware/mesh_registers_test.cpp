// The two register maps.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "firmware/protocol/node_registers.h"
#include "firmware/protocol/register_pairs.h"
#include "firmware/publish/mesh_register_tables.h"
#include "firmware/publish/quarantine_reason.h"
#include "firmware/publish/reading_register_tables.h"

namespace etcm::firmware {
namespace {

TEST(NodeMap, ComesBackAsItWentOut) {
  for (const Position position :
       {Position{0, 0}, Position{-1, 1}, Position{position_max, -position_max}}) {
    const NodeReading sent{.serial = Serial{0xdeadbeef},
                           .position = position,
                           .status = node_status::fix_valid | node_status::relay,
                           .boot_count = 65535};
    NodeReading found;
    ASSERT_EQ(decode_node(encode_node(sent, 65535), WordOrder::abcd, found), ReadingFault::none);
    EXPECT_EQ(found.serial, sent.serial);
    EXPECT_EQ(found.position, sent.position);
    EXPECT_EQ(found.status, sent.status);
    EXPECT_EQ(found.boot_count, sent.boot_count);
  }
}

TEST(NodeMap, HasTheLayoutOfTheTable) {
  const NodeRegisters registers = encode_node(
      {.serial = Serial{0x00010002}, .position = {-2, 0x00030004}, .status = 5, .boot_count = 6},
      9);
  EXPECT_EQ(registers, (NodeRegisters{0x4554, 0x010c, 1, 2, 9, 0xffff, 0xfffe, 3, 4, 5, 6, 9}));
}

TEST(NodeMap, AFaultLeavesTheReadingAlone) {
  NodeReading reading{.serial = Serial{42}, .position = {}};
  NodeRegisters registers = encode_node({.serial = Serial{7}, .position = {}}, 1);
  registers[11] = 2;
  EXPECT_EQ(decode_node(registers, WordOrder::abcd, reading), ReadingFault::torn);
  EXPECT_EQ(reading.serial, Serial{42u});
  EXPECT_EQ(decode_node(std::span(registers).first(11), WordOrder::abcd, reading),
            ReadingFault::wrong_length);
  EXPECT_EQ(decode_node(encode_node({.serial = Serial::none(), .position = {}}, 1), WordOrder::abcd,
                        reading),
            ReadingFault::bad_serial);
}

TEST(NodeMap, APositionOutOfRangeIsNoFaultWithoutAFix) {
  NodeReading reading;
  EXPECT_EQ(decode_node(encode_node({.serial = Serial{1}, .position = {position_max + 1, 0}}, 1),
                        WordOrder::abcd, reading),
            ReadingFault::none);
}

struct OrderCase {
  const char* name;
  WordOrder order;
  NodeRegisters registers;  // as a node of that order sends them
};
class NodeWordOrder : public testing::TestWithParam<OrderCase> {};

// Serial 0x00010002 at x = 0x00000304, y = -2.
TEST_P(NodeWordOrder, IsReadAsItIsAndShowsWhenItIsTakenForAnother) {
  const OrderCase& sent = GetParam();
  NodeReading found;
  ASSERT_EQ(decode_node(sent.registers, sent.order, found), ReadingFault::none);
  EXPECT_EQ(found.serial, Serial{0x00010002u});
  EXPECT_EQ(found.position, (Position{0x0304, -2}));
  EXPECT_EQ(reorder(reorder(sent.registers, sent.order), sent.order), sent.registers);
  const bool is_byte_swapped = sent.registers[0] != node_magic;
  for (const WordOrder taken :
       {WordOrder::abcd, WordOrder::badc, WordOrder::cdab, WordOrder::dcba}) {
    if (taken == sent.order) continue;
    NodeReading reading;
    const ReadingFault fault = decode_node(sent.registers, taken, reading);
    const bool takes_swapped = taken == WordOrder::badc || taken == WordOrder::dcba;
    if (takes_swapped != is_byte_swapped) {
      EXPECT_EQ(fault, ReadingFault::swapped_bytes);
    } else if (fault == ReadingFault::none) {
      EXPECT_EQ(reading.serial, swap_words(Serial{0x00010002}));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Rows, NodeWordOrder,
    testing::Values(OrderCase{"ABCD",
                              WordOrder::abcd,
                              {0x4554, 0x010c, 1, 2, 9, 0, 0x0304, 0xffff, 0xfffe, 1, 6, 9}},
                    OrderCase{"BADC",
                              WordOrder::badc,
                              {0x5445, 0x0c01, 0x0100, 0x0200, 0x0900, 0, 0x0403, 0xffff, 0xfeff,
                               0x0100, 0x0600, 0x0900}},
                    OrderCase{"CDAB",
                              WordOrder::cdab,
                              {0x4554, 0x010c, 2, 1, 9, 0x0304, 0, 0xfffe, 0xffff, 1, 6, 9}},
                    OrderCase{"DCBA",
                              WordOrder::dcba,
                              {0x5445, 0x0c01, 0x0200, 0x0100, 0x0900, 0x0403, 0, 0xfeff, 0xffff,
                               0x0100, 0x0600, 0x0900}}),
    [](const auto& row) { return std::string(row.param.name); });

// Reads vertex and neighbour by the documented rule alone: unit, block, register.
class Reader {
 public:
  explicit Reader(const port::RegisterImage& image) : image_(image) {}

  std::uint32_t header(const std::string& name) const {
    for (const auto& row : header_rows()) {
      if (name == row.name) return value(0, row.offset, row.registers);
    }
    ADD_FAILURE() << "no header row " << name;
    return 0;
  }
  std::uint32_t vertex(std::uint32_t row, const std::string& name) const {
    for (const auto& field : vertex_rows()) {
      if (name != field.name) continue;
      return value(header("vertex_block_first") + row / 7, 2 + row % 7 * 16u + field.offset,
                   field.registers);
    }
    ADD_FAILURE() << "no vertex row " << name;
    return 0;
  }
  template <class Source>
  std::uint32_t entry(const std::string& list, std::uint32_t per_block, std::uint32_t registers,
                      std::span<const RegisterRow<Source>> rows, std::uint32_t number,
                      const std::string& name) const {
    for (const auto& field : rows) {
      if (name != field.name) continue;
      return value(header(list + "_block_first") + number / per_block,
                   2 + number % per_block * registers + field.offset, field.registers);
    }
    ADD_FAILURE() << "no row " << name;
    return 0;
  }
  std::uint32_t neighbour(std::uint32_t entry) const {
    return value(header("neighbour_block_first") + entry / 59, 2 + entry % 59 * 2u, 2);
  }

 private:
  std::uint32_t value(std::uint32_t block, std::uint32_t offset, std::uint32_t registers) const {
    const std::uint32_t unit = 1 + block / 546;
    const std::uint32_t address = block % 546 * 120 + offset;
    const std::size_t at = std::size_t{unit - 1} * image_.registers_per_unit + address;
    return registers == 1 ? image_.registers.at(at) : load_u32(image_.registers, at);
  }
  const port::RegisterImage& image_;
};

TEST(MeshMap, ComesBackByTheDocumentedRule) {
  constexpr std::uint32_t vertices = 5000;  // more than one unit
  Snapshot snapshot{.generation = 0x12345678,
                    .node_count = 4999,
                    .anchor_count = 7,
                    .steiner_count = 1,
                    .mesh_hash = 0x0123456789abcdef,
                    .vertices = {},
                    .neighbours = {}};
  for (std::uint32_t row = 0; row < vertices; ++row) {
    snapshot.vertices.push_back({.kind = VertexKind::node,
                                 .stale = row == 3,
                                 .serial = Serial{70000 + row},
                                 .point = to_point({-static_cast<int>(row), 5}),
                                 .first_neighbour = row,
                                 .degree = 1});
    snapshot.neighbours.push_back({.row = vertices - 1 - row, .constrained = row % 2 == 0});
  }
  snapshot.vertices[4000] = {.kind = VertexKind::steiner,
                             .feature = 9,
                             .point = {-1, subunits_per_unit + 1},
                             .first_neighbour = 4000,
                             .degree = 1};
  port::RegisterImage image;
  encode_mesh(snapshot, {.vertices = vertices}, image);
  const Reader reader(image);
  EXPECT_EQ(reader.header("magic"), 0x4d45u);
  EXPECT_EQ(reader.header("word_order_check"), 0x01020304u);
  EXPECT_EQ(reader.header("node_count"), 4999u);
  EXPECT_EQ(reader.header("anchor_count"), 7u);
  EXPECT_EQ(reader.header("mesh_hash_high"), 0x01234567u);
  EXPECT_EQ(reader.header("mesh_hash_low"), 0x89abcdefu);
  for (std::uint32_t row = 0; row < vertices; ++row) {
    ASSERT_EQ(reader.neighbour(reader.vertex(row, "neighbour_first")) & 0x7fffffffu,
              vertices - 1 - row);
    if (row == 4000) continue;
    ASSERT_EQ(reader.vertex(row, "serial"), 70000 + row);
    ASSERT_EQ(static_cast<std::int32_t>(reader.vertex(row, "x")), -static_cast<int>(row));
    ASSERT_EQ(reader.vertex(row, "kind"), row == 3 ? 0x0101u : 1u);
  }
  EXPECT_EQ(reader.vertex(4000, "kind"), 2u);
  EXPECT_EQ(reader.vertex(4000, "feature"), 9u);
  EXPECT_EQ(static_cast<std::int32_t>(reader.vertex(4000, "x")), -1);
  EXPECT_EQ(reader.vertex(4000, "x_fraction"), (1u << 28) - 1);
  EXPECT_EQ(reader.vertex(4000, "y"), 1u);
  EXPECT_EQ(reader.vertex(4000, "y_fraction"), 1u);
}

TEST(MeshMap, ListsComeBackByTheDocumentedRule) {
  Snapshot snapshot{.generation = 7, .vertices = {}, .neighbours = {}};
  for (std::uint32_t i = 0; i < 30; ++i) {
    const auto place = to_point({-static_cast<int>(i), 5});
    snapshot.analysis.relays.push_back({place, i + 1, i % 2 == 0 ? no_row : i});
    snapshot.analysis.holes.push_back({place, 100 + i, i % 2 == 0});
    snapshot.analysis.gaps.push_back({i + 1, 10 + i, 20 + i, i % 2 == 0});
    snapshot.analysis.long_links.push_back({10 + i, 20 + i});
    snapshot.quarantine.push_back({.kind = QuarantineKind::anchor,
                                   .reason = 10,
                                   .serial = Serial{i},
                                   .bus = 2,
                                   .address = 3,
                                   .position = {-4, static_cast<int>(i)},
                                   .age_s = 70000});
  }
  const MeshRegisterCapacity capacity{
      .vertices = 10, .relays = 30, .holes = 31, .gaps = 32, .long_links = 33, .quarantined = 34};
  port::RegisterImage image;
  encode_mesh(snapshot, capacity, image);
  const Reader reader(image);
  EXPECT_EQ(image.registers.size(),
            std::size_t{mesh_register_layout(capacity).block_count()} * 120);
  EXPECT_EQ(reader.header("relay_block_first"),
            reader.header("neighbour_block_first") + reader.header("neighbour_blocks"));
  EXPECT_EQ(reader.header("relay_blocks"), 4u);
  for (const char* list : {"relay", "hole", "gap", "long_link", "quarantine"}) {
    EXPECT_EQ(reader.header(std::string(list) + "_entries"), 30u) << list;
  }
  for (std::uint32_t i = 0; i < 30; ++i) {
    const auto signed_value = [](std::uint32_t value) { return static_cast<std::int32_t>(value); };
    const auto relay = [&](const char* name) {
      return reader.entry("relay", 9, 12, relay_rows(), i, name);
    };
    EXPECT_EQ(signed_value(relay("x")), -static_cast<int>(i));
    EXPECT_EQ(relay("feature"), i + 1);
    EXPECT_EQ(relay("row"), i % 2 == 0 ? 0xffffffffu : i);
    const auto hole = [&](const char* name) {
      return reader.entry("hole", 9, 12, hole_rows(), i, name);
    };
    EXPECT_EQ(hole("y"), 5u);
    EXPECT_EQ(hole("distance"), 100 + i);
    EXPECT_EQ(hole("hole_flags"), i % 2 == 0 ? 1u : 0u);
    const auto gap = [&](const char* name) {
      return reader.entry("gap", 14, 8, gap_rows(), i, name);
    };
    EXPECT_EQ(gap("feature"), i + 1);
    EXPECT_EQ(gap("from_row"), 10 + i);
    EXPECT_EQ(gap("to_row"), 20 + i);
    EXPECT_EQ(gap("gap_flags"), i % 2 == 0 ? 1u : 0u);
    EXPECT_EQ(reader.entry("long_link", 29, 4, long_link_rows(), i, "to_row"), 20 + i);
    const auto quarantined = [&](const char* name) {
      return reader.entry("quarantine", 8, 14, quarantined_rows(), i, name);
    };
    EXPECT_EQ(quarantined("kind"), 3u);
    EXPECT_EQ(quarantined("reason"), 10u);
    EXPECT_EQ(quarantined("serial"), i);
    EXPECT_EQ(quarantined("bus"), 2u);
    EXPECT_EQ(quarantined("unit"), 3u);
    EXPECT_EQ(signed_value(quarantined("x")), -4);
    EXPECT_EQ(quarantined("y"), i);
    EXPECT_EQ(quarantined("age_s"), 70000u);
  }
}

TEST(MeshMap, ReadingsComeBackByTheDocumentedRule) {
  using namespace std::chrono_literals;
  ReadingSnapshot readings;
  readings.sequence = 0x00020003;
  readings.generation = 7;
  readings.taken_at = port::Instant{100s};
  readings.quantities = {{"level", "m"},
                         {std::string(reading_name_max, 'n'), "°C"},
                         {"a", ""},
                         {"depth of the water", "m"}};
  for (std::uint32_t i = 0; i < 30; ++i) {
    readings.readings.push_back({.serial = Serial{100'000 + i},
                                 .unit_index = {},
                                 .quantity = QuantityIndex{i % 4},
                                 .row = i % 5 == 0 ? no_row : i,
                                 .nano = -1'500'000'000 * std::int64_t{i},
                                 .taken_at = port::Instant{99s},
                                 .is_stale = i == 3});
  }
  readings.readings[4].nano.reset();
  const MeshRegisterCapacity capacity{.vertices = 10, .quantities = 4, .readings = 25};
  port::RegisterImage image;
  encode_mesh({.generation = 7, .vertices = {}, .neighbours = {}}, capacity, image);
  encode_readings(readings, capacity, image);
  const auto at = [&](std::uint32_t block, std::uint32_t offset) {
    return std::size_t{block} * 120 + offset;
  };
  const std::uint32_t head = Reader(image).header("reading_head_block");
  const auto in_head = [&](const std::string& name) {
    for (const auto& row : reading_head_rows()) {
      if (name != row.name) continue;
      return row.registers == 1 ? std::uint32_t{image.registers.at(at(head, row.offset))}
                                : load_u32(image.registers, at(head, row.offset));
    }
    ADD_FAILURE() << name;
    return 0u;
  };
  EXPECT_EQ(in_head("generation"), 7u);
  EXPECT_EQ(in_head("sequence"), 0x00020003u);
  EXPECT_EQ(in_head("reading_count"), 30u);
  EXPECT_EQ(in_head("stale_reading_count"), 1u);
  EXPECT_EQ(in_head("reading_entries"), 25u) << "the list is cut off";
  EXPECT_EQ(in_head("quantity_entries"), 4u);
  EXPECT_EQ(in_head("quantities_per_block"), 3u);
  EXPECT_EQ(in_head("readings_per_block"), 8u);
  EXPECT_EQ(image.registers.size(),
            at(in_head("reading_block_first") + in_head("reading_blocks"), 0));
  const auto text_at = [&](std::uint32_t number, std::uint32_t first, std::uint32_t count) {
    std::string text;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint16_t word = image.registers.at(
          at(in_head("quantity_block_first") + number / 3, 2 + number % 3 * 36 + first + i));
      for (const int letter : {word >> 8, word & 0xff}) {
        if (letter != 0) text += static_cast<char>(letter);
      }
    }
    return text;
  };
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(text_at(i, 0, 24), readings.quantities[i].name);
    EXPECT_EQ(text_at(i, 24, 12), readings.quantities[i].unit);
  }
  for (std::uint32_t i = 0; i < 25; ++i) {
    const std::uint32_t block = in_head("reading_block_first") + i / 8;
    EXPECT_EQ(load_u32(image.registers, at(block, 0)), 7u);
    EXPECT_EQ(load_u32(image.registers, at(block, 2)), 0x00020003u);
    const auto field = [&](std::uint32_t offset) {
      return load_u32(image.registers, at(block, 4 + i % 8 * 14 + offset));
    };
    EXPECT_EQ(field(0), 100'000 + i);
    EXPECT_EQ(field(2), i % 5 == 0 ? 0xffffffffu : i);
    EXPECT_EQ(field(4) >> 16, i % 4 + 1);
    EXPECT_EQ(field(4) & 0xffff, i == 3 ? 1u : i == 4 ? 2u : 0u);
    const float value = std::bit_cast<float>(field(6));
    if (i == 3 || i == 4) {
      EXPECT_TRUE(std::isnan(value));
    } else {
      EXPECT_EQ(value, -1.5f * static_cast<float>(i));
    }
    const auto nano =
        static_cast<std::int64_t>(std::uint64_t{field(8)} << 32 | std::uint64_t{field(10)});
    EXPECT_EQ(nano,
              i == 4 ? std::numeric_limits<std::int64_t>::min() : -1'500'000'000 * std::int64_t{i});
    EXPECT_EQ(field(12), 1000u);
  }
  // Fewer readings leave nothing behind.
  readings.readings.resize(1);
  readings.sequence = 5;
  encode_readings(readings, capacity, image);
  EXPECT_EQ(in_head("reading_entries"), 1u);
  EXPECT_EQ(load_u32(image.registers, at(in_head("reading_block_first"), 4 + 14)), 0u);
  EXPECT_EQ(load_u32(image.registers, at(in_head("reading_block_first") + 3, 2)), 5u);
}

TEST(MeshMap, WithoutDevicesThereAreNoBlocksOfReadings) {
  const MeshRegisterCapacity capacity{.vertices = 10};
  const MeshRegisterLayout layout = mesh_register_layout(capacity);
  EXPECT_EQ(layout.block_count(), layout.quarantine.end());
  port::RegisterImage image;
  encode_mesh({.generation = 7, .vertices = {}, .neighbours = {}}, capacity, image);
  encode_readings({}, capacity, image);
  EXPECT_EQ(Reader(image).header("reading_head_block"), 0u);
}

TEST(MeshMap, TheGreatestMeshFitsTheUnits) {
  const auto blocks = [](std::uint32_t vertices) {
    constexpr std::uint32_t list = analysis_list_max;
    return mesh_register_layout({.vertices = vertices,
                                 .relays = list,
                                 .holes = list,
                                 .gaps = list,
                                 .long_links = list,
                                 .quarantined = quarantine_listed_max,
                                 .quantities = quantities_listed_max,
                                 .readings = readings_listed_max})
        .block_count();
  };
  EXPECT_LE(blocks(mesh_registers_vertices_max()), units_max * unit_blocks);
  EXPECT_GT(blocks(mesh_registers_vertices_max() + 100), units_max * unit_blocks);
}

TEST(MeshMap, EachRefusalHasAReasonOfItsOwn) {
  for (const QuarantineReason& reason : quarantine_reasons()) {
    if (reason.code == other_reason) continue;
    EXPECT_EQ(reason_code(reason.rejection, reason.conflict), reason.code) << reason.meaning;
  }
  EXPECT_EQ(reason_code(Status::buffer_too_small, IdentityConflict::none), other_reason);
}

TEST(MeshMap, TheOperatingGuideHasItsTables) {
  std::ifstream file(ETCM_REGISTER_GUIDE);
  ASSERT_TRUE(file) << ETCM_REGISTER_GUIDE;
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find(describe_mesh_registers()), std::string::npos)
      << "put the output of `etcm-gateway --register-map` into firmware/guide/registers.md";
}

}  // namespace
}  // namespace etcm::firmware
