// What the poller does beside those whose turn it is: requests, looking for units, and what each of
// them, and the units that fail, may cost the others.
#include <algorithm>

#include "firmware/polling/poller.h"

namespace etcm::firmware {

void Poller::ask_at_once(std::uint8_t address, port::Instant now) {
  for (Line& line : lines_) {
    const std::uint32_t unit = line.unit_at[address];
    if (unit == no_unit) continue;
    takes_one(line) ? call_for(unit, now) : ask_unit_at_once(unit, now);
  }
}

// At once, whoever else is due, where the share of such calls allows; else as if it was due now.
void Poller::call_for(std::uint32_t index, port::Instant now) {
  const Unit& unit = units_[index];
  Line& line = lines_[unit.bus];
  if (now < line.call_share.free_at()) return bring_forward(index, now);
  line.call_share.charge(retry_cost(line, unit), now);
  ask_unit_at_once(index, now);
}

// Whether it has failed only once, where a frame may have been lost: networks lose none, and what
// is behind them was there before.
bool Poller::is_repeated(const Line& line, const Unit& unit) {
  const bool is_serial = line.exchange_floor > port::Duration{};
  return unit.failures == 1 && (unit.has_answered || is_serial);
}

// The most that a question to it costs the others, where the bus takes one at a time.
port::Duration Poller::retry_cost(const Line& line, const Unit& unit) {
  return std::max({line.retry_cost_max, unit.timeout + unit.silence + line.exchange_floor,
                   unit.failures > 0 ? unit.cost : port::Duration{}});
}

// no_unit where none may be asked now.
std::uint32_t Poller::next_discovery(Line& line, port::Instant now) {
  for (std::size_t looks = 0; looks < line.discovery.size(); ++looks) {
    const std::uint32_t unit = line.discovery[line.discovery_next];
    line.discovery_next = (line.discovery_next + 1) % line.discovery.size();
    if (!units_[unit].is_undiscovered) continue;
    if (line.polled.bus->read_free_at(read_of(unit), now) > now) continue;
    units_[unit].is_undiscovered = false;
    --line.undiscovered;
    return unit;
  }
  return no_unit;
}

// From when on something may be asked that is less urgent than those whose turn it is: at once
// where nobody is about to be asked, else when its share allows.
port::Instant Poller::start_beside(const Line& line, port::Instant due, port::Instant allowed,
                                   port::Instant now) {
  if (due == port::never || line.turns.empty()) return due;
  const port::Duration cost = takes_one(line) ? line.retry_cost_max : port::Duration{};
  const bool is_idle = line.turns.front().due > std::max(due, now) + cost;
  return is_idle ? due : std::max(due, allowed);
}

port::Instant Poller::request_start(std::uint32_t number, port::Instant now) const {
  const Line& line = lines_[number];
  if (requests_ == nullptr || line.request_under_way) return port::never;
  return start_beside(line, requests_->request_due(number), line.request_share.free_at(), now);
}

port::Instant Poller::scan_start(const Line& line, port::Instant now) {
  if (line.undiscovered == 0 || line.scan_under_way) return port::never;
  return start_beside(line, line.scan_due, line.scan_allowed, now);
}

bool Poller::start_request(std::uint32_t number, port::Instant now) {
  BusRequest request;
  if (!requests_->next_request(number, now, request)) return false;
  Line& line = lines_[number];
  line.request_under_way = true;
  line.request_asked_at = line.progressed_at = now;
  ++line.under_way;
  const port::Duration timeout = timeout_of(*line.polled.settings, request.address);
  if (request.read_count > 0) {
    line.polled.bus->start_read({.unit = request.address,
                                 .first = request.first,
                                 .count = request.read_count,
                                 .timeout = timeout,
                                 .ticket = request_ticket,
                                 .spare = request.spare},
                                now);
  } else {
    line.polled.bus->start_write({.unit = request.address,
                                  .first = request.first,
                                  .values = request.values,
                                  .timeout = timeout,
                                  .ticket = request_ticket},
                                 now);
  }
  return true;
}

void Poller::finish_request(std::uint32_t number, const port::BusAnswer& answer,
                            port::Instant now) {
  Line& line = lines_[number];
  line.request_under_way = false;
  --line.under_way;
  line.progressed_at = now;
  line.request_share.charge(cost_of(line.request_asked_at, answer, now), now);
  requests_->on_request_done(number, answer, now);
}

// What a request has cost the others.
port::Duration Poller::cost_of(port::Instant asked_at, const port::BusAnswer& answer,
                               port::Instant now) {
  return now - asked_at + answer.silence;
}

// What the others had to wait for a unit that failed, or was only looked for, comes off its share.
void Poller::note_cost(Unit& unit, const port::BusAnswer& answer, port::Instant now) {
  Line& line = lines_[unit.bus];
  const port::Duration cost = cost_of(unit.asked_at, answer, now);
  const port::Duration missed_cost = unit.cost;
  const bool is_ok = answer.result == port::BusResult::ok;
  if (!is_ok) unit.cost = cost;
  switch (unit.asking) {
    case Asking::turn:
      // Who was never there is asked again in the time of those that fail.
      if (!is_ok && !unit.has_answered) line.retry_share.charge(cost, now);
      return;
    case Asking::repeat:
      --line.retries_under_way;
      // One that loses every other answer has the time of the lost ones from this share too.
      if (unit.has_answered) return line.repeat_share.charge(cost + missed_cost, now);
      line.first_repeat_share.charge(cost, now);
      if (!is_ok) line.retry_share.charge(cost, now);
      return;
    case Asking::retry:
      --line.retries_under_way;
      // Who answers takes no more than those that are there.
      if (!is_ok) line.retry_share.charge(cost, now);
      return;
    case Asking::scan:
      line.scan_under_way = false;
      line.scan_due = unit.asked_at + settings_.interval;
      line.scan_allowed = unit.asked_at + scan_pause(line, cost);
  }
}

// As many intervals as have the time for such a search.
port::Duration Poller::scan_pause(const Line& line, port::Duration cost) const {
  const port::Duration budget = line.polled.settings->scan_budget;
  const std::int64_t intervals =
      cost / std::max<port::Duration>(budget, std::chrono::milliseconds(1)) + 1;
  return intervals * settings_.interval;
}

// It is looked for again when its time comes.
void Poller::rest(std::uint32_t index) {
  Unit& unit = units_[index];
  unit.has_answered = false;
  unit.is_undiscovered = true;
  ++lines_[unit.bus].undiscovered;
}

}  // namespace etcm::firmware
