// Which unit of a bus is asked next, and when.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "etcm/port/node_bus.h"
#include "firmware/config/settings.h"
#include "firmware/polling/link_losses.h"
#include "firmware/polling/time_share.h"
#include "firmware/protocol/modbus_address.h"

namespace etcm::firmware {

// Questions to a unit are due one interval after the other, however late each was asked: on a busy
// machine no poll is missed. One that is late by an interval and more (a unit that is not there
// held the line) is followed by another at once, unless the one before was as late: where a line is
// too slow for so many units, or the program was stopped, missed polls are not made up for.
//
// A unit that does not answer, or not soundly, is asked ever less often, down to absent_interval
// (a little earlier each time, differently for each unit, so that such units do not meet). What it
// costs the others is bounded too: where a bus takes several requests at a time, such units never
// have more than half of them; where it takes one, they have the time that no other unit needs, and
// 1/32 of the rest, of a line behind a converter 1/100: there a question in vain costs whatever
// time the converter takes. Those that have answered have 1/32 of their own, and what was not used
// of it in two minutes may be used at once: they may be back in a moment. A torn read is repeated
// at once. While a bus has lost its link, its units are not asked and do not count as failing; one
// that it is lost for each time (link_losses.h) does.
//
// Once one has answered, units that nobody has heard yet share that half: those that are not there
// must not keep the others waiting.
//
// A frame may be lost. So a unit whose answer is missing where the one before was there is asked
// once more at once (twice in a row, and it is asked a little earlier: another one may talk over
// it, always as late after his own question), and on a serial line one that has missed
// its first question is after an interval: both before those that have failed more often. Where a
// bus takes one request at a time the former costs the others 1/32 of its time (what was not used
// in two minutes may be used at once, for many may lose a frame together), the latter 1/12 until
// each unit was asked twice. Units that are called for are asked at once too, for another 1/32;
// beyond it as failing units are.
//
// Units that are only looked for (discovery) are asked one at a time, one in each interval, until
// one answers; on a line that others want within scan_budget of each interval. One that was found
// and does not answer any more is only looked for again, once others of its bus answer.
//
// Requests wait until no unit is due; on a bus that is always busy they have 1/16 of its time.
//
// Requests of those who share the bus have the time that no unit waits for, and where one does
// share.percent of it; what they did not use in the last seconds they may use at once. A request
// that a unit waits for would hold it up for as long as a question in vain does, so a unit that is
// due by then counts as waiting.
//
// Nor does one whose answers others have held up behind a converter until they came too late count
// as failing: it is asked again as one that is there.
//
// Where no unit of a bus answers, something between is broken, such as a cable: all are asked as
// often as if they were there (or that little earlier: it may be that one's late answer spoils the
// other's), and all at once when the first answers again.
//
// Units go by their addresses; all calls but has_unit() and add_unit() are for one that was added.
class BusSchedule {
 public:
  enum class Reason : std::uint8_t { turn, first, repeat, retry, discovery };
  struct Question {
    ModbusAddress address;
    Reason reason = Reason::turn;
    port::Instant due{};
  };

  // `bus` must outlive the schedule.
  BusSchedule(const PollSettings& poll, const BusSettings& settings, const port::NodeBus& bus);

  void add_unit(ModbusAddress address, bool is_listed);

  // Other settings: units that would be asked later than these have it come forward. Returns when
  // all units that are there will have answered, on a bus that has the time.
  port::Instant update_settings(const PollSettings& poll, const BusSettings& settings,
                                port::Instant now);
  const BusSettings& settings() const { return settings_; }

  // The unit to ask now. Each question ends with ask(), or with postpone() where the bus would not
  // take it yet.
  std::optional<Question> next_question(port::Instant now);
  void ask(const Question& question, port::Instant now);
  void postpone(const Question& question, port::Instant until);

  // When next_question() has one that is due; `discovery_start` of units that are looked for.
  port::Instant next_due(port::Instant now) const;
  port::Instant discovery_start(port::Instant now) const;

  // What came of a question: note_cost() first, then one of the four below.
  void note_cost(ModbusAddress address, const port::BusAnswer& answer, port::Instant now);
  void note_success(ModbusAddress address, port::Instant now);
  // `is_miss`: no answer to this question, so that a frame may have been lost.
  void note_failure(ModbusAddress address, bool is_miss, port::Instant now);
  // It is to be asked once more at once: a torn read, or the next part of what is read.
  void note_more(ModbusAddress address);
  // It has answered after all, as soon as others let it: its failures were none of its own.
  void note_held_up(ModbusAddress address, port::Instant now);
  // Whether the link is lost for this unit each time: then note_failure() follows.
  bool note_link_lost(ModbusAddress address, port::Instant now);

  // A node is said to be there: the unit is asked next, before all that are due and however often
  // it has failed; call_for() does so as far as the share of such calls allows.
  void ask_at_once(ModbusAddress address, port::Instant now);
  void call_for(ModbusAddress address, port::Instant now);
  // What was there is known to have gone: its silence is no news.
  void expect_silence(ModbusAddress address);

  // When a request that is due then may be made.
  port::Instant request_start(port::Instant due, port::Instant now) const;
  void charge_request(port::Duration cost, port::Instant now);

  // When a request of those who share the bus may be made; at once from the origin on.
  port::Instant client_start(port::Instant now) const;
  void charge_client(port::Duration cost, port::Instant now);

  // Units that were never asked are still to be, before all others.
  bool has_strangers() const;
  std::uint32_t failures(ModbusAddress address) const { return units_[address.value].failures; }
  bool has_answered(ModbusAddress address) const { return units_[address.value].has_answered; }
  bool is_listed(ModbusAddress address) const { return units_[address.value].is_listed; }
  bool loses_link(ModbusAddress address) const { return losses_.is_cause(address); }
  bool is_sound(ModbusAddress address) const {
    return units_[address.value].has_answered && units_[address.value].failures == 0;
  }
  port::Instant asked_at(ModbusAddress address) const { return units_[address.value].asked_at; }
  port::Duration timeout(ModbusAddress address) const { return units_[address.value].timeout; }

  // The least time a question and its answer keep the line; nothing where there is none.
  port::Duration exchange_floor() const { return exchange_floor_; }
  // The most a question costs that is not answered.
  port::Duration cost_max() const { return cost_max_; }
  // How long a question keeps the line. Where the program stood still meanwhile only what it takes
  // at the most: else others would go on to wait for hours.
  port::Duration cost_of(port::Instant asked_at, const port::BusAnswer& answer,
                         port::Instant now) const;

 private:
  struct UnitSchedule {
    port::Duration timeout{};
    bool has_answered = false;
    bool is_listed = true;         // else it is only looked for
    bool is_undiscovered = false;  // not listed, and its time to be looked for has not come
    Reason reason = Reason::turn;  // why it was asked last
    std::uint32_t failures = 0;    // in a row
    std::uint32_t repeats = 0;     // that it has answered, in a row
    bool is_late = false;          // by an interval and more, when it was asked last
    bool is_made_up_for = false;   // and is asked once more for that
    bool has_more = false;         // it has answered, and is asked for the rest
    port::Instant due{};           // for the question asked at
    port::Instant asked_at{};
    port::Instant wanted_at{};     // when, then, the next was due whose turn it is
    port::Duration silence{};      // that its last answer, or the wait for it, cost the others
    port::Duration cost{};         // of the last question that was not answered, with all that
    port::Duration missed_cost{};  // what of it others had to wait
  };
  struct Turn {
    port::Instant due{};
    ModbusAddress address;
  };
  using Turns = std::vector<Turn>;  // a heap, the earliest on top

  // A type of its own, so that the heap compares without a call.
  struct Later {
    bool operator()(const Turn& a, const Turn& b) const { return a.due > b.due; }
  };

  // Whether it takes one request at a time, so that one in vain costs all others its time.
  bool takes_one() const { return settings_.outstanding_max == 1 || bus_.is_one_line(); }
  bool is_repeated(const UnitSchedule& unit) const;
  port::Duration retry_cost(const UnitSchedule& unit) const;
  static port::Duration cost_to_others(const UnitSchedule& unit, port::Duration cost);
  port::Duration pause_of(ModbusAddress address, bool is_miss) const;
  port::Duration discovery_pause(port::Duration cost) const;
  port::Instant due_after(const UnitSchedule& unit, port::Duration pause) const;
  void charge_retry(const UnitSchedule& unit, port::Duration cost, port::Instant now);

  const TimeShare& share_of(const UnitSchedule& unit) const;
  port::Instant start_beside(port::Instant due, port::Instant free_at, port::Duration cost,
                             port::Instant now) const;
  port::Instant repeat_start(port::Instant now) const;
  port::Instant retry_start(port::Instant now) const;
  std::uint32_t half_of_the_requests() const;
  Reason reason_in_turn() const;
  port::Instant due_in_turn() const;
  std::optional<Reason> next_reason(port::Instant now) const;
  ModbusAddress next_undiscovered();

  // One of those that failed, and when it may be asked.
  struct Candidate {
    std::size_t at = 0;  // among its turns
    port::Instant start = port::never;
  };
  port::Instant failing_start(const Turn& turn, port::Instant now) const;
  Candidate first_of_failing(const Turns& turns, port::Instant now) const;
  Turn take(Reason reason, port::Instant now);

  Turns& turns_of(Reason reason);
  std::array<Turns*, 4> all_turns() { return {&turns_, &firsts_, &repeats_, &retries_}; }
  void push(Turns& turns, const Turn& turn);
  void ask_again(ModbusAddress address, port::Instant due);
  void bring_forward(ModbusAddress address, port::Instant due);
  void bring_back_all(port::Instant now);
  void rest(ModbusAddress address);

  PollSettings poll_;
  BusSettings settings_;
  const port::NodeBus& bus_;
  port::Duration exchange_floor_;
  port::Duration cost_max_;
  std::vector<UnitSchedule> units_;  // by address

  Turns turns_;                // of sound units
  Turns firsts_;               // of units that nobody has heard yet
  Turns repeats_;              // of those that have failed once
  Turns retries_;              // of other failing ones
  std::uint32_t sound_ = 0;    // units that answered when last asked
  port::Instant mended_at_{};  // when the first of all silent ones answered again
  LinkLosses losses_;
  std::uint32_t unsure_under_way_ = 0;     // questions to units that failed or are not heard yet
  std::optional<port::Instant> begun_at_;  // the first question

  // At others' cost, where the bus takes one request at a time.
  TimeShare repeat_share_{32, std::chrono::minutes(2)};
  TimeShare first_repeat_share_{12};  // of units that have never answered
  TimeShare retry_share_;             // of the others that have never answered
  TimeShare lost_share_;              // and of those that have
  TimeShare call_share_{32};          // of units that are called for
  TimeShare request_share_{16};
  // Of what share.percent makes of a cost; that is saved up, so it counts whole.
  TimeShare client_share_{2, std::chrono::seconds(4)};

  std::vector<ModbusAddress> discovery_;  // units that are not listed
  std::size_t discovery_next_ = 0;
  std::uint32_t undiscovered_ = 0;
  std::uint32_t discovery_postponed_ = 0;  // since one was asked
  bool discovery_under_way_ = false;
  port::Instant discovery_due_{};
  port::Instant discovery_allowed_{};  // at others' cost
};

}  // namespace etcm::firmware
