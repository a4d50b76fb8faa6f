// Asks every unit of every bus for its position, each at its own time.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/node_bus.h"
#include "firmware/config/settings.h"
#include "firmware/logging/text_line.h"
#include "firmware/polling/bus_request.h"
#include "firmware/polling/poll_counters.h"
#include "firmware/polling/time_share.h"
#include "firmware/protocol/node_registers.h"

namespace etcm::firmware {

// Units are counted over all buses, from 0.
inline constexpr std::uint32_t no_unit = 0xffffffff;

struct PolledBus {
  port::NodeBus* bus = nullptr;
  const BusSettings* settings = nullptr;
};

class ReadingListener {
 public:
  // A sound answer. `unit` counts the units of all buses from 0. False: the reading is not believed
  // (the wrong node answers), and the unit counts as failing.
  virtual bool on_reading(std::uint32_t unit, const NodeReading& reading, port::Instant now) = 0;

 protected:
  ~ReadingListener() = default;
};

// Questions to a unit are due one interval after the other, however late each was asked: on a busy
// machine no poll is missed. Where one was late by an interval and more (a line that is too slow
// for so many units, a program that was stopped), the next is due an interval after it: missed
// polls are not made up for.
//
// A unit that does not answer, or not soundly, is asked ever less often, down to absent_interval
// (a little earlier each time, differently for each unit, so that such units do not meet). What it
// costs the others is bounded too: where a bus takes several requests at a time, such units never
// have more than half of them; where it takes one, they have the time that nobody else needs, and
// 1/32 of the rest. A torn read is repeated at once. While a bus has
// lost its link, its units are not asked and do not count as failing.
//
// Units that are only looked for (`scan`) are asked one at a time, one in each interval, until one
// answers; on a line that others want within scan_budget of each interval. One that was found and
// does not answer any more is only looked for again, once others of its bus answer.
//
// A frame may be lost. So a unit whose answer is missing where the one before was there is asked
// once more at once, and on a serial line one that has missed its first question is after an
// interval: both before those that have failed more often. Where a bus takes one request at a time
// the former costs the others 1/32 of its time (what was not used in two minutes may be used at
// once, for many may lose a frame together), the latter 1/12 until each unit was asked twice. Units
// that somebody calls for are asked at once too, for another 1/32; beyond it as failing units are.
//
// Requests wait until nobody is due; on a bus that is always busy they have 1/16 of its time.
//
// Where no unit of a bus answers, something between is broken, such as a cable: all are asked as
// often as if they were there, and all at once when the first answers again.
class Poller {
 public:
  // All arguments must outlive the poller.
  Poller(const PollSettings& settings, std::span<const PolledBus> buses, ReadingListener& listener,
         port::Log& log, RequestSource* requests = nullptr);

  // Takes what was answered and asks whoever is due.
  void step(port::Instant now);
  port::Instant next_deadline() const;

  // The settings of the polls, or timeouts of the buses, have changed: whoever would be asked later
  // than these have it comes forward. Returns when all units that are there will have answered, on
  // buses that have the time.
  port::Instant update_settings(port::Instant now);

  // Somebody is said to be at this address: asks its units next, whoever else is due and however
  // often they have failed, as far as their share of the time allows.
  void ask_at_once(std::uint8_t address, port::Instant now);

  void ask_unit_at_once(std::uint32_t unit, port::Instant now);
  // Whoever was at this unit is known to have gone: its silence is no news.
  void expect_silence(std::uint32_t unit);

  std::uint32_t unit_count() const { return static_cast<std::uint32_t>(units_.size()); }
  std::uint32_t failures(std::uint32_t unit) const { return units_[unit].failures; }  // in a row
  bool is_sound(std::uint32_t unit) const {
    return units_[unit].has_answered && units_[unit].failures == 0;
  }
  TextLine name(std::uint32_t unit) const;  // "unit 7 of yard"

  std::uint32_t bus_count() const { return static_cast<std::uint32_t>(lines_.size()); }
  const BusSettings& bus(std::uint32_t bus) const { return *lines_[bus].polled.settings; }
  const BusCounters& bus_counters(std::uint32_t bus) const { return lines_[bus].counters; }
  std::uint32_t bus_of(std::uint32_t unit) const { return units_[unit].bus; }
  // no_unit where there is none.
  std::uint32_t unit_at(std::uint32_t bus, std::uint8_t address) const {
    return lines_[bus].unit_at[address];
  }
  // From when on a request may read or write there (node_bus.h).
  port::Instant read_free_at(std::uint32_t unit) const;
  port::Instant write_free_at(std::uint32_t unit) const;
  std::uint8_t address_of(std::uint32_t unit) const { return units_[unit].address; }
  const UnitCounters& counters(std::uint32_t unit) const { return units_[unit].counters; }
  // Else it is only looked for.
  bool is_listed(std::uint32_t unit) const { return units_[unit].is_listed; }
  // Whether a bus has had somebody to ask, or a question under way for longer than that may be, and
  // for `patience` has neither asked nor heard anything. One whose link is down has nobody to ask.
  bool is_stalled(std::uint32_t bus, port::Instant now, port::Duration patience) const;

 private:
  static constexpr std::uint32_t request_ticket = 0xffffffff;

  enum class Asking : std::uint8_t { turn, repeat, retry, scan };
  struct Unit {
    std::uint32_t bus = 0;
    std::uint8_t address = 0;
    port::Duration timeout{};
    bool has_answered = false;
    bool is_listed = true;         // else it is only looked for
    bool is_undiscovered = false;  // not listed, and its time to be looked for has not come
    Asking asking = Asking::turn;  // why it was asked last
    std::uint8_t torn_repeats = 0;
    std::uint32_t failures = 0;  // in a row
    port::Instant due{};         // for the question asked at
    port::Instant asked_at{};
    port::Duration silence{};  // that its last answer, or the wait for it, cost the others
    port::Duration cost{};     // of the last question that was not answered, with all that
    UnitCounters counters{};
  };
  struct Turn {
    port::Instant due{};
    std::uint32_t unit = 0;
  };
  struct Line {
    PolledBus polled;
    std::vector<std::uint32_t> unit_at;  // by address; no_unit where there is none
    std::vector<Turn> turns;             // of sound units; a heap, the earliest on top
    std::vector<Turn> repeats;           // of those that have failed once, likewise
    std::vector<Turn> retries;           // of other failing ones, likewise
    std::uint32_t sound = 0;             // units that answered when last asked
    std::uint32_t retries_under_way = 0;
    std::uint32_t retries_max = 0;
    port::Duration retry_cost_max{};  // to a unit that does not answer, where it takes one
    // At others' cost, where it takes one.
    TimeShare repeat_share{32, std::chrono::minutes(2)};
    TimeShare first_repeat_share{12};  // of units that have never answered
    TimeShare retry_share{32};
    TimeShare call_share{32};  // of units that somebody calls for
    TimeShare request_share{16};
    std::vector<std::uint32_t> discovery{};  // units that are not listed
    std::size_t discovery_next = 0;
    std::uint32_t undiscovered = 0;
    bool scan_under_way = false;
    port::Instant scan_due{};
    port::Instant scan_allowed{};  // at others' cost
    bool request_under_way = false;
    port::Instant request_asked_at{};
    std::uint32_t under_way = 0;
    port::Instant progressed_at{};  // asked or heard
    port::Duration exchange_floor{};
    BusCounters counters{};
  };

  void call_for(std::uint32_t unit, port::Instant now);
  void bring_forward(std::uint32_t unit, port::Instant due);
  // Whether it takes one request at a time, so that one in vain costs all others its time.
  static bool takes_one(const Line& line) {
    return line.polled.settings->outstanding_max == 1 || line.polled.bus->is_one_line();
  }
  static bool is_repeated(const Line& line, const Unit& unit);
  static port::Duration retry_cost(const Line& line, const Unit& unit);
  port::RegisterRead read_of(std::uint32_t unit) const;
  void add_unit(Line& line, std::uint8_t address, bool is_listed);
  bool ask_next(std::uint32_t bus, port::Instant now);
  void ask(Line& line, const Turn& turn, Asking asking, port::Instant now);
  bool start_request(std::uint32_t bus, port::Instant now);
  void finish_request(std::uint32_t bus, const port::BusAnswer& answer, port::Instant now);
  port::Instant request_start(std::uint32_t bus, port::Instant now) const;
  static port::Instant scan_start(const Line& line, port::Instant now);
  static port::Instant start_beside(const Line& line, port::Instant due, port::Instant allowed,
                                    port::Instant now);
  static port::Duration cost_of(port::Instant asked_at, const port::BusAnswer& answer,
                                port::Instant now);
  std::uint32_t next_discovery(Line& line, port::Instant now);
  void note_cost(Unit& unit, const port::BusAnswer& answer, port::Instant now);
  void rest(std::uint32_t unit);
  std::vector<Turn>* next_turns(Line& line, port::Instant now) const;
  port::Instant start_at_cost(const Line& line, const std::vector<Turn>& turns,
                              const TimeShare& share, port::Instant now) const;
  port::Instant repeat_start(const Line& line, port::Instant now) const;
  port::Instant retry_start(const Line& line, port::Instant now) const;
  void take(const port::BusAnswer& answer, std::uint32_t unit, port::Instant now);
  void count_answer(Unit& unit, port::BusResult result, port::Instant now);
  void miss(std::uint32_t unit, std::string_view why, bool is_silence, port::Instant now);
  void fail(std::uint32_t unit, std::string_view why, bool is_silence, port::Instant now);
  void count_sound(std::uint32_t unit, port::Instant now);
  void ask_again(std::uint32_t unit, port::Instant due);
  port::Instant next_due(const Unit& unit, port::Duration pause) const;
  port::Duration pause_of(std::uint32_t unit) const;
  port::Duration scan_pause(const Line& line, port::Duration cost) const;

  const PollSettings& settings_;
  ReadingListener& listener_;
  port::Log& log_;
  RequestSource* requests_;
  std::vector<Unit> units_;
  std::vector<Line> lines_;
  port::Instant stepped_at_{};
};

}  // namespace etcm::firmware
