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
// in a row, and not while all others lose it too, is the cause until it answers.
//
// Others end it some seconds after the question, when nobody waits for the answer any more. So
// whatever is the cause: where a bus loses its link soon after a failing unit was asked, and not
// for once (cables are pulled out too), the time until it has one again comes off a share that all
// such units have, 1/32 of its time.
class LinkLosses {
 public:
  static constexpr std::uint8_t losses_max = 3;

  // Another one may be asked beside those that are.
  bool may_ask() const { return suspects_ == 0 || under_way_ == 0; }

  void ask(ModbusAddress address, bool is_failing, port::Instant now) {
    if (has_cost_) share_.charge(std::min(now - *failing_asked_at_, loss_cost_max), now);
    has_cost_ = false;
    if (is_failing) {
      if (!is_lost_since_ && doubts_ > 0) --doubts_;
      failing_asked_at_ = now;
      is_lost_since_ = false;
    }
    sole_ = under_way_ == 0 ? std::optional(address) : std::nullopt;
    ++under_way_;
  }

  // What came of it; for a lost link note_loss() or forget() follows.
  void note_result(ModbusAddress address, port::BusResult result) {
    --under_way_;
    if (result == port::BusResult::ok) ++answers_;
    if (result != port::BusResult::link_lost) forget(address);
  }

  // Whether the unit is the cause. One that fails anyway is not looked into.
  bool note_loss(ModbusAddress address, bool is_failing) {
    Unit& unit = units_[address.value];
    const bool is_its_own = unit.losses == 0 || unit.answers_before != answers_;
    if (sole_ == address && is_its_own && unit.losses < losses_max) {
      ++unit.losses;
      unit.answers_before = answers_;
    }
    suspect(unit, !is_failing && !is_cause(address));
    return is_cause(address);
  }
  bool is_cause(ModbusAddress address) const { return units_[address.value].losses == losses_max; }

  void forget(ModbusAddress address) {
    suspect(units_[address.value], false);
    units_[address.value].losses = 0;
  }

  // The bus has lost its link; may be told more than once.
  void note_down(port::Instant now) {
    if (is_lost_since_) return;
    is_lost_since_ = true;
    if (!failing_asked_at_ || now - *failing_asked_at_ > patience_max) return;
    doubts_ = std::min(doubts_ + doubts_of_a_loss, doubts_max);
    has_cost_ = doubts_ > doubts_free;
  }
  // From when on a failing unit may be asked.
  port::Instant free_at() const { return share_.free_at(); }
  void open(port::Instant now) { share_.open(now); }

 private:
  // So long a converter waits for an answer, at the most.
  static constexpr port::Duration patience_max = std::chrono::seconds(5);
  // Three losses after failing units were asked, and a question to one of them that nothing was
  // lost after takes away a fourth of one.
  static constexpr std::uint32_t doubts_of_a_loss = 4, doubts_free = 8, doubts_max = 12;
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
  std::uint32_t under_way_ = 0;
  std::uint32_t answers_ = 0;          // of all units
  std::optional<ModbusAddress> sole_;  // the last one asked, where nobody was asked beside it
  std::optional<port::Instant> failing_asked_at_;
  bool is_lost_since_ = true;  // the link
  std::uint32_t doubts_ = 0;
  bool has_cost_ = false;  // that it was lost; nobody was asked since
  TimeShare share_{32};
};

}  // namespace etcm::firmware
