// After its start the gateway takes no memory: an hour of simulated time with everything that can
// happen to nodes, on doubles that take none themselves. The files are real, and so is their
// thread.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/gateway/gateway.h"
#include "firmware/logging/limited_log.h"
#include "firmware/protocol/node_registers.h"
#include "measuring_profile.h"
#include "posix/mesh_folder.h"
#include "support/allocation_watch.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t unit_count = 40;

class Clock final : public port::Clock {
 public:
  port::Instant now() const override { return now_; }
  void pass(port::Duration time) { now_ += time; }

 private:
  port::Instant now_{1h};
};

class CountingLog final : public port::Log {
 public:
  void write(port::Level, std::string_view) override { ++lines; }
  std::size_t lines = 0;
};

// Units that answer at the next step, or never.
class QuietBus final : public port::NodeBus {
 public:
  bool ready() const override { return count_ < queue_.size(); }
  void start_read(const port::RegisterRead& read, port::Instant now) override {
    start(read.address, read.ticket, now + read.timeout);
  }
  void start_write(const port::RegisterWrite& write, port::Instant now) override {
    start(write.address, write.ticket, now + write.timeout);
  }
  void start_request(const port::UnitRequest& request, port::Instant now) override {
    start(request.address, request.ticket, now + request.timeout);
  }
  void advance(port::Instant now) override { now_ = now; }
  bool take_answer(port::BusAnswer& answer) override {
    for (std::size_t i = 0; i < count_; ++i) {
      const Request request = queue_[i];
      const bool answers = answers_[request.address];
      if (!answers && request.deadline > now_) continue;
      queue_[i] = queue_[--count_];
      answer = {.address = request.address,
                .ticket = request.ticket,
                .result = answers ? port::BusResult::ok : port::BusResult::timeout,
                .registers = registers_[request.address]};
      return true;
    }
    return false;
  }
  port::Instant next_deadline() const override { return now_ + 10ms; }

  void put(std::uint8_t unit, Position position, std::uint16_t status = node_status::fix_valid) {
    registers_[unit] =
        encode_node({.serial = Serial{1000u + unit}, .position = position, .status = status}, 7);
    answers_[unit] = true;
  }
  void silence(std::uint8_t unit) { answers_[unit] = false; }

 private:
  struct Request {
    std::uint8_t address;
    std::uint32_t ticket;
    port::Instant deadline;
  };
  void start(std::uint8_t unit, std::uint32_t ticket, port::Instant deadline) {
    queue_[count_++] = {unit, ticket, deadline};
  }

  std::array<Request, 16> queue_{};
  std::size_t count_ = 0;
  std::array<NodeRegisters, 256> registers_{};
  std::array<bool, 256> answers_{};
  port::Instant now_{};
};

// Like a server with a client that reads the header every so often.
class PinningServer final : public port::MeshServer {
 public:
  void publish(std::shared_ptr<const port::RegisterImage> image) override {
    image_ = std::move(image);
    if (++published % 3 == 0) pinned_ = image_;
  }
  std::size_t published = 0;

 private:
  std::shared_ptr<const port::RegisterImage> image_;
  std::shared_ptr<const port::RegisterImage> pinned_;
};

Settings settings() {
  Settings settings;
  settings.mesh = {.vertices_max = 400, .features_max = 60};
  settings.poll = {.interval = 500ms,
                   .timeout = 50ms,
                   .absent_interval = 4s,
                   .stale_after = 3s,
                   .leave_after = 8s};
  settings.server.clients_max = 4;
  settings.analysis = {.radio_range = 150, .sensing_range = 80};
  settings.write_back.is_enabled = true;
  settings.files = FileSettings{.folder = {}, .name = {}, .interval = 30s};
  BusSettings bus;
  bus.name = "a bus with a name that no short string holds";
  bus.units = {{.first = 1, .last = unit_count}};
  bus.scan = {{.first = 100, .last = 120}};
  bus.scan_budget = 20ms;
  bus.timeout = 50ms;
  bus.outstanding_max = 8;
  settings.device_profiles = {measuring_profile()};
  bus.devices = {{.units = {{.first = 31, .last = unit_count}},
                  .profile = settings.device_profiles.front().name,
                  .timeout = 50ms}};
  settings.buses = {bus};
  for (std::uint32_t i = 1; i + 7 <= unit_count; i += 6) {
    settings.features.push_back({.from = Serial{1000 + i},
                                 .to = Serial{1000 + i + 6},
                                 .name = {},
                                 .source = "site.toml:12"});
  }
  return settings;
}

Position place_of(std::uint8_t unit, std::uint32_t round) {
  return {unit % 7 * 100 + static_cast<std::int32_t>(round % 5), unit / 7 * 100 + unit * 3};
}

class SteadyMemory : public testing::Test {
 protected:
  SteadyMemory() : memory_(storage_bytes(settings_.mesh) / 8 + 1) {
    EXPECT_EQ(mesh_.open(std::as_writable_bytes(std::span(memory_)), settings_.mesh), Status::ok);
    for (std::uint8_t unit = 1; unit <= unit_count; ++unit) bus_.put(unit, place_of(unit, 0));
    gateway_.emplace(
        std::make_shared<const Settings>(settings_), mesh_,
        GatewayPorts{
            .buses = buses_, .server = server_, .files = &files_, .clock = clock_, .log = log_});
  }

  void run(port::Duration duration) {
    for (port::Duration passed{}; passed < duration; passed += 10ms) {
      gateway_->step(clock_.now());
      clock_.pass(10ms);
      // Simulated time is faster than any disk.
      EXPECT_TRUE(files_.wait(20s));
    }
  }

  // Ten seconds in which a node moves, one falls silent and comes back, one asks to leave, two
  // stand on one place, and a node has another's serial.
  void eventful(std::uint32_t round) {
    const auto unit = [&](std::uint32_t offset) {
      return static_cast<std::uint8_t>((round * 7 + offset) % unit_count + 1);
    };
    bus_.put(unit(0), place_of(unit(0), round + 1));
    bus_.silence(unit(1));
    bus_.put(unit(2), place_of(unit(2), 0), node_status::fix_valid | node_status::leaving);
    bus_.put(unit(3), place_of(unit(4), 0));
    run(9s);
    for (std::uint8_t each = 1; each <= unit_count; ++each) {
      bus_.put(each, place_of(each, round % 2));
    }
    run(1s);
  }

  Settings settings_ = settings();
  std::vector<std::uint64_t> memory_;
  Mesh mesh_;
  Clock clock_;
  CountingLog delivered_;
  LimitedLog log_{delivered_, clock_};
  QuietBus bus_;
  PinningServer server_;
  const test::ScratchFolder scratch_;
  port::MeshFolder files_{scratch_.path("files"), "a mesh with a name that no short string holds",
                          settings_.mesh.vertices_max};
  const std::array<PolledBus, 1> buses_{{{.bus = &bus_, .settings = &settings_.buses[0]}}};
  std::optional<Gateway> gateway_;
};

TEST_F(SteadyMemory, AnHourOfPollingTakesNone) {
  run(10s);
  ASSERT_EQ(mesh_.node_count(), unit_count);
  std::size_t allocations = 1;
  {
    test::AllocationWatch watch;
    run(1h);
    allocations = watch.allocations();
  }
  EXPECT_EQ(allocations, 0u);
}

TEST_F(SteadyMemory, AnHourOfComingAndGoingTakesNone) {
  for (std::uint32_t round = 0; round < 12; ++round) eventful(round);
  const std::size_t published = server_.published;
  const std::size_t lines = delivered_.lines;
  std::size_t allocations = 1;
  {
    test::AllocationWatch watch;
    for (std::uint32_t round = 12; round < 12 + 360; ++round) eventful(round);
    allocations = watch.allocations();
  }
  EXPECT_EQ(allocations, 0u);
  EXPECT_GT(server_.published, published + 1000);
  EXPECT_GT(gateway_->readings().sequence, gateway_->generation());
  EXPECT_EQ(gateway_->readings().readings.size(), 30u);
  EXPECT_GT(delivered_.lines, lines);
  EXPECT_FALSE(scratch_.read("files/a mesh with a name that no short string holds.svg").empty());
}

TEST_F(SteadyMemory, MinutesWithoutTheFolderOfTheFilesTakeNone) {
  for (std::uint32_t round = 0; round < 12; ++round) eventful(round);
  std::filesystem::remove_all(scratch_.path("files"));
  eventful(12);
  const std::size_t lines = delivered_.lines;
  std::size_t allocations = 1;
  {
    test::AllocationWatch watch;
    for (std::uint32_t round = 13; round < 13 + 36; ++round) eventful(round);
    allocations = watch.allocations();
  }
  EXPECT_EQ(allocations, 0u);
  EXPECT_GT(delivered_.lines, lines);
}

}  // namespace
}  // namespace etcm::firmware
