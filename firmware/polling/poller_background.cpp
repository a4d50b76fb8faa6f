// What the poller does beside those whose turn it is: requests, looking for units, and what each of
// them, and the units that fail, may cost the others.
#include <algorithm>

#include "firmware/polling/poller.h"

namespace etcm::firmware {

namespace {

// Units that do not answer get one part in so many of the time of a bus that others want.
constexpr std::int64_t retry_time_share = 32;
// So have requests.
constexpr std::int64_t request_share = 16;

}  // namespace

void Poller::ask_at_once(std::uint8_t address, port::Instant now) {
  for (Line& line : lines_) {
    const std::uint32_t unit = line.unit_at[address];
    if (unit == no_unit) continue;
    takes_one(line) ? call_for(unit, now, now) : ask_unit_at_once(unit, now);
  }
}

// One that answered the time before is most likely still there: a frame was lost.
void Poller::repeat(std::uint32_t index, port::Instant now) {
  const Unit& unit = units_[index];
  const Line& line = lines_[unit.bus];
  if (takes_one(line)) return call_for(index, unit.due, now);
  // Networks lose none; what is behind them does, but not all of it at once.
  if (line.sound > 0) bring_forward(index, unit.due);
}

// At once, whoever else is due, where the share of such calls allows; else as if it was due then.
void Poller::call_for(std::uint32_t index, port::Instant due, port::Instant now) {
  const Unit& unit = units_[index];
  Line& line = lines_[unit.bus];
  if (now < line.call_allowed) return bring_forward(index, due);
  line.call_allowed = now + retry_cost(line, unit) * retry_time_share;
  ask_unit_at_once(index, now);
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
  return start_beside(line, requests_->request_due(number), line.request_allowed, now);
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
  line.request_allowed = now + cost_of(line.request_asked_at, answer, now) * (request_share - 1);
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
  if (answer.result != port::BusResult::ok) unit.cost = cost;
  if (unit.asking == Asking::turn) {
    // Who was never there is asked again in the time of those that fail.
    if (answer.result != port::BusResult::ok && !unit.has_answered) {
      line.retry_allowed = std::max(line.retry_allowed, now + cost * (retry_time_share - 1));
    }
    return;
  }
  if (unit.asking == Asking::retry) {
    --line.retries_under_way;
    // Who answers takes no more than those that are there.
    if (answer.result != port::BusResult::ok) {
      line.retry_allowed = now + cost * (retry_time_share - 1);
    }
    return;
  }
  line.scan_under_way = false;
  line.scan_due = unit.asked_at + settings_.interval;
  line.scan_allowed = unit.asked_at + scan_pause(line, cost);
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
