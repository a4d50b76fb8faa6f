#include "firmware/nodes/presence.h"

#include <algorithm>

#include "firmware/nodes/silence_cause.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// An eighth of the pause it watches for is late by little, and costs little.
port::Duration sweep_interval(const PollSettings& poll) {
  return std::clamp<port::Duration>(std::min(poll.stale_after, poll.leave_after) / 8, 1ms, 1s);
}

std::int64_t whole_seconds(port::Duration duration) {
  return std::chrono::floor<std::chrono::seconds>(duration).count();
}

}  // namespace

TextLine last_place_of(const NodeRecord& node, const Poller& poller) {
  if (node.last_unit.is_none()) return TextLine() << "on no bus of this configuration";
  return poller.name(node.last_unit);
}

Presence::Presence(const PollSettings& settings, const Poller& poller, NodeTable& nodes,
                   ReadingTable& readings, NodePlacement& placement, port::Log& log)
    : settings_(settings),
      poller_(poller),
      nodes_(nodes),
      readings_(readings),
      placement_(placement),
      log_(log),
      clock_(settings, poller.bus_count()),
      buses_(poller.bus_count()),
      sweep_interval_(sweep_interval(settings)) {}

void Presence::turn(port::Instant now) {
  clock_.turn(now, sweep_interval_);
  for (BusIndex bus{0}; bus.value < poller_.bus_count(); ++bus.value) {
    const bool is_finding = poller_.is_finding(bus) && clock_.heard_at(bus) != port::Instant{};
    if (poller_.is_clearing(bus, now) || is_finding) clock_.excuse(bus);
  }
}

void Presence::hear_unit(UnitIndex unit, port::Instant now) {
  const BusIndex number = poller_.bus_of(unit);
  const port::Instant heard_at = clock_.heard_at(number);
  clock_.hear(number, now);
  if (!std::exchange(buses_[number.value].is_silent, false)) return;
  changed_ = true;
  TextLine line;
  line << "bus " << poller_.bus(number).name;
  if (heard_at == port::Instant{}) {
    line << ": answers, for the first time since the start";
  } else {
    line << ": answers again, after " << whole_seconds(now - heard_at) << " s";
  }
  log_.write(port::Level::info, line);
}

void Presence::hear_node(NodeRecord& node, const NodeReading& reading, port::Instant now) {
  if (std::exchange(node.is_missing, false)) {
    changed_ = true;
    TextLine line;
    log_.write(port::Level::info, line << nodes_.called(node)
                                       << " is back: it answers again, after "
                                       << whole_seconds(now - node.heard_at) << " s");
  }
  node.heard_at = now;
  node.heard = clock_.shown(bus_of(node));
  node.status = reading.status;
  note_leaving(node, now);
  if ((reading.status & node_status::fix_valid) == 0) return;
  if (std::exchange(node.lacks_fix, false)) tell_fix(node, now);
  node.position = reading.position;
  node.positioned_at = now;
  if (std::exchange(node.stale, false)) changed_ = true;
}

// It is told apart from who has no fix yet, and from who is missing.
void Presence::note_leaving(NodeRecord& node, port::Instant now) {
  const bool has_left = node.left_at != port::Instant{};
  if (has_left == node.has_asked_to_leave()) return;
  node.left_at = has_left ? port::Instant{} : now;
  changed_ = true;
}

void Presence::sweep(port::Instant now, std::uint32_t generation) {
  sweep_due_ = now + sweep_interval_;
  for (Bus& bus : buses_) bus.nodes = 0;
  waiting_ = 0;
  for (NodeRecord& node : nodes_.records()) {
    if (!node.is_known()) continue;
    check_node(node, now, generation);
    if (node.is_waiting()) ++waiting_;
  }
  check_readings(now);
  for (BusIndex bus{0}; bus.value < buses_.size(); ++bus.value) check_bus(bus, now);
}

void Presence::update_settings(const PollSettings& settings, port::Instant heard_by,
                               port::Instant now) {
  settings_ = settings;
  clock_.update_settings(settings);
  clock_.add_buses(poller_.bus_count());
  buses_.resize(poller_.bus_count());
  sweep_interval_ = sweep_interval(settings_);
  if (heard_by <= now) return;
  clock_.postpone(heard_by - now);
  fresh_from_ = heard_by;
}

bool Presence::dismiss(NodeRecord& node) {
  if (!node.is_missing || node.is_placed()) return false;
  TextLine line;
  placement_.tell_node(line, node);
  log_.write(port::Level::info, line << " is no longer missed: dismissed");
  nodes_.release(node);
  changed_ = true;
  return true;
}

void Presence::tell_missing(port::Instant now) {
  const NodeRecord* first = nullptr;
  std::uint32_t count = 0;
  for (const NodeRecord& node : nodes_.records()) {
    if (!node.is_missing) continue;
    ++count;
    if (first == nullptr || node.heard_at < first->heard_at) first = &node;
  }
  if (first == nullptr) return;
  TextLine line;
  line << count << (count == 1 ? " node is" : " nodes are")
       << " missing since before the restart: " << (count == 1 ? "" : "the longest ")
       << nodes_.called(*first) << ", " << last_place_of(*first, poller_) << ", silent for "
       << whole_seconds(now - first->heard_at) << " s at least";
  log_.write(port::Level::warning, line);
}

std::uint32_t Presence::silent_bus_count() const {
  return static_cast<std::uint32_t>(
      std::count_if(buses_.begin(), buses_.end(), [](const Bus& bus) { return bus.is_silent; }));
}

// The bus that it was heard on last; its clock is the one that counts.
BusIndex Presence::bus_of(const NodeRecord& node) const {
  return node.last_unit.is_none() ? BusIndex::none() : poller_.bus_of(node.last_unit);
}

void Presence::check_node(NodeRecord& node, port::Instant now, std::uint32_t generation) {
  // The gateway that hears it says how it is.
  if (node.is_foreign()) return;
  if (node.has_asked_to_leave() && !node.is_placed()) {
    // It leaves at once, whatever its bus does.
    if (now - node.heard_at > settings_.leave_after) nodes_.release(node);
    return;
  }
  const BusIndex bus = bus_of(node);
  // Before it is asked its silence says nothing.
  const bool is_asked = bus.is_none() || poller_.counters(node.last_unit).requests > 0;
  if (!is_asked) node.heard = clock_.shown(bus);
  if (node.is_missing || clock_.silence_since(bus, node.heard) > settings_.leave_after) {
    return lose(node, now, generation);
  }
  if (!bus.is_none()) ++buses_[bus.value].nodes;
  check_freshness(node, now);
}

void Presence::lose(NodeRecord& node, port::Instant now, std::uint32_t generation) {
  if (!node.has_asked_to_leave() && !std::exchange(node.is_missing, true)) {
    changed_ = true;
    TextLine line;
    log_.write(port::Level::warning,
               line << nodes_.called(node) << " is missing: " << last_place_of(node, poller_)
                    << ", silent for " << whole_seconds(now - node.heard_at)
                    << " s; it counts as missing until it answers, or is dismissed: "
                       "sudo etcm-gateway ctl dismiss "
                    << node.serial.value);
    nodes_.vacate(node);
  }
  if (node.is_placed()) {
    placement_.leave(node, "silent", generation);
  } else {
    placement_.clear_rejection(node);
  }
}

void Presence::check_freshness(NodeRecord& node, port::Instant now) {
  const bool is_old_place = is_old(node.positioned_at, now);
  const bool is_stale = node.stale || is_old_place;
  // One that is known from before a restart is stale, and may tell its place any moment.
  const bool lacks_fix = is_old_place && node.answered_at != port::Instant{} &&
                         now - node.heard_at <= settings_.stale_after &&
                         (node.status & node_status::fix_valid) == 0;
  const bool is_news = is_stale != node.stale || lacks_fix != node.lacks_fix;
  if (lacks_fix && !node.lacks_fix) tell_no_fix(node, now);
  node.stale = is_stale;
  node.lacks_fix = lacks_fix;
  changed_ = changed_ || (is_news && node.is_placed());
}

void Presence::tell_no_fix(const NodeRecord& node, port::Instant now) {
  TextLine line;
  line << nodes_.called(node) << " has no fix: " << last_place_of(node, poller_)
       << " answers, and has told no position ";
  if (node.has_position()) {
    line << "for " << whole_seconds(now - node.positioned_at) << " s";
  } else {
    line << "yet";
  }
  if (node.is_placed()) line << "; it stays where it was";
  const DevicePosition::State told = told_at(poller_, node.last_unit);
  if (told != DevicePosition::State::value) {
    const NoPosition why = explain(told);
    line << "; it " << why.what << ": " << why.cure;
  }
  log_.write(port::Level::warning, line);
}

void Presence::tell_fix(const NodeRecord& node, port::Instant now) {
  TextLine line;
  line << nodes_.called(node) << " has a fix";
  if (node.has_position()) {
    line << " again, after " << whole_seconds(now - node.positioned_at) << " s";
  }
  log_.write(port::Level::info, line);
}

void Presence::check_readings(port::Instant now) {
  for (ReadingRecord& record : readings_.records()) {
    if (record.serial.is_none() || record.is_stale) continue;
    const NodeRecord* const node = nodes_.find(record.serial);
    const bool is_missing = node != nullptr && node->is_missing;
    if (is_missing || is_old(record.taken_at, now)) readings_.set_stale(record);
  }
}

void Presence::check_bus(BusIndex number, port::Instant now) {
  Bus& bus = buses_[number.value];
  // Once it is, only an answer ends that.
  const bool is_silent =
      (bus.nodes > 0 && (bus.is_silent || clock_.is_silent(number))) || has_never_answered(number);
  if (std::exchange(bus.is_silent, is_silent) == is_silent) return;
  changed_ = true;
  if (is_silent) tell_silent(number, now);
}

// One without units of its own may well have none.
bool Presence::has_never_answered(BusIndex bus) const {
  return clock_.heard_at(bus) == port::Instant{} && !poller_.bus(bus).units.empty() &&
         clock_.silence_of(bus) > settings_.leave_after;
}

void Presence::tell_silent(BusIndex number, port::Instant now) {
  const std::uint32_t nodes = buses_[number.value].nodes;
  TextLine line;
  line << "bus " << poller_.bus(number).name << ": silent";
  const port::Instant heard_at = clock_.heard_at(number);
  if (heard_at == port::Instant{}) {
    line << " since the start";
  } else {
    line << " for " << whole_seconds(now - heard_at) << " s";
  }
  if (nodes == 0) {
    line << ", none of its units has answered; ";
  } else {
    line << ", none of its " << nodes << (nodes == 1 ? " node" : " nodes")
         << " answers, and none leaves the mesh for that; ";
  }
  line << silence_cause(poller_, number, now, settings_.stale_after);
  log_.write(port::Level::warning, line);
}

}  // namespace etcm::firmware
