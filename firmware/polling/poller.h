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
#include "firmware/polling/bus_schedule.h"
#include "firmware/polling/poll_counters.h"
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

// Whom it asks next and when, bus_schedule.h says.
class Poller {
 public:
  // All arguments but settings must outlive the poller.
  Poller(const PollSettings& settings, std::span<const PolledBus> buses, ReadingListener& listener,
         port::Log& log, RequestSource* requests = nullptr);

  // Takes what was answered and asks whoever is due.
  void step(port::Instant now);
  port::Instant next_deadline() const;

  // Other settings of the polls, or other timeouts of the same buses: whoever would be asked later
  // than these have it comes forward. Returns when all units that are there will have answered, on
  // buses that have the time.
  port::Instant update_settings(const PollSettings& settings, std::span<const BusSettings> buses,
                                port::Instant now);

  // Somebody is said to be at this address: asks its units next, whoever else is due and however
  // often they have failed, as far as their share of the time allows.
  void ask_at_once(std::uint8_t address, port::Instant now);

  void ask_unit_at_once(std::uint32_t unit, port::Instant now);
  // Whoever was at this unit is known to have gone: its silence is no news.
  void expect_silence(std::uint32_t unit);

  std::uint32_t unit_count() const { return static_cast<std::uint32_t>(units_.size()); }
  std::uint32_t failures(std::uint32_t unit) const {  // in a row
    return schedule_of(unit).failures(address_of(unit));
  }
  bool is_sound(std::uint32_t unit) const { return schedule_of(unit).is_sound(address_of(unit)); }
  TextLine name(std::uint32_t unit) const;  // "unit 7 of yard"

  std::uint32_t bus_count() const { return static_cast<std::uint32_t>(buses_.size()); }
  const BusSettings& bus(std::uint32_t bus) const { return buses_[bus].schedule.settings(); }
  const BusCounters& bus_counters(std::uint32_t bus) const { return buses_[bus].counters; }
  std::uint32_t bus_of(std::uint32_t unit) const { return units_[unit].bus; }
  // no_unit where there is none.
  std::uint32_t unit_at(std::uint32_t bus, std::uint8_t address) const {
    return buses_[bus].unit_at[address];
  }
  // From when on a request may read or write there (node_bus.h).
  port::Instant read_free_at(std::uint32_t unit) const;
  port::Instant write_free_at(std::uint32_t unit) const;
  std::uint8_t address_of(std::uint32_t unit) const { return units_[unit].address; }
  const UnitCounters& counters(std::uint32_t unit) const { return units_[unit].counters; }
  // Else it is only looked for.
  bool is_listed(std::uint32_t unit) const { return schedule_of(unit).is_listed(address_of(unit)); }
  // Whether a bus has had somebody to ask, or a question under way for longer than that may be, and
  // for `patience` has neither asked nor heard anything. One whose link is down has nobody to ask.
  bool is_stalled(std::uint32_t bus, port::Instant now, port::Duration patience) const;

 private:
  static constexpr std::uint32_t request_ticket = 0xffffffff;

  struct Unit {
    std::uint32_t bus = 0;
    std::uint8_t address = 0;
    std::uint8_t torn_repeats = 0;
    UnitCounters counters{};
  };
  struct Bus {
    port::NodeBus* bus;
    BusSchedule schedule;
    std::vector<std::uint32_t> unit_at;  // by address; no_unit where there is none
    std::uint32_t under_way = 0;
    port::Instant progressed_at{};  // asked or heard
    bool request_under_way = false;
    port::Instant request_asked_at{};
    BusCounters counters{};
  };

  const BusSchedule& schedule_of(std::uint32_t unit) const { return buses_[bus_of(unit)].schedule; }
  BusSchedule& schedule_of(std::uint32_t unit) { return buses_[bus_of(unit)].schedule; }
  void add_units(std::uint32_t bus, std::span<const UnitRange> ranges, bool is_listed);
  port::RegisterRead read_of(std::uint32_t unit) const;

  bool ask_next(std::uint32_t bus, port::Instant now);
  port::Instant request_start(std::uint32_t bus, port::Instant now) const;
  bool start_request(std::uint32_t bus, port::Instant now);
  void finish_request(std::uint32_t bus, const port::BusAnswer& answer, port::Instant now);

  void take(const port::BusAnswer& answer, std::uint32_t unit, port::Instant now);
  void take_registers(const port::BusAnswer& answer, std::uint32_t unit, port::Instant now);
  void count_answer(Unit& unit, port::BusResult result, port::Instant now);
  // Why a question failed. Silence is no news of a unit that was never there; after a miss a frame
  // may have been lost.
  struct Failure {
    std::string_view why;
    bool is_silence = false;
    bool is_miss = false;
  };
  void fail(std::uint32_t unit, const Failure& failure, port::Instant now);

  ReadingListener& listener_;
  port::Log& log_;
  RequestSource* requests_;
  std::vector<Unit> units_;
  std::vector<Bus> buses_;
  port::Instant stepped_at_{};
};

}  // namespace etcm::firmware
