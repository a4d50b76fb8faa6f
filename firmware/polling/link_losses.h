// Which unit a bus loses its link for: some converters end the connection when a certain unit is
// asked, and all others would have to wait for the next one, again and again.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "etcm/port/clock.h"
#include "etcm/port/node_bus.h"
#include "firmware/polling/time_share.h"
#include "firmware/protocol/modbus_address.h"

namespace etcm::firmware {

// Of several that were asked when a link was lost any may be the cause, so each of them is to be
// asked with nobody beside it. One that is asked so when the link is lost, as often as losses_max
// in a row, and not while all others lose it too, is the cause until it answers. All causes of a
// bus cost the others 1/32 of its time, with what it takes until it has a link again.
class LinkLosses {
 public:
  static constexpr std::uint8_t losses_max = 3;

  // Another one may be asked beside those that are.
  bool may_ask() const { return suspects_ == 0 || under_way_ == 0; }

  void ask(ModbusAddress address, port::Instant now) {
    if (lost_at_) share_.charge(std::min(now - *lost_at_, loss_cost_max), now);
    lost_at_.reset();
    sole_ = under_way_ == 0 ? std::optional(address) : std::nullopt;
    ++under_way_;
  }

  // What came of it; for a lost link note_loss() or forget() follows.
  void note_result(ModbusAddress address, port::BusResult result) {
    --under_way_;
    if (result == port::BusResult::ok) ++answers_;
    if (result != port::BusResult::link_lost) forget(address);
  }

  // Whether the unit is the cause.
  bool note_loss(ModbusAddress address, port::Instant now) {
    Unit& unit = units_[address.value];
    const bool is_its_own = unit.losses == 0 || unit.answers_before != answers_;
    if (sole_ == address && is_its_own && unit.losses < losses_max) {
      ++unit.losses;
      unit.answers_before = answers_;
      if (is_cause(address)) ++causes_;
    }
    if (is_cause(address)) lost_at_ = now;
    suspect(unit, !is_cause(address));
    return is_cause(address);
  }
  bool is_cause(ModbusAddress address) const { return units_[address.value].losses == losses_max; }
  bool has_cause() const { return causes_ > 0; }
  // From when on one that is the cause may be asked.
  port::Instant free_at() const { return share_.free_at(); }
  void open(port::Instant now) { share_.open(now); }

  void forget(ModbusAddress address) {
    if (is_cause(address)) --causes_;
    suspect(units_[address.value], false);
    units_[address.value].losses = 0;
  }

 private:
  // Where it takes longer to have a link again, something else is in the way.
  static constexpr port::Duration loss_cost_max = std::chrono::seconds(10);

  struct Unit {
    bool is_suspect = false;
    std::uint8_t losses = 0;           // in a row, of those that count
    std::uint32_t answers_before = 0;  // of all units, before the last of these
  };

  void suspect(Unit& unit, bool is_suspect) {
    suspects_ += std::uint32_t{is_suspect} - std::uint32_t{unit.is_suspect};
    unit.is_suspect = is_suspect;
  }

  std::array<Unit, 256> units_{};  // by address
  std::uint32_t suspects_ = 0;
  std::uint32_t causes_ = 0;
  std::uint32_t under_way_ = 0;
  std::uint32_t answers_ = 0;             // of all units
  std::optional<ModbusAddress> sole_;     // under way with nobody beside it
  std::optional<port::Instant> lost_at_;  // for a cause, and nobody was asked since then
  TimeShare share_{32};
};

}  // namespace etcm::firmware
