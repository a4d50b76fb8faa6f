// How soon units that lost an answer are asked again on a line that has no time to spare, beside
// units that never answer.
#include <gtest/gtest.h>

#include <set>

#include "fakes.h"
#include "firmware/polling/bus_schedule.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

// Twenty units, of which 1 to 8 are dead, on a line that takes one request at a time and is asked
// for more than it can carry.
class LostAnswers : public testing::Test {
 protected:
  static constexpr std::uint8_t first = 9, last = 20, healthy = last - first + 1;

  LostAnswers() {
    rig_.bus.outstanding_max = 1;
    BusSettings& bus = rig_.settings.buses[0];
    bus.link = port::SerialLine{.path = "", .baud = 115200};
    bus.outstanding_max = 1;
    bus.timeout = 300ms;
    rig_.settings.poll.absent_interval = 100ms;
    rig_.settings.poll.stale_after = 20s;
    rig_.settings.poll.leave_after = 60s;
    for (std::uint8_t unit = first; unit <= last; ++unit) answer(unit);
  }

  void answer(std::uint8_t unit) { rig_.put(unit, unit * unit, 7 * unit % 11); }

  // Each of so many units loses its next answer.
  void lose_answers(std::uint8_t count) {
    std::map<std::uint8_t, std::uint32_t> before;
    for (std::uint8_t unit = last - count + 1; unit <= last; ++unit) {
      rig_.bus.silence(unit);
      before[unit] = rig_.bus.reads[unit];
    }
    while (!before.empty()) {
      rig_.run(10ms);
      std::erase_if(before, [&](const auto& asked) {
        if (rig_.bus.reads[asked.first] == asked.second) return false;
        // Its answer would come at once, but this question was heard by nobody.
        answer(asked.first);
        return true;
      });
    }
  }

  unsigned sound() const {
    unsigned count = 0;
    for (std::uint32_t unit = first; unit <= last; ++unit) {
      count += rig_.gateway->poller().is_sound(UnitIndex{unit - 1});
    }
    return count;
  }

  std::uint32_t reads_of_the_healthy() {
    std::uint32_t count = 0;
    for (std::uint8_t unit = first; unit <= last; ++unit) count += rig_.bus.reads[unit];
    return count;
  }

  Rig rig_;
};

TEST_F(LostAnswers, OfTheFirstQuestionsAreMadeUpForWithinHalfAMinute) {
  rig_.start();
  lose_answers(4);
  rig_.run(30s);
  EXPECT_EQ(sound(), unsigned{healthy});
}

TEST_F(LostAnswers, OfManyAtOnceAreMadeUpForWithinSeconds) {
  rig_.run(120s);
  ASSERT_EQ(sound(), unsigned{healthy});
  lose_answers(6);
  rig_.run(5s);
  EXPECT_EQ(sound(), unsigned{healthy});
}

// However many units lose answers: those that do not keep seven eighths of their polls.
TEST_F(LostAnswers, OfUnitsThatLoseEveryOtherOneCostTheOthersTheirShare) {
  rig_.run(120s);
  const std::uint32_t asked = rig_.bus.reads[first];
  rig_.run(120s);
  const std::uint32_t without = rig_.bus.reads[first] - asked;
  for (int step = 0; step < 12000; ++step) {
    for (std::uint8_t unit = last - 3; unit <= last; ++unit) {
      rig_.bus.reads[unit] % 2 == 1 ? rig_.bus.silence(unit) : answer(unit);
    }
    rig_.run(10ms);
  }
  EXPECT_GE((rig_.bus.reads[first] - asked - without) * 8, without * 7);
}

// Nor do units that never answer, from the first minute on.
TEST_F(LostAnswers, OfDeadUnitsCostTheOthersTheirShare) {
  rig_.run(60s);
  const std::uint32_t before = reads_of_the_healthy();
  rig_.run(60s);
  // A question and its answer take a step of 10 ms.
  EXPECT_GE((reads_of_the_healthy() - before) * 100, 6000 * 95);
}

// One answers so late that it spoils the answer of the other, which is asked next. Asked at even
// distances neither would ever be heard again.
TEST(AnswersThatMeet, DoNotMeetInEveryRoundWhereNobodyIsHeard) {
  ScriptedBus bus;
  PollSettings poll;
  poll.interval = 10s;
  BusSettings settings;
  settings.link = port::SerialLine{.path = "", .baud = 19200};
  settings.outstanding_max = 1;
  BusSchedule schedule(poll, settings, bus);
  schedule.add_unit(ModbusAddress{1}, true);
  schedule.add_unit(ModbusAddress{2}, true);
  port::Instant first_at{};
  std::set<port::Duration> distances;
  std::uint32_t rounds = 0;
  for (port::Instant now{1h}; now < port::Instant{2h}; now += 10ms) {
    const auto question = schedule.next_question(now);
    if (!question) continue;
    schedule.ask(*question, now);
    if (question->address.value == 1) {
      first_at = now;
    } else {
      distances.insert(now - first_at);
      ++rounds;
    }
    now += 250ms;
    port::BusAnswer none;
    none.result = port::BusResult::timeout;
    schedule.note_cost(question->address, none, now);
    schedule.note_failure(question->address, true, now);
  }
  EXPECT_GE(rounds, 360u);
  EXPECT_LE(rounds, 360u * 8 / 7 + 2);
  EXPECT_GE(distances.size(), 50u);
}

// A line, and what a question to each unit takes of its time.
class SomeLine {
 public:
  struct Unit {
    port::Duration takes{};
    port::Duration silence{};  // after a wait in vain
    bool answers = true;
    bool loses_every_other = false;  // of its answers: the bus waits for it in vain
    std::uint32_t blocks = 1;        // that it is read in, each soon after the one before
    std::uint32_t asked = 0;
    std::uint32_t read = 0;  // blocks of a sweep
    port::Instant read_at{};
  };

  SomeLine(const BusSettings& settings, bool is_behind_a_converter, std::uint8_t count)
      : timeout_(settings.timeout),
        schedule_(poll(), settings, is_behind_a_converter ? converter_ : line_) {
    for (std::uint8_t unit = 1; unit <= count; ++unit) {
      schedule_.add_unit(ModbusAddress{unit}, true);
      units[unit] = {.takes = 30ms};
    }
  }

  void run(port::Duration time) {
    for (const port::Instant end = now_ + time; now_ < end;) {
      const auto question = schedule_.next_question(now_);
      if (!question) {
        now_ += 10ms;
        continue;
      }
      Unit& unit = units.at(question->address.value);
      schedule_.ask(*question, now_);
      const bool is_lost = !unit.answers || (unit.loses_every_other && unit.asked % 2 == 0);
      ++unit.asked;
      now_ += is_lost && unit.answers ? timeout_ : unit.takes;
      port::BusAnswer answer;
      if (is_lost) {
        answer.result = port::BusResult::timeout;
        answer.silence = unit.silence;
      }
      schedule_.note_cost(question->address, answer, now_);
      if (is_lost || unit.read_at + 5s < now_) unit.read = 0;
      unit.read_at = now_;
      const bool is_whole = !is_lost && ++unit.read >= unit.blocks;
      if (is_whole) unit.read = 0;
      if (is_whole) schedule_.note_success(question->address, now_);
      if (!is_whole && !is_lost) schedule_.note_more(question->address);
      if (is_lost) schedule_.note_failure(question->address, true, now_);
      now_ += answer.silence;
    }
  }
  bool is_sound(std::uint8_t unit) const { return schedule_.is_sound(ModbusAddress{unit}); }

  std::map<std::uint8_t, Unit> units;

 private:
  struct Converter final : ScriptedBus {
    bool is_one_line() const override { return true; }
  };
  static PollSettings poll() {
    PollSettings settings;
    settings.interval = 1s;
    settings.absent_interval = 10s;
    return settings;
  }

  port::Duration timeout_;
  ScriptedBus line_;
  Converter converter_;
  BusSchedule schedule_;
  port::Instant now_{1h};
};

BusSettings serial_line() {
  BusSettings settings;
  settings.link = port::SerialLine{.path = "", .baud = 19200};
  settings.outstanding_max = 1;
  settings.timeout = 250ms;
  return settings;
}

// One that never answers in time keeps the line for longer than there is between two polls.
TEST(OneThatWasSilent, DoesNotWaitBehindAnotherThatCostsMore) {
  SomeLine line(serial_line(), false, 5);
  for (std::uint8_t slow = 3; slow <= 5; ++slow) {
    line.units[slow] = {.takes = 250ms, .silence = 1100ms, .answers = false};
  }
  line.run(20s);
  line.units[2] = {.takes = 250ms, .answers = false};
  line.run(4s);
  ASSERT_FALSE(line.is_sound(2));
  line.units[2] = {.takes = 30ms};
  line.run(10s);
  EXPECT_TRUE(line.is_sound(2));
  const std::uint32_t slow_before = line.units[3].asked;
  line.run(5min);
  EXPECT_GT(line.units[3].asked, slow_before);
}

// What is asked in time that nobody needs is none of the share that the dear one waits for.
TEST(OneThatWasSilent, ThatCostsMuchDoesNotWaitForEverBehindManyThatCostLittle) {
  SomeLine line(serial_line(), false, 14);
  line.run(20s);
  line.units[3] = {.takes = 250ms, .silence = 1100ms, .answers = false};
  for (std::uint8_t cheap = 4; cheap <= 14; ++cheap) {
    line.units[cheap] = {.takes = 250ms, .answers = false};
  }
  line.run(3min);
  // Its question keeps the line for 1.35 s, of which they have one part in 32.
  for (int minute = 0; minute < 10; ++minute) {
    const std::uint32_t before = line.units[3].asked;
    const std::uint32_t sound_before = line.units[1].asked;
    line.run(1min);
    EXPECT_GE(line.units[3].asked, before + 1) << "in minute " << minute;
    EXPECT_GE(line.units[1].asked, sound_before + 56) << "in minute " << minute;
  }
}

// Nor one that has missed a single answer, behind those that miss one all the time.
TEST(OneThatWasSilent, IsRepeatedBesideThoseThatLoseEveryOtherAnswer) {
  SomeLine line(serial_line(), false, 5);
  line.run(20s);
  for (std::uint8_t unit = 3; unit <= 5; ++unit) line.units[unit].loses_every_other = true;
  line.run(3min);
  line.units[1] = {.takes = 250ms, .silence = 1100ms, .answers = false};
  line.run(1010ms);
  line.units[1] = {.takes = 30ms};
  ASSERT_FALSE(line.is_sound(1));
  line.run(50s);
  EXPECT_TRUE(line.is_sound(1));
}

// Its second block does not wait for a share that the first one has used up: by then that is old.
TEST(OneThatWasSilent, IsReadInAllItsBlocksOnceTheFirstOneHasCome) {
  SomeLine line(serial_line(), false, 5);
  line.units[1].blocks = 2;
  line.run(20s);
  for (std::uint8_t unit = 3; unit <= 5; ++unit) line.units[unit].loses_every_other = true;
  line.run(3min);
  ASSERT_TRUE(line.is_sound(1));
  line.units[1] = {.takes = 250ms, .silence = 1100ms, .answers = false, .blocks = 2};
  line.run(1010ms);
  ASSERT_FALSE(line.is_sound(1));
  line.units[1] = {.takes = 30ms, .blocks = 2};
  line.run(10min);
  EXPECT_TRUE(line.is_sound(1));
}

// What those cost that were never there is none of its own.
TEST(OneThatWasSilent, DoesNotPayForThoseThatWereNeverThere) {
  BusSettings settings;
  settings.timeout = 1s;
  SomeLine line(settings, true, 22);
  for (std::uint8_t absent = 21; absent <= 22; ++absent) {
    line.units[absent] = {.takes = 1s, .answers = false};
  }
  line.run(30s);
  line.units[5] = {.takes = 1s, .silence = 750ms, .answers = false};
  line.run(4s);
  ASSERT_FALSE(line.is_sound(5));
  line.units[5] = {.takes = 30ms};
  line.run(10s);
  EXPECT_TRUE(line.is_sound(5));
}

}  // namespace
}  // namespace etcm::firmware
