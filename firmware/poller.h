// Asks every unit of every bus for its position, each at its own time.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/node_bus.h"
#include "node_map.h"
#include "settings.h"

namespace etcm::firmware {

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

// A unit that does not answer, or not soundly, is asked ever less often, down to absent_interval
// (a little earlier each time, differently for each unit, so that such units do not meet). What it
// costs the others is bounded too: where a bus takes several requests at a time, such units never
// have more than half of them; where it takes one, they have the time that nobody else needs, and
// 1/32 of the rest. A torn read is repeated at once. While a bus has
// lost its link, its units are not asked and do not count as failing.
//
// Where no unit of a bus answers, something between is broken, such as a cable: all are asked as
// often as if they were there, and all at once when the first answers again.
class Poller {
 public:
  // All arguments must outlive the poller.
  Poller(const PollSettings& settings, std::span<const PolledBus> buses, ReadingListener& listener,
         port::Log& log);

  // Takes what was answered and asks whoever is due.
  void step(port::Instant now);
  port::Instant next_deadline() const;

  // Asks the units with this address next, whoever else is due and however often they have failed.
  void ask_at_once(std::uint8_t address, port::Instant now);

  std::uint32_t unit_count() const { return static_cast<std::uint32_t>(units_.size()); }
  bool is_failing(std::uint32_t unit) const { return units_[unit].failures > 0; }
  std::string name(std::uint32_t unit) const;  // "unit 7 of yard"

 private:
  struct Unit {
    std::uint32_t bus = 0;
    std::uint8_t address = 0;
    bool has_answered = false;
    bool is_probed = false;  // the question under way was asked while it failed
    std::uint8_t torn_repeats = 0;
    std::uint32_t failures = 0;  // in a row
    port::Instant asked_at{};
  };
  struct Turn {
    port::Instant due{};
    std::uint32_t unit = 0;
  };
  struct Line {
    PolledBus polled;
    std::vector<std::uint32_t> unit_at;  // by address; unit_count() where there is none
    std::vector<Turn> turns;             // of sound units; a heap, the earliest on top
    std::vector<Turn> probes;            // of failing ones, likewise
    std::uint32_t sound = 0;             // units that answered when last asked
    std::uint32_t probes_under_way = 0;
    std::uint32_t probes_max = 0;
    bool takes_one = false;           // request at a time
    port::Duration probe_cost_max{};  // to a unit that does not answer, where it takes one
    port::Instant probe_allowed{};    // at others' cost, where it takes one
  };

  static std::vector<Turn>* next_turns(Line& line, port::Instant now);
  static port::Instant probe_due(const Line& line, port::Instant now);
  void take(const port::BusAnswer& answer, std::uint32_t unit, port::Instant now);
  void fail(std::uint32_t unit, const std::string& why, bool is_silence, port::Instant now);
  void count_sound(std::uint32_t unit, port::Instant now);
  void ask_again(std::uint32_t unit, port::Instant due);
  port::Duration pause_of(std::uint32_t unit) const;

  const PollSettings& settings_;
  ReadingListener& listener_;
  port::Log& log_;
  std::vector<Unit> units_;
  std::vector<Line> lines_;
  port::Instant stepped_at_{};
};

}  // namespace etcm::firmware
