// Asks every unit of every bus for its position, each at its own time.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "etcm/port/line_clients.h"
#include "etcm/port/log.h"
#include "etcm/port/node_bus.h"
#include "firmware/config/settings.h"
#include "firmware/logging/text_line.h"
#include "firmware/polling/bus_request.h"
#include "firmware/polling/bus_schedule.h"
#include "firmware/polling/client_requests.h"
#include "firmware/polling/device.h"
#include "firmware/polling/indices.h"
#include "firmware/polling/jump_check.h"
#include "firmware/polling/poll_counters.h"
#include "firmware/protocol/node_registers.h"

namespace etcm::firmware {

struct PolledBus {
  port::NodeBus* bus = nullptr;
  const BusSettings* settings = nullptr;
  port::LineClients* clients = nullptr;  // who share it; null: nobody can
};

class ReadingListener {
 public:
  // A sound answer, and what a device measured: a node of our own measures nothing. False: the
  // reading is not believed (the wrong node answers), and the unit counts as failing.
  virtual bool on_reading(UnitIndex unit, const NodeReading& reading,
                          std::span<const Measurement> measured, port::Instant now) = 0;

 protected:
  ~ReadingListener() = default;
};

// The order is that of bus_schedule.h.
class Poller {
 public:
  // All arguments but settings must outlive the poller. Without devices all units are nodes.
  Poller(const PollSettings& settings, std::span<const PolledBus> buses, ReadingListener& listener,
         port::Log& log, RequestSource* requests = nullptr, const DeviceTable* devices = nullptr);

  // Takes what was answered and asks the units that are due.
  void step(port::Instant now);
  port::Instant next_deadline() const;

  // Other settings of the polls, other timeouts, or more units and devices of the same buses: units
  // that would be asked later than these have it come forward. Returns when all units that are
  // there will have answered, on buses that have the time.
  port::Instant update_settings(const PollSettings& settings, std::span<const BusSettings> buses,
                                port::Instant now);
  // One more bus, behind those there are.
  void add_bus(const PollSettings& settings, const PolledBus& bus);

  // A node is said to be at this address: asks its units next, before all that are due and however
  // often they have failed, as far as their share of the time allows.
  void ask_at_once(ModbusAddress address, port::Instant now);

  void ask_unit_at_once(UnitIndex unit, port::Instant now);
  // What was at this unit is known to have gone: its silence is no news.
  void expect_silence(UnitIndex unit);

  std::uint32_t unit_count() const { return static_cast<std::uint32_t>(units_.size()); }
  std::uint32_t failures(UnitIndex unit) const {  // in a row
    return schedule_of(unit).failures(address_of(unit));
  }
  bool is_sound(UnitIndex unit) const { return schedule_of(unit).is_sound(address_of(unit)); }
  // The link goes each time it is asked, and for no other.
  bool loses_link(UnitIndex unit) const { return schedule_of(unit).loses_link(address_of(unit)); }
  // Its last question was answered soundly, and the link has not gone since.
  bool is_answering(UnitIndex unit) const;
  TextLine name(UnitIndex unit) const;  // "unit 7 of yard"

  std::uint32_t bus_count() const { return static_cast<std::uint32_t>(buses_.size()); }
  const BusSettings& bus(BusIndex bus) const { return buses_[bus.value].schedule.settings(); }
  const BusCounters& bus_counters(BusIndex bus) const { return buses_[bus.value].counters; }
  const ClientRequests& client_requests(BusIndex bus) const { return buses_[bus.value].clients; }
  // As the bus itself says (node_bus.h).
  bool is_up(BusIndex bus) const { return buses_[bus.value].bus->is_up(); }
  std::string_view why_down(BusIndex bus) const { return buses_[bus.value].bus->why_down(); }
  bool is_clearing(BusIndex bus, port::Instant now) const {
    return buses_[bus.value].bus->is_clearing(now);
  }
  // Whether the first round of the bus goes on, in which units that are not there keep the others
  // waiting.
  bool is_finding(BusIndex bus) const { return buses_[bus.value].schedule.has_strangers(); }
  BusIndex bus_of(UnitIndex unit) const { return units_[unit.value].bus; }
  // None where there is none.
  UnitIndex unit_at(BusIndex bus, ModbusAddress address) const {
    return buses_[bus.value].unit_at[address.value];
  }
  // From when on a request may read or write there (node_bus.h).
  port::Instant read_free_at(UnitIndex unit) const;
  port::Instant write_free_at(UnitIndex unit) const;
  ModbusAddress address_of(UnitIndex unit) const { return units_[unit.value].address; }
  const UnitCounters& counters(UnitIndex unit) const { return units_[unit.value].counters; }
  // Serves our registers; else it is a device with a profile.
  bool is_node(UnitIndex unit) const { return units_[unit.value].device == nullptr; }
  // Of the device; empty: a node.
  std::string_view profile_name(UnitIndex unit) const {
    const Device* const device = units_[unit.value].device;
    return device == nullptr ? std::string_view{} : device->profile_name();
  }
  // The settings say where the device there stands.
  bool is_surveyed(UnitIndex unit) const {
    const Device* const device = units_[unit.value].device;
    return device != nullptr && device->is_surveyed();
  }
  // What is measured there, in the order in which the listener hears of it.
  std::span<const QuantityIndex> quantities(UnitIndex unit) const {
    const Device* const device = units_[unit.value].device;
    return device == nullptr ? std::span<const QuantityIndex>{} : device->quantities();
  }
  // What each of them is by the profile of the device (device.h).
  std::span<const std::uint64_t> definitions(UnitIndex unit) const {
    const Device* const device = units_[unit.value].device;
    return device == nullptr ? std::span<const std::uint64_t>{} : device->definitions();
  }
  // Else it is only looked for.
  bool is_listed(UnitIndex unit) const { return schedule_of(unit).is_listed(address_of(unit)); }
  // Whether a bus has had a unit to ask, or a question under way for longer than that may be, and
  // for `patience` has neither asked nor heard anything. One whose link is down has no unit to ask.
  bool is_stalled(BusIndex bus, port::Instant now, port::Duration patience) const;

 private:
  static constexpr std::uint32_t request_ticket = 0xffffffff;
  static constexpr std::uint32_t client_ticket = 0xfffffffe;

  struct PolledUnit {
    BusIndex bus;
    ModbusAddress address;
    std::uint8_t torn_repeats = 0;
    const Device* device = nullptr;      // null: a node
    std::uint8_t block = 0;              // of its sweep, that is asked next
    std::vector<std::uint16_t> swept{};  // registers of the blocks before it
    port::Instant swept_at{};            // when the last of them came
    JumpCheck jumps{};
    UnitCounters counters{};
  };
  struct Bus {
    port::NodeBus* bus;
    BusSchedule schedule;
    std::vector<UnitIndex> unit_at;  // by address; none where there is none
    std::uint32_t under_way = 0;
    port::Instant progressed_at{};  // asked or heard
    bool request_under_way = false;
    port::Instant request_asked_at{};
    BusCounters counters{};
    port::Instant paused_until{};  // a device needs silence
    ClientRequests clients;
  };

  const BusSchedule& schedule_of(UnitIndex unit) const {
    return buses_[bus_of(unit).value].schedule;
  }
  BusSchedule& schedule_of(UnitIndex unit) { return buses_[bus_of(unit).value].schedule; }
  void add_units_of(BusIndex bus);
  void add_units(BusIndex bus, std::span<const UnitRange> ranges, bool is_listed);
  port::RegisterRead read_of(UnitIndex unit) const;

  bool ask_next(BusIndex bus, port::Instant now);
  port::Instant request_start(BusIndex bus, port::Instant now) const;
  bool start_request(BusIndex bus, port::Instant now);
  void finish_request(BusIndex bus, const port::BusAnswer& answer, port::Instant now);
  bool start_for_client(BusIndex bus, port::Instant now);
  void finish_for_client(BusIndex bus, const port::BusAnswer& answer, port::Instant now);
  void pause_after(const port::BusAnswer& answer, UnitIndex unit, port::Instant now);

  void take(const port::BusAnswer& answer, UnitIndex unit, port::Instant now);
  // False: the sweep of the device has more blocks.
  bool complete_sweep(const port::BusAnswer& answer, PolledUnit& unit, port::Instant now);
  void take_registers(const port::BusAnswer& answer, UnitIndex unit, port::Instant now);
  // Whether the position of a device counts; else it is asked again, or the question has failed.
  bool can_follow(UnitIndex unit, const NodeReading& reading, port::Instant now);
  void count_answer(PolledUnit& unit, port::BusResult result, port::Instant now);
  void note_sound(PolledUnit& unit, port::Instant now);
  // Why a question failed. Silence is no news of a unit that was never there; after a miss a frame
  // may have been lost.
  struct Failure {
    std::string_view why;
    bool is_silence = false;
    bool is_miss = false;
  };
  void fail(UnitIndex unit, const Failure& failure, port::Instant now);

  ReadingListener& listener_;
  port::Log& log_;
  RequestSource* requests_;
  const DeviceTable* devices_;
  std::vector<PolledUnit> units_;
  std::vector<Bus> buses_;
  std::vector<Measurement> measured_;  // in the sweep that was completed last
  port::Instant stepped_at_{};
};

// Why the device at a unit has told no position; `value` where it is a node of our own, or none.
inline DevicePosition::State told_at(const Poller& poller, UnitIndex unit) {
  return unit.is_none() ? DevicePosition::State::value : poller.counters(unit).told;
}

}  // namespace etcm::firmware
