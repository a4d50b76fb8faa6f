// Units on a serial line that answer later than they are waited for: what the gateway believes must
// be what the unit knew when it was asked. Poller and bus are real; line and time are the test's.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "fakes.h"
#include "firmware/polling/poller.h"
#include "firmware/protocol/node_registers.h"
#include "modbus/replies.h"
#include "modbus/rtu_bus.h"
#include "support/emulated.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

// As the settings have it where they say nothing else.
constexpr port::Duration answer_timeout = 200ms;
// 29 bytes and two silences at 19200 baud.
constexpr port::Duration on_the_line = 21ms;

// How long a unit takes for the nth question it hears; nothing where it does not answer.
using Latency = std::function<std::optional<port::Duration>(std::uint8_t unit, std::uint32_t nth)>;

// Each answer comes when it comes, whatever else is on the line. What a unit reports as its place
// is the millisecond in which it was asked.
class LateLine final : public port::RtuLine {
 public:
  LateLine(const port::SerialLine& line, Latency latency)
      : character_(character_time(line)),
        silence_(frame_silence(line)),
        latency_(std::move(latency)) {}

  bool open(port::Instant, std::string&) override { return true; }
  void close() override { forget_all(); }
  const char* why_gone() const override { return nullptr; }
  void discard() override { forget_all(); }
  bool is_sent() const override { return true; }

  // Lets what is due by now be heard.
  void pass_to(port::Instant now) {
    now_ = now;
    while (!coming_.empty() && coming_.front().at <= now) {
      hear(coming_.front().frame);
      answers_asked_at[coming_.front().frame[0]] = coming_.front().asked;
      coming_.erase(coming_.begin());
    }
  }
  port::Instant next() const { return coming_.empty() ? port::never : coming_.front().at; }

  std::array<std::uint32_t, 256> heard{};             // questions, by unit
  std::array<port::Instant, 256> answers_asked_at{};  // of the last answer that came

 private:
  struct Answer {
    port::Instant at;
    port::Instant asked;
    std::vector<std::uint8_t> frame;
  };

  bool write(std::span<const std::uint8_t> frame, std::string&) override {
    const std::uint8_t unit = frame[0];
    const auto latency = latency_(unit, heard[unit]++);
    if (!latency) return true;
    const auto pdu = frame.subspan(port::rtu_unit_bytes,
                                   frame.size() - port::rtu_unit_bytes - port::rtu_checksum_bytes);
    const port::Instant asked = now_ + static_cast<std::int64_t>(frame.size()) * character_;
    Answer answer{
        .at = {}, .asked = asked, .frame = std::vector<std::uint8_t>(port::rtu_frame_bytes_max)};
    answer.frame.resize(port::wrap_rtu(
        answer.frame, unit,
        answer_to(pdu, unit, asked, std::span(answer.frame).subspan(port::rtu_unit_bytes))));
    answer.at =
        asked + silence_ + *latency + static_cast<std::int64_t>(answer.frame.size()) * character_;
    coming_.insert(std::upper_bound(coming_.begin(), coming_.end(), answer.at,
                                    [](port::Instant at, const Answer& b) { return at < b.at; }),
                   std::move(answer));
    return true;
  }

  std::size_t answer_to(std::span<const std::uint8_t> pdu, std::uint8_t unit, port::Instant asked,
                        std::span<std::uint8_t> answer) {
    if (pdu[0] == port::write_holding_registers) {
      std::uint8_t exception = 0;
      std::array<std::uint16_t, port::write_registers_max> values;
      const std::uint16_t first = port::parse_write_request(pdu, exception)->first;
      return replies_.to_write(pdu, first, values, answer);
    }
    const std::int64_t ms = asked.time_since_epoch() / 1ms;
    const NodeRegisters registers =
        encode_node({.serial = Serial{unit},
                     .position = {.x = static_cast<std::int32_t>(ms % position_max),
                                  .y = static_cast<std::int32_t>(ms / position_max)},
                     .status = node_status::fix_valid},
                    static_cast<std::uint16_t>(ms));
    return replies_.to_read(pdu, node_register_first, registers, answer);
  }

  port::Duration character_;
  port::Duration silence_;
  Latency latency_;
  port::Replies replies_;
  port::Instant now_{};
  std::vector<Answer> coming_;  // by time
};

// Reads and writes between the polls, at any unit that is free for them.
class Interruptions final : public RequestSource {
 public:
  Interruptions(std::uint8_t units, const LateLine& line) : units_(units), line_(line) {}
  const Poller* poller = nullptr;  // null: there are none
  port::Instant request_due(BusIndex) const override {
    return poller == nullptr ? port::never : due_;
  }
  bool next_request(BusIndex, port::Instant now, BusRequest& request) override {
    const UnitIndex unit{static_cast<std::uint32_t>(random_() % units_)};
    due_ = now + random_() % 700 * 1ms;
    request = {.address = ModbusAddress{static_cast<std::uint8_t>(unit.value + 1)}, .values = {}};
    if (random_() % 2 == 0) {
      if (poller->read_free_at(unit) > now) return false;
      request.read_count = node_register_count;
      request.spare = stranger_register_spare;
    } else {
      if (poller->write_free_at(unit) > now) return false;
      request.first = configuration_register_first;
      request.values = std::span(written_).first(1 + random_() % 2);
    }
    return true;
  }
  void on_request_done(BusIndex, const port::BusAnswer& answer, port::Instant now) override {
    if (answer.result != port::BusResult::ok) return;
    EXPECT_LE(now - line_.answers_asked_at[answer.address], answer_timeout + on_the_line)
        << "unit " << int{answer.address};
    ++answered;
  }
  std::uint32_t answered = 0;

 private:
  std::uint32_t units_;
  const LateLine& line_;
  port::Instant due_{};
  std::minstd_rand random_{5};
  std::array<std::uint16_t, 2> written_{};
};

// Others on the line: they ask what the gateway asks, and other things, of any unit.
class LateClients final : public port::LineClients {
 public:
  // What they want, by turns; nothing: nobody shares the line.
  enum class Wish : std::uint8_t { nothing, anything, flood_of_last_unit, flood_of_first_unit };

  LateClients(Wish wish, std::uint8_t units, const LateLine& line, const port::Instant& now)
      : wish_(wish), units_(units), line_(line), now_(now) {}

  bool is_waiting() const override {
    return wish_ != Wish::nothing && !is_under_way_ && due_ <= now_;
  }
  bool next(port::ClientRequest& request) override {
    if (!is_waiting()) return false;
    is_under_way_ = true;
    pdu_ = {4, 0, 0, 0, node_register_count};
    unit_ = wish_ == Wish::flood_of_first_unit ? std::uint8_t{1} : units_;
    if (wish_ == Wish::anything) choose();
    request = {.address = unit_, .pdu = pdu_};
    return true;
  }
  void answer(std::span<const std::uint8_t> pdu) override {
    is_under_way_ = false;
    EXPECT_LE(now_ - line_.answers_asked_at[unit_], answer_timeout + on_the_line)
        << "unit " << int{unit_} << " function " << int{pdu_[0]} << " answered " << int{pdu[0]};
    ++answered;
  }
  void refuse(port::ClientRefusal why) override {
    is_under_way_ = false;
    // It is not asked in vain all the time, and a flood has more requests at once.
    due_ = now_ + (wish_ == Wish::anything ? 0ms : 1ms);
    EXPECT_EQ(why, port::ClientRefusal::no_answer);
    ++refused;
  }
  bool is_shared() const override { return wish_ != Wish::nothing; }
  const port::ClientCounters& counters() const override { return counters_; }

  std::uint32_t answered = 0;
  std::uint32_t refused = 0;

 private:
  void choose() {
    unit_ = static_cast<std::uint8_t>(random_() % units_ + 1);
    due_ = now_ + random_() % 500 * 1ms;
    switch (random_() % 4) {
      case 0:  // as the gateway asks
        break;
      case 1:  // with its other function, as many registers as it may ask for
        pdu_ = {3, 0, 0, 0, static_cast<std::uint8_t>(node_register_count - random_() % 8)};
        break;
      case 2:  // what is not there
        pdu_ = {static_cast<std::uint8_t>(3 + random_() % 2), 0x40, 0, 0, node_register_count};
        break;
      default:
        pdu_ = {16, 0, static_cast<std::uint8_t>(random_() % 3), 0, 1, 2, 0, 7};
    }
  }

  Wish wish_;
  std::uint8_t units_;
  const LateLine& line_;
  const port::Instant& now_;
  port::Instant due_{};
  std::minstd_rand random_{9};
  bool is_under_way_ = false;
  std::uint8_t unit_ = 1;
  std::vector<std::uint8_t> pdu_;
  port::ClientCounters counters_;
};

struct LateUnitsOnABus {
  std::uint8_t first = 1;
  std::uint8_t units = 1;  // the last one
  port::Duration interval = 1s;
  bool is_interrupted = false;
  std::vector<DeviceSettings> devices{};
  LateClients::Wish clients = LateClients::Wish::nothing;
};

class LateSite final : public ReadingListener {
 public:
  LateSite(const LateUnitsOnABus& site, Latency latency)
      : line(serial_, std::move(latency)),
        readings(site.units + 1u),
        requests(site.units, line),
        clients(site.clients, site.units, line, now_),
        // Who does not answer is asked as often as the others.
        poll_{.interval = site.interval, .absent_interval = site.interval},
        settings_{.name = "yard",
                  .link = serial_,
                  .units = {{.first = site.first, .last = site.units}},
                  .timeout = answer_timeout,
                  .devices = site.devices,
                  .quiet = 50ms,
                  .outstanding_max = 1,
                  .send_enable = {},
                  .share = {.listen = {}, .percent = 20}} {
    start();
    if (site.is_interrupted) requests.poller = &gateway_->poller;
  }

  // Until so many questions were heard.
  void run(std::uint32_t questions) {
    for (std::uint32_t asked = 0; asked < questions && !testing::Test::HasFailure();) {
      gateway_->poller.step(now_);
      asked = 0;
      for (const std::uint32_t count : line.heard) asked += count;
      now_ = std::max(now_ + 1us, std::min(gateway_->poller.next_deadline(), line.next()));
      line.pass_to(now_);
    }
  }
  void run_for(port::Duration time) {
    for (const port::Instant end = now_ + time; now_ < end;) {
      gateway_->poller.step(now_);
      now_ = std::max(now_ + 1us, std::min({gateway_->poller.next_deadline(), line.next(), end}));
      line.pass_to(now_);
    }
  }

  bool on_reading(UnitIndex index, const NodeReading& reading, std::span<const Measurement>,
                  port::Instant now) override {
    const std::uint8_t unit = gateway_->poller.address_of(index).value;
    const port::Duration limit = timeout_of(settings_, ModbusAddress{unit});
    const port::Instant asked{
        (std::int64_t{reading.position.y} * position_max + reading.position.x) * 1ms};
    EXPECT_LE(now - asked, limit + on_the_line + 1ms) << "unit " << int{unit};
    EXPECT_EQ(reading.serial, Serial{unit});
    ++readings[unit];
    return true;
  }

  // The gateway ends, and is started anew; what units owe it is still to come.
  void restart_after(port::Duration pause) {
    now_ += pause;
    line.pass_to(now_);
    const bool is_interrupted = requests.poller != nullptr;
    start();
    if (is_interrupted) requests.poller = &gateway_->poller;
  }

  std::string logged() const { return testing::PrintToString(log.lines); }

 private:
  port::SerialLine serial_{.path = "line"};

 public:
  LateLine line;
  std::vector<std::uint32_t> readings;  // by unit
  RecordingLog log;
  Interruptions requests;

 private:
  port::Instant now_{1h};

 public:
  LateClients clients;

 private:
  PollSettings poll_;
  BusSettings settings_;

  // What is new at each start.
  struct Gateway {
    explicit Gateway(LateSite& site)
        : bus(site.line, site.log,
              {.name = "yard",
               .serial_line = site.serial_,
               .clearing = answer_timeout + port::late_answer_max,
               .quiet = 50ms,
               .reopen_interval = 1s,
               .send_enable = {}}),
          polled{{.bus = &bus, .settings = &site.settings_, .clients = &site.clients}},
          poller(site.poll_, polled, site, site.log, &site.requests) {}
    port::RtuBus bus;
    std::vector<PolledBus> polled;
    Poller poller;
  };
  void start() { gateway_.emplace(*this); }
  std::optional<Gateway> gateway_;
};

TEST(LateAnswers, TheAnswerToTheFirstQuestionIsNotTakenForTheThirds) {
  LateSite site({}, [](auto...) { return 1350ms; });
  site.run_for(60s);
  EXPECT_EQ(site.readings[1], 0u);
  EXPECT_GE(site.line.heard[1], 20u);
}

// It owes an answer when the gateway ends, and each one that were taken for the next question's
// would leave another.
TEST(LateAnswers, AnswersToAnEarlierRunAreTakenForNone) {
  for (const port::Duration pause : {0ms, 100ms, 1100ms, 1300ms}) {
    LateSite site({}, [](auto...) { return 1350ms; });
    site.run_for(60s + 50ms);
    site.restart_after(pause);
    site.run_for(60s);
    EXPECT_EQ(site.readings[1], 0u) << pause / 1ms << " ms";
  }
}

TEST(LateAnswers, TheLogSaysHowLateTheyAreAndItsAdviceHelps) {
  LateSite late({}, [](auto...) { return 1350ms; });
  late.run_for(60s);
  ASSERT_EQ(late.log.count("unit 1 answered too late"), 1u) << late.logged();
  const std::string& line = late.log.lines.back();
  const auto number_behind = [&](const std::string& words) {
    const std::size_t at = line.find(words);
    EXPECT_NE(at, std::string::npos) << line;
    return std::stoi(line.substr(at + words.size()));
  };
  const int lateness_ms = number_behind("after ");
  EXPECT_GE(lateness_ms, 1350);
  EXPECT_LE(lateness_ms, 1350 + 25);
  EXPECT_NE(line.find("[[bus.device]] with units = \"1\""), std::string::npos) << line;
  const int advised_ms = number_behind("timeout = \"");
  EXPECT_GE(advised_ms, 1350);
  EXPECT_LE(advised_ms, 2 * 1350);
  LateSite mended({.devices = {{.units = {{.first = 1, .last = 1}},
                                .profile = node_profile,
                                .timeout = std::chrono::milliseconds(advised_ms)}}},
                  [](auto...) { return 1350ms; });
  mended.run_for(60s);
  EXPECT_GE(mended.readings[1], 30u);
}

// Its units owe answers then, and are asked all the same.
TEST(LateAnswers, AreSaidAgainEachHourWhileTheyGoOn) {
  bool is_late = true;
  LateSite site({}, [&](auto...) { return is_late ? 1350ms : 10ms; });
  site.run_for(59min);
  EXPECT_EQ(site.log.count("unit 1 answered too late"), 1u) << site.logged();
  site.run_for(5h);
  EXPECT_EQ(site.log.count("unit 1 answered too late"), 6u) << site.logged();
  is_late = false;
  site.run_for(5h);
  EXPECT_EQ(site.log.count("unit 1 answered too late"), 6u) << site.logged();
}

TEST(LateAnswers, ALineThatWasOutIsBackWithinTwoPolls) {
  for (const std::uint8_t units : {std::uint8_t{1}, std::uint8_t{10}}) {
    for (const port::Duration outage : {1500ms, 4000ms, 20'000ms, 61'000ms}) {
      bool is_out = false;
      LateSite site({.units = units}, [&](auto...) -> std::optional<port::Duration> {
        if (is_out) return std::nullopt;
        return 3ms;
      });
      site.run_for(10s);
      is_out = true;
      site.run_for(outage);
      is_out = false;
      const std::vector<std::uint32_t> before = site.readings;
      site.run_for(2s);
      for (std::uint8_t unit = 1; unit <= units; ++unit) {
        EXPECT_GT(site.readings[unit], before[unit])
            << "unit " << int{unit} << " after " << outage / 1ms << " ms";
      }
    }
  }
}

TEST(LateAnswers, AFrameThatIsLostNowAndThenCostsItsOwnPollOnly) {
  std::minstd_rand random(3);
  LateSite site({.units = 5}, [&](auto...) -> std::optional<port::Duration> {
    if (random() % 10 == 0) return std::nullopt;
    return 3ms;
  });
  site.run_for(1000s);
  for (std::uint8_t unit = 1; unit <= 5; ++unit) EXPECT_GE(site.readings[unit], 950u);
}

struct Pattern {
  const char* name;
  Latency (*latency)();
};

constexpr port::Duration latest = answer_timeout + port::late_answer_max;

port::Duration up_to(port::Duration most, std::minstd_rand& random) {
  return std::chrono::milliseconds(random() % static_cast<std::uint32_t>(most / 1ms + 1));
}

// Units 1 to 3 are late, the others are not; 9 is dead.
class LateUnits : public testing::TestWithParam<std::tuple<Pattern, int>> {
 protected:
  static constexpr std::uint8_t units = 9;
  static LateUnitsOnABus site(bool is_interrupted) {
    return {.units = units,
            .interval = std::get<1>(GetParam()) * 1ms,
            .is_interrupted = is_interrupted};
  }
  static Latency latency() {
    return [late = std::get<0>(GetParam()).latency()](
               std::uint8_t unit, std::uint32_t nth) -> std::optional<port::Duration> {
      if (unit == units) return std::nullopt;
      return unit <= 3 ? late(unit, nth) : 3ms;
    };
  }
};

TEST_P(LateUnits, NeverHaveAnAnswerBelievedThatIsNotToTheQuestion) {
  LateSite site(LateUnits::site(false), latency());
  site.run(60'000 / test::thinning_if_emulated);
  EXPECT_EQ(site.readings[units], 0u);
}

// Whatever an earlier run has asked, and however soon the next one begins.
TEST_P(LateUnits, NorAfterARestart) {
  LateSite site(LateUnits::site(true), latency());
  std::minstd_rand random(7);
  std::uint32_t readings = 0;
  for (int restart = 0; restart < 400 / test::thinning_if_emulated; ++restart) {
    site.run_for(up_to(20s, random));
    site.restart_after(up_to(500ms, random));
  }
  for (const std::uint32_t count : site.readings) readings += count;
  EXPECT_GT(readings, 1000u / test::thinning_if_emulated);
}

// Then all the time is theirs.
TEST_P(LateUnits, NorWhereNobodyElseIsOnTheLine) {
  LateUnitsOnABus alone = LateUnits::site(true);
  alone.units = 3;
  LateSite site(alone, latency());
  site.run(60'000 / test::thinning_if_emulated);
}

TEST_P(LateUnits, NorBetweenErrandsAndWrites) {
  LateSite site(LateUnits::site(true), latency());
  site.run(60'000 / test::thinning_if_emulated);
  EXPECT_GT(site.requests.answered, 100u / test::thinning_if_emulated);
}

// Whatever the others ask: neither has the other's answers.
TEST_P(LateUnits, NorBetweenTheRequestsOfThoseWhoShareTheLine) {
  LateUnitsOnABus shared = LateUnits::site(true);
  shared.clients = LateClients::Wish::anything;
  LateSite site(shared, latency());
  site.run(60'000 / test::thinning_if_emulated);
  EXPECT_GT(site.clients.answered, 100u / test::thinning_if_emulated);
}

// Against a line on which they are not asked at all; those that are in time now and then have some
// polls of their own.
TEST_P(LateUnits, CostTheOthersNoMoreThanDeadOnesDo) {
  LateSite with(LateUnits::site(false), latency());
  LateUnitsOnABus only_others = LateUnits::site(false);
  only_others.first = 4;
  only_others.units = units - 1;
  LateSite without(only_others, latency());
  std::array<std::uint32_t, 2> polls{};
  for (LateSite* const site : {&with, &without}) {
    site->run_for(30s);  // it learns
    std::uint32_t& count = polls[site == &without];
    for (std::uint8_t unit = 4; unit < units; ++unit) count -= site->readings[unit];
    site->run_for(300s);
    for (std::uint8_t unit = 4; unit < units; ++unit) count += site->readings[unit];
  }
  EXPECT_GE(polls[0] * 100, polls[1] * 85);
}

// Nine units at 19200 baud and ten polls a second of each: the line is never idle.
TEST(SharedLineTime, OfABusyLineOthersHaveTheirShareAndNoMore) {
  for (const bool is_dead : {false, true}) {
    std::array<std::uint32_t, 2> polls{};
    std::uint32_t of_clients = 0;
    for (const bool is_shared : {false, true}) {
      const auto wish = !is_shared ? LateClients::Wish::nothing
                        : is_dead  ? LateClients::Wish::flood_of_last_unit
                                   : LateClients::Wish::flood_of_first_unit;
      LateSite site({.units = 9, .interval = 100ms, .clients = wish},
                    [](std::uint8_t unit, auto) -> std::optional<port::Duration> {
                      if (unit == 9) return std::nullopt;
                      return 3ms;
                    });
      site.run_for(20s);
      for (const std::uint32_t count : site.readings) polls[is_shared] -= count;
      of_clients = site.clients.answered;
      site.run_for(200s);
      for (const std::uint32_t count : site.readings) polls[is_shared] += count;
      of_clients = site.clients.answered - of_clients;
    }
    // A frame's silences are not counted.
    EXPECT_GE(polls[1] * 100, polls[0] * 76) << is_dead;
    if (!is_dead) {
      EXPECT_GE(of_clients * 100, polls[0] * 15) << "and what is theirs they have";
    }
  }
}

TEST(SharedLineTime, AnIdleLineIsTheirsBetweenThePolls) {
  LateSite site({.units = 1, .clients = LateClients::Wish::flood_of_first_unit},
                [](auto...) { return 3ms; });
  site.run_for(110s);
  EXPECT_GE(site.readings[1], 99u);
  EXPECT_GE(site.clients.answered, 1500u);
}

TEST(SharedLineTime, AFloodKeepsNoLineThatWasOutFromComingBack) {
  for (const auto wish :
       {LateClients::Wish::flood_of_last_unit, LateClients::Wish::flood_of_first_unit}) {
    bool is_out = false;
    LateSite site({.units = 3, .clients = wish}, [&](auto...) -> std::optional<port::Duration> {
      if (is_out) return std::nullopt;
      return 3ms;
    });
    site.run_for(10s);
    is_out = true;
    site.run_for(30s);
    is_out = false;
    const std::vector<std::uint32_t> before = site.readings;
    site.run_for(4s);
    for (std::uint8_t unit = 1; unit <= 3; ++unit) EXPECT_GT(site.readings[unit], before[unit]);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Patterns, LateUnits,
    testing::Combine(
        testing::Values(Pattern{"constant",
                                []() -> Latency {
                                  // Each length of time for a while.
                                  return [](std::uint8_t unit, std::uint32_t nth) {
                                    return std::min<port::Duration>((unit + nth / 50 % 26) * 200ms,
                                                                    latest);
                                  };
                                }},
                        Pattern{"growing",
                                []() -> Latency {
                                  return [](std::uint8_t unit, std::uint32_t nth) {
                                    return std::chrono::milliseconds(nth * unit * 7) % latest;
                                  };
                                }},
                        Pattern{"random",
                                []() -> Latency {
                                  return [random = std::minstd_rand(1)](auto...) mutable {
                                    return up_to(latest, random);
                                  };
                                }},
                        Pattern{"now_and_then",
                                []() -> Latency {
                                  return [random = std::minstd_rand(2)](
                                             auto...) mutable -> std::optional<port::Duration> {
                                    const auto kind = random() % 10;
                                    if (kind == 0) return std::nullopt;
                                    return kind < 4 ? up_to(latest, random) : 3ms;
                                  };
                                }}),
        testing::Values(100, 300, 1000)),
    [](const auto& row) {
      return std::string(std::get<0>(row.param).name) + "_" +
             std::to_string(std::get<1>(row.param)) + "_ms";
    });

}  // namespace
}  // namespace etcm::firmware
