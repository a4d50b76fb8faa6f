// Generations of the mesh as a master sees them: the images of the pool, through the real server.
#include <gtest/gtest.h>

#include <memory>

#include "firmware/protocol/register_pairs.h"
#include "firmware/publish/image_pool.h"
#include "firmware/publish/mesh_registers.h"
#include "modbus/register_server.h"
#include "modbus/tcp_bus.h"
#include "port/peer.h"

namespace etcm::firmware {
namespace {

constexpr std::uint32_t vertices = 40;
constexpr MeshRegisterCapacity capacity{.vertices = vertices, .holes = 20, .quarantined = 10};
constexpr std::uint32_t clients_max = 2;

// Every register of a row depends on the generation.
Snapshot snapshot_of(std::uint32_t generation) {
  Snapshot snapshot{.generation = generation, .vertices = {}, .neighbours = {}};
  for (std::uint32_t row = 0; row < vertices; ++row) {
    snapshot.vertices.push_back(
        {.kind = VertexKind::node, .serial = Serial{1000 * generation + row}, .point = {}});
    snapshot.neighbours.push_back({.row = 1000 * generation + row});
  }
  for (std::uint32_t i = 0; i < capacity.holes; ++i) {
    snapshot.analysis.holes.push_back({.point = {}, .distance = 1000 * generation + i});
  }
  for (std::uint32_t i = 0; i < capacity.quarantined; ++i) {
    snapshot.quarantine.push_back({.serial = Serial{1000 * generation + i}});
  }
  return snapshot;
}

std::vector<std::uint16_t> registers_of(std::uint32_t generation) {
  port::RegisterImage image;
  encode_mesh(snapshot_of(generation), capacity, image);
  return image.registers;
}

class Master {
 public:
  Master(port::EventLoop& loop, const port::SocketAddress& server)
      : loop_(loop), bus_(loop, log_, {.name = "master", .end = port::endpoint_of(server)}) {}

  std::vector<std::uint16_t> read(std::uint16_t first, std::uint16_t count) {
    EXPECT_TRUE(port::turn_until(loop_, [&] {
      bus_.advance(now_);
      return bus_.ready();
    }));
    bus_.start_read({.address = 1, .first = first, .count = count, .timeout = port::patience},
                    now_);
    port::BusAnswer answer;
    EXPECT_TRUE(port::turn_until(loop_, [&] { return bus_.take_answer(answer); }));
    EXPECT_EQ(answer.result, port::BusResult::ok);
    return {answer.registers.begin(), answer.registers.end()};
  }
  std::vector<std::uint16_t> read_block(std::uint32_t number) {
    return read(static_cast<std::uint16_t>(number * block_size), block_size);
  }

 private:
  static constexpr port::Instant now_{};  // stands still: no request is ever late
  port::EventLoop& loop_;
  port::KeptLog log_;
  port::TcpBus bus_;
};

TEST(PublishedMap, AMasterReadsOneGenerationWhileNewerOnesArePublished) {
  const std::uint32_t blocks = mesh_register_layout(capacity).block_count();
  ImagePool images(capacity, 2, clients_max + 2);
  port::EventLoop loop;
  port::RegisterServer server(loop, {.host = 0x7f000001, .port = 0}, clients_max,
                              {{"Maker", "mesh server", "1.2"}}, images.encode(snapshot_of(1), {}));
  Master slow(loop, server.address());
  Master quick(loop, server.address());

  std::uint32_t newest = 1;
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<std::uint16_t> seen = slow.read_block(0);
    const std::uint32_t pinned = load_u32(seen, 0);
    EXPECT_EQ(pinned, newest) << "the header is always the newest";
    for (std::uint32_t number = 1; number < blocks; ++number) {
      server.publish(images.encode(snapshot_of(++newest), {}));
      EXPECT_EQ(load_u32(quick.read_block(0), 0), newest);
      // The header but for its first register: no new look.
      EXPECT_EQ(slow.read(1, 1)[0], pinned);
      const std::vector<std::uint16_t> block = slow.read_block(number);
      seen.insert(seen.end(), block.begin(), block.end());
    }
    EXPECT_EQ(seen, registers_of(pinned)) << "pass " << pass;
  }
}

// So that the readings of two sequences differ in each entry, and in number.
ReadingSnapshot readings_of_sequence(std::uint32_t sequence) {
  ReadingSnapshot readings;
  readings.sequence = sequence;
  readings.generation = 1;
  readings.quantities = {{"level", "m"}, {"temperature", "°C"}};
  for (std::uint32_t i = 0; i < 20 + sequence % 10; ++i) {
    PublishedReading reading;
    reading.serial = Serial{1000 * sequence + i};
    reading.quantity = QuantityIndex{i % 2};
    reading.nano = std::int64_t{sequence} * nano_per_one;
    readings.readings.push_back(reading);
  }
  return readings;
}

TEST(PublishedReadings, AMasterReadsOneTableWhileNewerOnesArePublished) {
  constexpr MeshRegisterCapacity measuring{.vertices = vertices, .quantities = 2, .readings = 30};
  const MeshRegisterLayout layout = mesh_register_layout(measuring);
  ImagePool images(measuring, 2, clients_max + 2);
  port::EventLoop loop;
  port::RegisterServer server(loop, {.host = 0x7f000001, .port = 0}, clients_max,
                              {{"Maker", "mesh server", "1.2"}},
                              images.encode(snapshot_of(1), readings_of_sequence(1)));
  Master slow(loop, server.address());
  Master quick(loop, server.address());
  std::uint32_t newest = 1;
  for (int pass = 0; pass < 3; ++pass) {
    EXPECT_EQ(load_u32(slow.read_block(0), 0), 1u) << "readings make no generation";
    const std::uint32_t pinned = load_u32(slow.read_block(layout.reading_head.first), 2);
    EXPECT_EQ(pinned, newest);
    std::vector<std::uint16_t> seen;
    for (std::uint32_t number = layout.reading_head.first; number < layout.block_count();
         ++number) {
      server.publish(images.encode(readings_of_sequence(++newest)));
      quick.read_block(0);
      EXPECT_EQ(load_u32(quick.read_block(layout.reading_head.first), 2), newest);
      const std::vector<std::uint16_t> block = slow.read_block(number);
      seen.insert(seen.end(), block.begin(), block.end());
    }
    port::RegisterImage expected;
    encode_mesh(snapshot_of(1), measuring, expected);
    encode_readings(readings_of_sequence(pinned), measuring, expected);
    const auto behind = expected.registers.begin() +
                        static_cast<std::ptrdiff_t>(layout.reading_head.first) * block_size;
    EXPECT_EQ(seen, std::vector(behind, expected.registers.end())) << "pass " << pass;
  }
}

}  // namespace
}  // namespace etcm::firmware
