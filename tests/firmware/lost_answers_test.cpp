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

}  // namespace
}  // namespace etcm::firmware
