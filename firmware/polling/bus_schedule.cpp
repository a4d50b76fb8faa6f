#include "firmware/polling/bus_schedule.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

constexpr std::size_t addresses = 256;
// A unit may miss this many answers in a row before it is asked less often.
constexpr std::uint32_t failures_free = 2;
// Of a unit that nobody has heard: after those that are to be asked at once.
constexpr port::Instant due_of_strangers{port::Duration{1}};
// So many answers in a row may be to a repeat before a unit is asked at another time.
constexpr std::uint32_t repeats_free = 1;
// A day doubled this often is still a Duration.
constexpr std::uint32_t doublings_max = 16;
// What failing units have of a busy bus, one part in so many; less where a question in vain holds
// the line for as long as a converter is patient.
constexpr std::int64_t retry_parts = 32;
constexpr std::int64_t converter_parts = 100;
// One that was there may be back in a moment, and is looked for more than once before it is waited
// for its share.
constexpr port::Duration lost_time_saved = std::chrono::minutes(2);
// A unit that is only looked for, was found, and has not answered so often is looked for again.
constexpr std::uint32_t failures_of_the_lost = 8;

port::Duration exchange_floor_of(const BusSettings& bus) {
  const auto* const line = std::get_if<port::SerialLine>(&bus.link);
  return line == nullptr ? port::Duration{} : exchange_floor(*line);
}

port::Duration cost_max_of(const BusSettings& bus) {
  port::Duration timeout = bus.timeout;
  for (const DeviceSettings& device : bus.devices) timeout = std::max(timeout, device.timeout);
  const bool is_line = std::holds_alternative<port::SerialLine>(bus.link);
  return timeout + (is_line ? bus.quiet + exchange_floor_of(bus) : port::Duration{});
}

// A well-mixed number from two: the same in every run.
std::uint32_t mix(std::uint32_t a, std::uint32_t b) {
  std::uint32_t value = a * 0x9e3779b9u ^ b * 0x85ebca6bu;
  value = (value ^ value >> 16) * 0x7feb352du;
  value = (value ^ value >> 15) * 0x846ca68bu;
  return value ^ value >> 16;
}

// Up to an eighth less: an answer that is always as late would fall into the same one each time.
port::Duration unevenly(port::Duration pause, ModbusAddress address, std::uint32_t turn) {
  return pause - pause / 8 / 1024 * (mix(address.value, turn) % 1024);
}

}  // namespace

BusSchedule::BusSchedule(const PollSettings& poll, const BusSettings& settings,
                         const port::NodeBus& bus)
    : poll_(poll),
      settings_(settings),
      bus_(bus),
      exchange_floor_(exchange_floor_of(settings)),
      cost_max_(cost_max_of(settings)),
      units_(addresses),
      retry_share_(retry_parts),
      lost_share_(retry_parts, lost_time_saved) {}

void BusSchedule::add_unit(ModbusAddress address, bool is_listed) {
  units_[address.value] = {.timeout = timeout_of(settings_, address),
                           .is_listed = is_listed,
                           .is_undiscovered = !is_listed};
  if (is_listed) {
    push(firsts_, {.due = due_of_strangers, .address = address});
  } else {
    discovery_.push_back(address);
    ++undiscovered_;
  }
  for (Turns* const turns : all_turns()) turns->reserve(firsts_.size() + discovery_.size());
}

port::Instant BusSchedule::update_settings(const PollSettings& poll, const BusSettings& settings,
                                           port::Instant now) {
  poll_ = poll;
  settings_ = settings;
  for (std::size_t address = 0; address < addresses; ++address) {
    units_[address].timeout =
        timeout_of(settings_, ModbusAddress{static_cast<std::uint8_t>(address)});
  }
  cost_max_ = cost_max_of(settings_);
  const port::Instant asked_by = now + poll_.interval;
  for (Turns* const turns : all_turns()) {
    for (Turn& turn : *turns) turn.due = std::min(turn.due, now + pause_of(turn.address, true));
    std::make_heap(turns->begin(), turns->end(), Later{});
  }
  discovery_due_ = std::min(discovery_due_, asked_by);
  discovery_allowed_ = std::min(discovery_allowed_, now + discovery_pause(cost_max_));
  return asked_by + cost_max_;
}

// Units with a share of a busy bus come before those that are due; the shares are small.
std::optional<BusSchedule::Question> BusSchedule::next_question(port::Instant now) {
  if (!losses_.may_ask()) return std::nullopt;
  if (discovery_start(now) <= now) {
    return Question{.address = next_undiscovered(), .reason = Reason::discovery, .due = now};
  }
  const std::optional<Reason> reason = next_reason(now);
  if (!reason) return std::nullopt;
  const Turn turn = take(*reason, now);
  return Question{.address = turn.address, .reason = *reason, .due = turn.due};
}

BusSchedule::Turn BusSchedule::take(Reason reason, port::Instant now) {
  Turns& turns = turns_of(reason);
  const bool is_failing = reason == Reason::repeat || reason == Reason::retry;
  const std::size_t at = is_failing ? first_of_failing(turns, now).at : 0;
  if (at == 0) {
    std::pop_heap(turns.begin(), turns.end(), Later{});
  } else {
    std::swap(turns[at], turns.back());
  }
  const Turn turn = turns.back();
  turns.pop_back();
  if (at != 0) std::make_heap(turns.begin(), turns.end(), Later{});
  return turn;
}

std::uint32_t BusSchedule::half_of_the_requests() const {
  return takes_one() ? 1 : std::max(1u, settings_.outstanding_max / 2);
}

bool BusSchedule::has_strangers() const {
  return !firsts_.empty() && firsts_.front().due <= due_of_strangers;
}

// Of the sound units and those that nobody has heard yet.
BusSchedule::Reason BusSchedule::reason_in_turn() const {
  const bool may_be_first = sound_ == 0 || unsure_under_way_ < half_of_the_requests();
  if (firsts_.empty() || !may_be_first) return Reason::turn;
  const bool is_first = turns_.empty() || firsts_.front().due <= turns_.front().due;
  return is_first ? Reason::first : Reason::turn;
}

port::Instant BusSchedule::due_in_turn() const {
  const Turns& turns = reason_in_turn() == Reason::first ? firsts_ : turns_;
  return turns.empty() ? port::never : turns.front().due;
}

// The one that has waited longest and may be asked.
std::optional<BusSchedule::Reason> BusSchedule::next_reason(port::Instant now) const {
  const Reason in_turn = reason_in_turn();
  const port::Instant turn = due_in_turn();
  if (repeats_.empty() && retries_.empty()) {
    return turn <= now ? std::optional(in_turn) : std::nullopt;
  }
  const port::Instant repeat = repeat_start(now);
  const Candidate lost = first_of_failing(retries_, now);
  const port::Instant retry = lost.start;
  if (std::min({turn, repeat, retry}) > now) return std::nullopt;
  const Reason failing = repeat <= retry ? Reason::repeat : Reason::retry;
  if (!takes_one()) return turn <= std::min(repeat, retry) ? in_turn : failing;
  if (turn > now) return failing;
  if (repeat <= now) return Reason::repeat;
  if (retry > now) return in_turn;
  // A retry of a busy line has its share of the time, however long the others have waited; but
  // where they will soon have been asked it comes after them, unless it is called for or has begun
  // to answer.
  const Turn& next = retries_[lost.at];
  const bool is_first = next.due == port::Instant{} || units_[next.address.value].has_more ||
                        now - retry >= poll_.interval;
  return is_first ? Reason::retry : in_turn;
}

BusSchedule::Turns& BusSchedule::turns_of(Reason reason) {
  if (reason == Reason::turn) return turns_;
  if (reason == Reason::first) return firsts_;
  return reason == Reason::repeat ? repeats_ : retries_;
}

void BusSchedule::ask(const Question& question, port::Instant now) {
  UnitSchedule& unit = units_[question.address.value];
  if (!begun_at_) begun_at_ = now;
  // A unit that was never asked is due since the start.
  const bool was_late = unit.is_late;
  unit.due = std::max(question.due, *begun_at_);
  const port::Duration late = now - unit.due;
  unit.is_late = late >= poll_.interval;
  unit.is_made_up_for = unit.is_late && !was_late && late < 2 * poll_.interval;
  if (question.due < *begun_at_) unit.due = now;
  unit.reason = question.reason;
  losses_.ask(question.address, now);
  unit.has_more = false;
  unit.asked_at = now;
  unit.wanted_at = due_in_turn();
  if (question.reason != Reason::turn && question.reason != Reason::discovery) {
    ++unsure_under_way_;
  }
  if (question.reason == Reason::discovery) {
    discovery_under_way_ = true;
    discovery_postponed_ = 0;
  }
}

void BusSchedule::postpone(const Question& question, port::Instant until) {
  if (question.reason != Reason::discovery) {
    return push(turns_of(question.reason), {.due = until, .address = question.address});
  }
  units_[question.address.value].is_undiscovered = true;
  ++undiscovered_;
  if (++discovery_postponed_ < undiscovered_) return;
  // None of them can be asked now.
  discovery_postponed_ = 0;
  discovery_due_ = question.due + poll_.interval;
}

port::Instant BusSchedule::next_due(port::Instant now) const {
  if (!losses_.may_ask()) return port::never;
  return std::min({due_in_turn(), repeat_start(now), retry_start(now)});
}

// From when on something may be asked that is less urgent than those whose turn it is: at once
// where no unit is about to be asked, else when its share allows.
port::Instant BusSchedule::start_beside(port::Instant due, port::Instant free_at,
                                        port::Duration cost, port::Instant now) const {
  const port::Instant turn = due_in_turn();
  if (due == port::never || turn == port::never) return due;
  const bool is_idle = turn > std::max(due, now) + cost;
  return is_idle ? due : std::max(due, free_at);
}

// Which of these may be asked first, as far as that is known now. One that costs little does not
// wait behind another that costs more than the line has time for.
BusSchedule::Candidate BusSchedule::first_of_failing(const Turns& turns, port::Instant now) const {
  if (turns.empty() || unsure_under_way_ >= half_of_the_requests()) return {};
  if (!takes_one() && !losses_.has_cause()) return {.at = 0, .start = turns.front().due};
  Candidate first;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const port::Instant start = failing_start(turns[i], now);
    const bool is_before =
        start < first.start || (start == first.start && turns[i].due < turns[first.at].due);
    if (is_before) first = {.at = i, .start = start};
  }
  return first;
}

port::Instant BusSchedule::failing_start(const Turn& turn, port::Instant now) const {
  const UnitSchedule& unit = units_[turn.address.value];
  // The rest of a sweep that waits for a share comes too late for what was read before it.
  if (unit.has_more) return turn.due;
  const port::Instant start =
      takes_one() ? start_beside(turn.due, share_of(unit).free_at(), retry_cost(unit), now)
                  : turn.due;
  return losses_.is_cause(turn.address) ? std::max(start, losses_.free_at()) : start;
}

const TimeShare& BusSchedule::share_of(const UnitSchedule& unit) const {
  if (is_repeated(unit)) return unit.has_answered ? repeat_share_ : first_repeat_share_;
  return unit.has_answered ? lost_share_ : retry_share_;
}

port::Instant BusSchedule::repeat_start(port::Instant now) const {
  return first_of_failing(repeats_, now).start;
}

port::Instant BusSchedule::retry_start(port::Instant now) const {
  return first_of_failing(retries_, now).start;
}

port::Instant BusSchedule::discovery_start(port::Instant now) const {
  if (undiscovered_ == 0 || discovery_under_way_ || !losses_.may_ask()) return port::never;
  return start_beside(discovery_due_, discovery_allowed_,
                      takes_one() ? cost_max_ : port::Duration{}, now);
}

port::Instant BusSchedule::request_start(port::Instant due, port::Instant now) const {
  return start_beside(due, request_share_.free_at(), takes_one() ? cost_max_ : port::Duration{},
                      now);
}

port::Instant BusSchedule::client_start(port::Instant now) const {
  port::Instant first = undiscovered_ > 0 && !discovery_under_way_ ? discovery_due_ : port::never;
  for (const Turns* const turns : {&turns_, &firsts_, &repeats_, &retries_}) {
    if (!turns->empty()) first = std::min(first, turns->front().due);
  }
  const bool is_idle = first > now + (takes_one() ? cost_max_ : port::Duration{});
  return is_idle ? port::Instant{} : client_share_.free_at();
}

void BusSchedule::charge_client(port::Duration cost, port::Instant now) {
  client_share_.charge(cost * 100 / std::max(1u, settings_.share.percent), now);
}

// REQUIRES: undiscovered_ > 0.
ModbusAddress BusSchedule::next_undiscovered() {
  ModbusAddress address;
  do {
    address = discovery_[discovery_next_];
    discovery_next_ = (discovery_next_ + 1) % discovery_.size();
  } while (!units_[address.value].is_undiscovered);
  units_[address.value].is_undiscovered = false;
  --undiscovered_;
  return address;
}

port::Duration BusSchedule::cost_of(port::Instant asked_at, const port::BusAnswer& answer,
                                    port::Instant now) const {
  return std::min(now - asked_at, cost_max_ + bus_.delay_max()) + answer.silence;
}

// Time that nobody needs is none of a share: many that cost little are asked in it, and would use
// up the share of one that costs more than there is between two whose turn it is.
port::Duration BusSchedule::cost_to_others(const UnitSchedule& unit, port::Duration cost) {
  return std::clamp(unit.asked_at + cost - unit.wanted_at, port::Duration{}, cost);
}

// What the others had to wait for a unit that failed, or was only looked for, comes off its share.
void BusSchedule::note_cost(ModbusAddress address, const port::BusAnswer& answer,
                            port::Instant now) {
  losses_.note_result(address, answer.result);
  UnitSchedule& unit = units_[address.value];
  unit.silence = answer.silence;
  const port::Duration cost = cost_of(unit.asked_at, answer, now);
  const port::Duration waited = cost_to_others(unit, cost);
  const port::Duration missed = unit.missed_cost;
  const bool is_ok = answer.result == port::BusResult::ok;
  if (!is_ok) unit.cost = cost;
  unit.missed_cost = is_ok ? port::Duration{} : waited;
  switch (unit.reason) {
    case Reason::first:
      --unsure_under_way_;
      [[fallthrough]];
    case Reason::turn:
      // A unit that was never there is asked again in the time of those that fail.
      if (!is_ok && !unit.has_answered) charge_retry(unit, waited, now);
      return;
    case Reason::repeat:
      --unsure_under_way_;
      // One that loses every other answer has the time of the lost ones from this share too.
      if (unit.has_answered) return repeat_share_.charge(waited + missed, now);
      first_repeat_share_.charge(waited, now);
      if (!is_ok) charge_retry(unit, waited, now);
      return;
    case Reason::retry:
      --unsure_under_way_;
      // One that answers takes no more than those that are there.
      if (!is_ok) charge_retry(unit, waited, now);
      return;
    case Reason::discovery:
      discovery_under_way_ = false;
      discovery_due_ = unit.asked_at + poll_.interval;
      discovery_allowed_ = unit.asked_at + discovery_pause(cost);
  }
}

void BusSchedule::charge_request(port::Duration cost, port::Instant now) {
  request_share_.charge(cost, now);
}

void BusSchedule::note_success(ModbusAddress address, port::Instant now) {
  UnitSchedule& unit = units_[address.value];
  if (!is_sound(address) && sound_++ == 0) bring_back_all(now);
  const bool is_repeat = unit.has_answered && unit.reason == Reason::repeat;
  unit.repeats = is_repeat ? unit.repeats + 1 : 0;
  unit.has_answered = true;
  unit.failures = 0;
  const port::Duration pause = unit.repeats > repeats_free
                                   ? unevenly(poll_.interval, address, unit.repeats)
                                   : poll_.interval;
  ask_again(address, std::max(now, due_after(unit, pause)));
}

// The first unit answers again: whatever was broken is mended.
void BusSchedule::bring_back_all(port::Instant now) {
  mended_at_ = now;
  for (Turns* const turns : {&repeats_, &retries_}) {
    for (Turn& turn : *turns) {
      turn.due = std::min(turn.due, now);
      units_[turn.address.value].failures =
          std::min(units_[turn.address.value].failures, failures_free);
    }
    std::make_heap(turns->begin(), turns->end(), Later{});
  }
  for (TimeShare* const share :
       {&repeat_share_, &first_repeat_share_, &retry_share_, &lost_share_}) {
    share->open(now);
  }
}

void BusSchedule::note_failure(ModbusAddress address, bool is_miss, port::Instant now) {
  UnitSchedule& unit = units_[address.value];
  const bool was_sound = is_sound(address);
  if (was_sound) --sound_;
  if (!was_sound && unit.asked_at < mended_at_ && unit.failures > failures_free) {
    // It was asked while all were silent, so it comes back with the others.
    unit.failures = failures_free;
    return ask_again(address, now);
  }
  ++unit.failures;
  const bool is_lost = unit.failures >= failures_of_the_lost && sound_ > 0;
  if (!unit.is_listed && (!unit.has_answered || is_lost)) return rest(address);
  // Networks lose no frame; what is behind them does, but not of all at once.
  const bool is_at_once = is_miss && was_sound && (takes_one() || sound_ > 0);
  const port::Instant due = std::max(now, due_after(unit, pause_of(address, is_miss)));
  ask_again(address, is_at_once ? unit.due : due);
}

void BusSchedule::note_more(ModbusAddress address) {
  units_[address.value].has_more = true;
  ask_again(address, units_[address.value].due);
}

void BusSchedule::note_held_up(ModbusAddress address, port::Instant now) {
  UnitSchedule& unit = units_[address.value];
  if (!unit.has_answered || unit.failures == 0) return;
  for (Turns* const turns : {&repeats_, &retries_}) {
    const auto found = std::find_if(turns->begin(), turns->end(),
                                    [&](const Turn& turn) { return turn.address == address; });
    if (found == turns->end()) continue;
    turns->erase(found);
    std::make_heap(turns->begin(), turns->end(), Later{});
    unit.failures = 0;
    if (sound_++ == 0) bring_back_all(now);
    return ask_again(address, now);
  }
}

bool BusSchedule::note_link_lost(ModbusAddress address, port::Instant now) {
  const UnitSchedule& unit = units_[address.value];
  if (!unit.is_listed && !unit.has_answered) {
    losses_.forget(address);
    rest(address);
    return false;
  }
  if (losses_.note_loss(address, now)) return true;
  // That it lost its answer says nothing of when one that failed will be there again.
  const bool is_failing = unit.failures > failures_free;
  if (is_failing) losses_.forget(address);
  ask_again(address, is_failing ? std::max(now, due_after(unit, pause_of(address, false))) : now);
  return false;
}

// Being late does not add up, and what is missed by a whole interval is made up for once.
port::Instant BusSchedule::due_after(const UnitSchedule& unit, port::Duration pause) const {
  if (unit.is_made_up_for) return unit.asked_at + pause - poll_.interval;
  const bool is_on_time = unit.asked_at - unit.due < poll_.interval;
  return (is_on_time ? unit.due : unit.asked_at) + pause;
}

void BusSchedule::charge_retry(const UnitSchedule& unit, port::Duration cost, port::Instant now) {
  if (unit.has_answered) return lost_share_.charge(cost, now);
  retry_share_.charge(bus_.is_one_line() ? cost * (converter_parts - 1) / (retry_parts - 1) : cost,
                      now);
}

port::Duration BusSchedule::pause_of(ModbusAddress address, bool is_miss) const {
  const std::uint32_t failures = units_[address.value].failures;
  if (failures <= failures_free || (sound_ == 0 && !is_miss)) return poll_.interval;
  const std::uint32_t doublings =
      sound_ == 0 ? 0 : std::min(failures - failures_free, doublings_max);
  const port::Duration pause =
      std::clamp(poll_.interval * (std::int64_t{1} << doublings), poll_.interval,
                 std::max(poll_.interval, poll_.absent_interval));
  return unevenly(pause, address, failures);
}

// As many intervals as have the time for such a search.
port::Duration BusSchedule::discovery_pause(port::Duration cost) const {
  const port::Duration budget =
      std::max<port::Duration>(settings_.scan_budget, std::chrono::milliseconds(1));
  const std::int64_t intervals = cost / budget + 1;
  return intervals * poll_.interval;
}

// Whether it has failed only once, where a frame may have been lost: networks lose none, and what
// is behind them was there before.
bool BusSchedule::is_repeated(const UnitSchedule& unit) const {
  const bool is_serial = exchange_floor_ > port::Duration{};
  return unit.failures == 1 && (unit.has_answered || is_serial);
}

// The most that a question to it costs the others, where the bus takes one at a time.
port::Duration BusSchedule::retry_cost(const UnitSchedule& unit) const {
  return std::max({cost_max_, unit.timeout + unit.silence + exchange_floor_,
                   unit.failures > 0 ? unit.cost : port::Duration{}});
}

void BusSchedule::push(Turns& turns, const Turn& turn) {
  turns.push_back(turn);
  std::push_heap(turns.begin(), turns.end(), Later{});
}

void BusSchedule::ask_again(ModbusAddress address, port::Instant due) {
  const UnitSchedule& unit = units_[address.value];
  const Reason sound = unit.has_answered ? Reason::turn : Reason::first;
  const Reason failing = is_repeated(unit) ? Reason::repeat : Reason::retry;
  push(turns_of(unit.failures == 0 ? sound : failing), {.due = due, .address = address});
}

// It is looked for again when its time comes.
void BusSchedule::rest(ModbusAddress address) {
  UnitSchedule& unit = units_[address.value];
  unit.has_answered = false;
  unit.is_undiscovered = true;
  ++undiscovered_;
}

void BusSchedule::call_for(ModbusAddress address, port::Instant now) {
  if (!takes_one()) return ask_at_once(address, now);
  if (now < call_share_.free_at()) return bring_forward(address, now);
  call_share_.charge(retry_cost(units_[address.value]), now);
  ask_at_once(address, now);
}

void BusSchedule::ask_at_once(ModbusAddress address, port::Instant now) {
  for (TimeShare* const share :
       {&repeat_share_, &first_repeat_share_, &retry_share_, &lost_share_}) {
    share->open(now);
  }
  losses_.open(now);
  bring_forward(address, port::Instant{});
}

// It is asked in its turn, but as if it had been due then.
void BusSchedule::bring_forward(ModbusAddress address, port::Instant due) {
  UnitSchedule& unit = units_[address.value];
  if (unit.is_undiscovered) {
    unit.is_undiscovered = false;
    --undiscovered_;
    return ask_again(address, due);
  }
  for (Turns* const turns : all_turns()) {
    const auto found = std::find_if(turns->begin(), turns->end(),
                                    [&](const Turn& turn) { return turn.address == address; });
    if (found == turns->end()) continue;
    found->due = std::min(found->due, due);
    std::make_heap(turns->begin(), turns->end(), Later{});
  }
}

void BusSchedule::expect_silence(ModbusAddress address) {
  if (is_sound(address)) --sound_;
  units_[address.value].has_answered = false;
}

}  // namespace etcm::firmware
