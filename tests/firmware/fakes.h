// A gateway with time, bus, server and files in the test's hand; the mesh is the real one.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "etcm/files/mesh_image.h"
#include "etcm/mesh.h"
#include "etcm/port/wall_clock.h"
#include "firmware/config/settings.h"
#include "firmware/gateway/gateway.h"
#include "firmware/protocol/node_registers.h"

namespace etcm::firmware {

class SimulatedClock final : public port::Clock {
 public:
  port::Instant now() const override { return now_; }
  void pass(port::Duration time) { now_ += time; }

 private:
  // Past every pause that runs from the origin, as a real monotonic clock is.
  port::Instant now_{std::chrono::hours(1)};
};

inline constexpr std::int64_t wall_start_ms = 1'800'000'000'000;

// A second is a second of the rig.
class FollowingWallClock final : public port::WallClock {
 public:
  explicit FollowingWallClock(const port::Clock& clock) : clock_(clock), start_(clock.now()) {}
  std::int64_t milliseconds() const override {
    return wall_start_ms + (clock_.now() - start_) / std::chrono::milliseconds(1);
  }

 private:
  const port::Clock& clock_;
  const port::Instant start_;
};

class RecordingLog final : public port::Log {
 public:
  void write(port::Level level, std::string_view line) override {
    (level == port::Level::detail ? details : lines).emplace_back(line);
  }
  std::size_t count(const std::string& part) const;
  std::vector<std::string> lines;
  std::vector<std::string> details;  // for who wants figures, and not among the lines
};

// Units that answer at once, or time out when the gateway's clock has passed the timeout. They take
// the writes a node takes: a new unit where the serial matches, and whatever else. What those who
// share the bus send is repeated.
class ScriptedBus : public port::NodeBus {
 public:
  bool ready() const override {
    return link_up && silent_until_ <= now_ && clear_at <= now_ &&
           waiting_.size() + done_.size() + timed_out_.size() < outstanding_max;
  }
  std::string_view why_down() const override { return link_up ? std::string_view{} : why_no_link; }
  void start_read(const port::RegisterRead& read, port::Instant now) override;
  void start_write(const port::RegisterWrite& write, port::Instant now) override;
  void start_request(const port::UnitRequest& request, port::Instant now) override;
  bool is_up() const override { return link_up; }
  bool is_clearing(port::Instant now) const override { return now < clear_at; }
  void advance(port::Instant now) override;
  bool take_answer(port::BusAnswer& answer) override;
  std::optional<std::uint8_t> take_held_up() override { return std::exchange(held_up, {}); }
  port::Instant next_deadline() const override;

  void set(std::uint8_t unit, const NodeReading& reading);
  void set_registers(std::uint8_t unit, const NodeRegisters& registers);
  void set_result(std::uint8_t unit, port::BusResult result, std::uint8_t exception = 0);
  void silence(std::uint8_t unit) { units_.erase(unit); }
  // What the unit says to writes: nothing, or an exception.
  void refuse_writes(std::uint8_t unit, port::BusResult how, std::uint8_t exception = 0);

  std::optional<std::uint8_t> held_up;  // a unit that others have held up
  bool link_up = true;
  std::string why_no_link;  // that is told while it is not up
  port::Instant clear_at{};
  bool is_stuck = false;  // neither answers nor lets time pass
  std::size_t outstanding_max = 100;
  port::Duration silence_after_timeout{};
  // Of answers to reads, by unit; where it is too long none comes.
  std::map<std::uint8_t, port::Duration> delays;
  std::map<std::uint8_t, std::uint32_t> reads;      // by unit
  std::map<std::uint8_t, port::Duration> timeouts;  // of the last read, by unit
  std::map<std::uint8_t, std::uint32_t> writes;     // by unit, also in vain
  struct Written {
    std::uint8_t address;
    std::uint16_t first;
    std::vector<std::uint16_t> values;
  };
  std::vector<Written> written;  // and confirmed

 private:
  struct ScriptedUnit {
    port::BusResult result = port::BusResult::ok;
    std::uint8_t exception = 0;
    NodeRegisters registers{};
    port::BusResult to_writes = port::BusResult::ok;
    std::uint8_t exception_to_writes = 0;
  };
  struct Request {
    std::uint8_t address;
    std::uint32_t ticket;
    bool is_write;
  };
  struct Waiting {
    Request request;
    port::Instant deadline;
    bool is_answered = false;
  };
  bool take_in(const port::RegisterWrite& write);

  port::Instant now_{};
  port::Instant silent_until_{};
  std::map<std::uint8_t, ScriptedUnit> units_;
  std::vector<Waiting> waiting_;
  std::deque<Request> done_;
  std::deque<Request> timed_out_;
  NodeRegisters handed_{};
  std::vector<std::uint8_t> repeated_;
};

class RecordingServer final : public port::MeshServer {
 public:
  void publish(std::shared_ptr<const port::RegisterImage> image) override {
    images.push_back(std::move(image));
  }
  // The value of a header row by its name.
  std::uint32_t header(const std::string& name) const;
  std::vector<std::shared_ptr<const port::RegisterImage>> images;
};

class RecordingFiles final : public port::MeshFiles {
 public:
  void start_check() override {
    ++checks;
    is_check_ = has_news_ = true;
  }
  void start_write(std::shared_ptr<const files::MeshImage> image) override {
    ++attempts;
    has_news_ = true;
    is_check_ = false;
    if (!failing) nodes_written.push_back(image->node_count);
    last = std::move(image);
  }
  bool take_result(port::DiskResult& result) override {
    if (!has_news_ || (is_unresponsive && !is_check_)) return false;
    has_news_ = false;
    if (is_check_) {
      result = {.ok = !is_folder_missing, .why = is_folder_missing ? "no such folder" : ""};
      return true;
    }
    result = {.ok = !failing, .why = failing ? "the disk is full" : ""};
    return true;
  }
  bool failing = false;
  bool is_unresponsive = false;  // while it writes
  bool is_folder_missing = false;
  std::uint32_t checks = 0;
  std::uint32_t attempts = 0;
  std::vector<std::uint32_t> nodes_written;
  std::shared_ptr<const files::MeshImage> last;  // tried to write; null before

 private:
  bool has_news_ = false;
  bool is_check_ = false;
};

// One bus with units 1 to 20, asked every 100 ms.
struct Rig {
  explicit Rig(std::vector<FeatureSettings> features = {}, std::uint32_t vertices_max = 100);

  void start();
  // One bus for each of settings.buses.
  void start_with(const std::vector<port::NodeBus*>& buses);
  // Runs the gateway for this long.
  void run(port::Duration duration, port::Duration step = std::chrono::milliseconds(10));
  // Gives the gateway the settings as they are here now.
  void update_settings(const std::vector<port::NodeBus*>& added = {});
  // Unit `unit` is the node with serial 1000 + unit.
  void put(std::uint8_t unit, std::int32_t x, std::int32_t y,
           std::uint16_t status = node_status::fix_valid);
  // Units 1 to 4 at the corners of a square of 100, counter-clockwise from (0, 0).
  void put_square();

  Settings settings;
  SimulatedClock clock;
  RecordingLog log;
  ScriptedBus bus;
  RecordingServer server;
  RecordingFiles files;
  port::Store* store = nullptr;
  const port::WallClock* wall_clock = nullptr;
  port::MessageBroker* broker = nullptr;
  std::uint64_t run_number = 1;
  std::string version;
  std::vector<std::byte> memory;
  Mesh mesh;
  std::vector<PolledBus> polled;
  std::unique_ptr<Gateway> gateway;
};

// A second bus like the first, named gate, whose unit n is the node with serial 2000 + n.
struct TwoBuses : Rig {
  TwoBuses();
  void put_other(std::uint8_t unit, std::int32_t x, std::int32_t y);

  ScriptedBus other;
};

FeatureSettings feature(std::uint32_t from, std::uint32_t to);

}  // namespace etcm::firmware
