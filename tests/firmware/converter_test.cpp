// The default settings behind a converter from Modbus TCP to a serial line: one queue, one line,
// and a unit that does not answer holds it until the converter's own patience is over. Poller and
// bus are real; converter and time are the test's.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <string>
#include <vector>

#include "fakes.h"
#include "firmware/polling/poller.h"
#include "firmware/protocol/node_registers.h"
#include "modbus/replies.h"
#include "modbus/tcp_bus.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

// How a device behind the connection behaves.
struct Behind {
  std::uint8_t units = 20;
  std::vector<std::uint8_t> dead{};
  port::Duration exchange = 30ms;  // of a unit that answers
  port::Duration hold = 1s;        // of one that does not
  std::uint8_t exception = 0x0b;   // then; 0: it says nothing
  bool is_one_line = true;         // else all units answer beside each other
};

class Device final : public port::FrameConnection {
 public:
  explicit Device(const Behind& behind) : behind_(behind) {}

  State state() const override { return state_; }
  void connect(const port::Endpoint&, port::Instant, port::Duration) override {
    state_ = State::up;
    listener().on_connected();
  }
  void advance(port::Instant) override {}
  port::Instant next_deadline() const override { return port::never; }
  void send(std::span<std::uint8_t> frame, std::uint16_t transaction, std::uint8_t unit,
            std::size_t pdu_bytes) override {
    const auto pdu = frame.subspan(port::mbap_header_bytes, pdu_bytes);
    waiting_.push_back(
        {.transaction = transaction, .address = unit, .pdu = {pdu.begin(), pdu.end()}});
    requests[unit] += 1;
    if (!behind_.is_one_line || waiting_.size() == 1) begin(waiting_.back(), now_);
    longest_queue = std::max(longest_queue, waiting_.size());
  }
  void discard() override {}
  void close() override {
    state_ = State::down;
    waiting_.clear();
  }
  void abort() override { close(); }

  void pass_to(port::Instant now) {
    for (port::Instant due = next(); due <= now; due = next()) {
      const auto done = std::min_element(
          waiting_.begin(), waiting_.end(),
          [](const Request& a, const Request& b) { return a.done_at < b.done_at; });
      const Request request = *done;
      waiting_.erase(done);
      now_ = due;
      if (behind_.is_one_line && !waiting_.empty()) begin(waiting_.front(), due);
      answer(request);
    }
    now_ = now;
  }
  port::Instant next() const {
    port::Instant next = port::never;
    for (const Request& request : waiting_) next = std::min(next, request.done_at);
    return next;
  }
  void fall_silent(bool is_silent) { is_silent_ = is_silent; }

  std::size_t longest_queue = 0;
  std::array<std::uint32_t, 256> requests{};

 private:
  struct Request {
    std::uint16_t transaction = 0;
    std::uint8_t address = 0;
    std::vector<std::uint8_t> pdu;
    port::Instant done_at = port::never;
  };

  bool is_dead(std::uint8_t unit) const {
    return is_silent_ || unit > behind_.units ||
           std::find(behind_.dead.begin(), behind_.dead.end(), unit) != behind_.dead.end();
  }
  void begin(Request& request, port::Instant now) {
    request.done_at = now + (is_dead(request.address) ? behind_.hold : behind_.exchange);
  }
  void answer(const Request& request) {
    std::array<std::uint8_t, port::pdu_bytes_max> pdu;
    std::size_t size = 0;
    if (is_dead(request.address)) {
      if (behind_.exception == 0) return;
      size = port::write_exception(pdu, request.pdu[0], behind_.exception);
    } else {
      const NodeRegisters registers = encode_node(
          {.serial = Serial{request.address}, .position = {}, .status = node_status::fix_valid}, 1);
      size = replies_.to_read(request.pdu, node_register_first, registers, pdu);
    }
    listener().on_frame({.transaction = request.transaction,
                         .address = request.address,
                         .pdu = std::span(pdu).first(size)});
  }

  Behind behind_;
  State state_ = State::down;
  bool is_silent_ = false;
  port::Instant now_{1h};
  std::deque<Request> waiting_;
  port::Replies replies_;
};

class ConverterSite final : public ReadingListener {
 public:
  explicit ConverterSite(const Behind& behind, std::vector<UnitRange> units = {})
      : device(behind),
        readings(256),
        settings_{.name = "yard",
                  .link = port::Endpoint{},
                  .units = units.empty() ? std::vector<UnitRange>{{1, behind.units}} : units,
                  .timeout = 200ms,
                  .outstanding_max = 4,
                  .send_enable = {}} {}

  void run_for(port::Duration time) {
    for (const port::Instant end = now_ + time; now_ < end;) {
      poller_.step(now_);
      now_ = std::max(now_ + 1us, std::min({poller_.next_deadline(), device.next(), end}));
      device.pass_to(now_);
    }
  }

  bool on_reading(UnitIndex unit, const NodeReading&, std::span<const Measurement>,
                  port::Instant) override {
    ++readings[poller_.address_of(unit).value];
    return true;
  }
  std::uint32_t all_readings() const {
    std::uint32_t sum = 0;
    for (const std::uint32_t count : readings) sum += count;
    return sum;
  }
  std::uint64_t timeouts_of_healthy(const Behind& behind) const {
    std::uint64_t sum = 0;
    for (UnitIndex unit{0}; unit.value < poller_.unit_count(); ++unit.value) {
      const std::uint8_t address = poller_.address_of(unit).value;
      if (std::find(behind.dead.begin(), behind.dead.end(), address) == behind.dead.end()) {
        sum += poller_.counters(unit).count(port::BusResult::timeout);
      }
    }
    return sum;
  }

  std::uint32_t dead_requests(const Behind& behind) const {
    std::uint32_t sum = 0;
    for (const std::uint8_t unit : behind.dead) sum += device.requests[unit];
    return sum;
  }
  std::string logged() const { return testing::PrintToString(log.lines); }

  Device device;
  RecordingLog log;
  std::vector<std::uint32_t> readings;  // by unit

 private:
  port::Instant now_{1h};
  PollSettings poll_{.interval = 1s, .absent_interval = 10s};
  BusSettings settings_;
  port::TcpBus bus_{
      device, log, {.name = "yard", .end = {}, .outstanding_max = 4, .reconnect_interval = 1s}};
  std::vector<PolledBus> polled_{{.bus = &bus_, .settings = &settings_}};
  Poller poller_{poll_, polled_, *this, log};
};

struct Converter {
  const char* name;
  Behind behind;
};
class BehindAConverter : public testing::TestWithParam<Converter> {};

// Of a line on which nobody is dead, for the time that the dead ones did not hold it.
TEST_P(BehindAConverter, HealthyUnitsLoseNoPolls) {
  const Behind& behind = GetParam().behind;
  ConverterSite site(behind);
  std::vector<UnitRange> healthy;
  for (std::uint8_t unit = 1; unit <= behind.units; ++unit) {
    if (std::find(behind.dead.begin(), behind.dead.end(), unit) == behind.dead.end()) {
      healthy.push_back({unit, unit});
    }
  }
  ConverterSite without(behind, healthy);
  // It finds out whom it can ask, and how.
  for (ConverterSite* const each : {&site, &without}) each->run_for(20s);
  const std::uint32_t before = site.all_readings(), before_without = without.all_readings();
  const std::uint32_t asked_before = site.dead_requests(behind);
  for (ConverterSite* const each : {&site, &without}) each->run_for(300s);
  const double held = (site.dead_requests(behind) - asked_before) *
                      std::chrono::duration<double>(behind.hold).count();
  EXPECT_GE(site.all_readings() - before, (behind.hold > 1s ? 0.98 : 0.99) *
                                              (without.all_readings() - before_without) *
                                              (1 - held / 300));
  EXPECT_LE(held / 300, behind.units == 2 ? 0.12 : 0.04);
  EXPECT_GE(held, behind.dead.empty() ? 0.0 : 2.0) << "they may come back";
}

TEST_P(BehindAConverter, NorDoTheyTimeOutAndNothingPilesUp) {
  const Behind& behind = GetParam().behind;
  ConverterSite site(behind);
  site.run_for(60s);
  EXPECT_LE(site.timeouts_of_healthy(behind), 4u) << site.logged();
  EXPECT_LE(site.device.longest_queue, 6u);
  for (std::uint8_t unit = 1; unit <= behind.units; ++unit) {
    const bool is_dead =
        std::find(behind.dead.begin(), behind.dead.end(), unit) != behind.dead.end();
    EXPECT_EQ(site.readings[unit] > 0, !is_dead) << "unit " << int{unit};
  }
}

INSTANTIATE_TEST_SUITE_P(
    Rows, BehindAConverter,
    testing::Values(Converter{"one_dead", {.units = 21, .dead = {11}}},
                    Converter{"first_dead", {.units = 21, .dead = {1}}},
                    Converter{"last_dead", {.units = 21, .dead = {21}}},
                    Converter{"path_unavailable", {.units = 21, .dead = {11}, .exception = 0x0a}},
                    Converter{"says_nothing", {.units = 21, .dead = {11}, .exception = 0}},
                    Converter{"short_hold", {.units = 21, .dead = {11}, .hold = 300ms}},
                    Converter{"long_hold", {.units = 21, .dead = {11}, .hold = 3s}},
                    Converter{"three_dead", {.units = 23, .dead = {1, 2, 20}}},
                    Converter{"one_unit_and_a_dead_one", {.units = 2, .dead = {1}}},
                    Converter{"all_at_9600_baud", {.units = 60, .exchange = 50400us}},
                    Converter{"some_dead_at_9600_baud",
                              {.units = 60, .dead = {3, 30}, .exchange = 50400us}},
                    Converter{"all_at_1200_baud", {.units = 60, .exchange = 403ms}}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(Converter, IsSaidOnceWithWhatToSet) {
  ConverterSite site({.units = 21, .dead = {21}});
  site.run_for(300s);
  ASSERT_EQ(site.log.lines.size(), 2u) << site.logged();
  const std::string& line = site.log.lines.back();
  EXPECT_EQ(line.find("bus yard: unit 21 was answered for too late, after 1000 ms"), 0u) << line;
  EXPECT_NE(line.find("set outstanding = 1, and [[bus.device]] with units = \"21\" and timeout = "
                      "\"1300ms\""),
            std::string::npos)
      << line;
}

TEST(Converter, IsSaidAgainWhileItGoesOn) {
  ConverterSite site({.units = 21, .dead = {21}});
  site.run_for(59min);
  EXPECT_EQ(site.log.count("answered for too late"), 1u) << site.logged();
  site.run_for(5h);
  EXPECT_EQ(site.log.count("answered for too late"), 6u) << site.logged();
}

TEST(Converter, ALineThatWasOutIsBackWithinTwoPolls) {
  ConverterSite site({.units = 20});
  site.run_for(20s);
  site.device.fall_silent(true);
  site.run_for(60s);
  site.device.fall_silent(false);
  site.run_for(1s);  // that is when it answers for the last question
  const std::vector<std::uint32_t> before = site.readings;
  site.run_for(2s);
  for (std::uint8_t unit = 1; unit <= 20; ++unit) {
    EXPECT_GT(site.readings[unit], before[unit]) << "unit " << int{unit};
  }
}

// Nobody answers, and nobody says so: each is asked in its time.
TEST(UnitsBesideEachOther, AreFoundAmongManyThatAreNotThere) {
  ConverterSite site({.units = 0, .hold = 1h, .exception = 0, .is_one_line = false}, {{1, 247}});
  site.run_for(25s);
  for (std::uint8_t unit = 1; unit <= 247; ++unit) EXPECT_GE(site.device.requests[unit], 1u);
}

TEST(UnitsBesideEachOther, AreAskedBesideEachOther) {
  // Each takes 150 ms; four at a time are 26 a second, of 30 that are due.
  const Behind behind{.units = 30,
                      .dead = {7},
                      .exchange = 150ms,
                      .hold = 1h,
                      .exception = 0,
                      .is_one_line = false};
  ConverterSite site(behind);
  site.run_for(20s);
  const std::uint32_t before = site.all_readings();
  site.run_for(100s);
  EXPECT_GE(site.all_readings() - before, 2500u);
}

TEST(UnitsBesideEachOther, AreWaitedForAsLongAsTheyNeed) {
  ConverterSite site({.units = 4, .exchange = 350ms, .is_one_line = false});
  site.run_for(20s);
  const std::vector<std::uint32_t> before = site.readings;
  site.run_for(60s);
  for (std::uint8_t unit = 1; unit <= 4; ++unit) EXPECT_GE(site.readings[unit] - before[unit], 58u);
  EXPECT_GE(site.log.count("was answered for too late, after 350 ms"), 3u) << site.logged();
}

}  // namespace
}  // namespace etcm::firmware
