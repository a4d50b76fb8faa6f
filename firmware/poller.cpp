#include "poller.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

constexpr std::uint8_t torn_repeats_max = 3;
// A unit may miss this many answers in a row before it is asked less often.
constexpr std::uint32_t failures_free = 2;
// A day doubled this often is still a Duration.
constexpr std::uint32_t doublings_max = 16;

// Units that do not answer get one part in so many of the time of a bus that others want.
constexpr std::int64_t probe_share = 32;
// Bytes on a serial line for one question and one answer, with the silence around them.
constexpr std::int64_t question_characters = 8 + 29 + 7;

// The most a question costs that is not answered.
port::Duration cost_max(const BusSettings& bus) {
  const auto* const line = std::get_if<port::SerialLine>(&bus.link);
  return bus.timeout + (line == nullptr ? port::Duration{}
                                        : bus.quiet + question_characters * character_time(*line));
}

// A well-mixed number from two: the same in every run.
std::uint32_t mix(std::uint32_t a, std::uint32_t b) {
  std::uint32_t value = a * 0x9e3779b9u ^ b * 0x85ebca6bu;
  value = (value ^ value >> 16) * 0x7feb352du;
  value = (value ^ value >> 15) * 0x846ca68bu;
  return value ^ value >> 16;
}

constexpr auto later = [](const auto& a, const auto& b) { return a.due > b.due; };

}  // namespace

Poller::Poller(const PollSettings& settings, std::span<const PolledBus> buses,
               ReadingListener& listener, port::Log& log)
    : settings_(settings), listener_(listener), log_(log) {
  for (const PolledBus& bus : buses) {
    Line line{.polled = bus,
              .unit_at = std::vector<std::uint32_t>(256),
              .turns = {},
              .probes = {},
              .probes_max = std::max(1u, bus.settings->outstanding_max / 2),
              .takes_one = bus.settings->outstanding_max == 1,
              .probe_cost_max = cost_max(*bus.settings)};
    for (const UnitRange range : bus.settings->units) {
      for (unsigned address = range.first; address <= range.last; ++address) {
        const std::uint32_t unit = unit_count();
        line.unit_at[address] = unit;
        line.turns.push_back({.due = port::Instant{}, .unit = unit});
        units_.push_back({.bus = static_cast<std::uint32_t>(lines_.size()),
                          .address = static_cast<std::uint8_t>(address)});
      }
    }
    line.probes.reserve(line.turns.size());
    lines_.push_back(std::move(line));
  }
}

void Poller::step(port::Instant now) {
  stepped_at_ = now;
  for (Line& line : lines_) {
    port::NodeBus& bus = *line.polled.bus;
    bus.advance(now);
    port::BusAnswer answer;
    while (bus.take_answer(answer)) take(answer, line.unit_at[answer.unit], now);
    while (bus.ready()) {
      std::vector<Turn>* const turns = next_turns(line, now);
      if (turns == nullptr) break;
      std::pop_heap(turns->begin(), turns->end(), later);
      Unit& unit = units_[turns->back().unit];
      turns->pop_back();
      unit.is_probed = turns == &line.probes;
      if (unit.is_probed) ++line.probes_under_way;
      unit.asked_at = now;
      bus.start_read({.unit = unit.address,
                      .first = node_register_first,
                      .count = node_register_count,
                      .timeout = line.polled.settings->timeout},
                     now);
    }
  }
}

// Where the next question comes from: whoever has waited longest and may be asked. Null for nobody.
std::vector<Poller::Turn>* Poller::next_turns(Line& line, port::Instant now) {
  const port::Instant turn = line.turns.empty() ? port::never : line.turns.front().due;
  const port::Instant probe = probe_due(line, now);
  if (std::min(turn, probe) > now) return nullptr;
  // A probe of a busy line has its share of the time, however long the others have waited.
  if (line.takes_one && probe <= now) return &line.probes;
  return turn <= probe ? &line.turns : &line.probes;
}

// When a failing unit may be asked, as far as that is known now.
port::Instant Poller::probe_due(const Line& line, port::Instant now) {
  if (line.probes.empty() || line.probes_under_way >= line.probes_max) return port::never;
  const port::Instant due = line.probes.front().due;
  if (!line.takes_one || line.turns.empty()) return due;
  const bool is_idle = line.turns.front().due > std::max(due, now) + line.probe_cost_max;
  return is_idle ? due : std::max(due, line.probe_allowed);
}

port::Instant Poller::next_deadline() const {
  port::Instant deadline = port::never;
  for (const Line& line : lines_) {
    deadline = std::min(deadline, line.polled.bus->next_deadline());
    if (!line.polled.bus->ready()) continue;
    if (!line.turns.empty()) deadline = std::min(deadline, line.turns.front().due);
    deadline = std::min(deadline, probe_due(line, stepped_at_));
  }
  return deadline;
}

void Poller::ask_at_once(std::uint8_t address, port::Instant now) {
  for (Line& line : lines_) {
    for (std::vector<Turn>* const turns : {&line.turns, &line.probes}) {
      const auto found = std::find_if(turns->begin(), turns->end(), [&](const Turn& turn) {
        return units_[turn.unit].address == address;
      });
      if (found == turns->end()) continue;
      found->due = port::Instant{};
      std::make_heap(turns->begin(), turns->end(), later);
      line.probe_allowed = now;
    }
  }
}

std::string Poller::name(std::uint32_t unit) const {
  return "unit " + std::to_string(units_[unit].address) + " of " +
         lines_[units_[unit].bus].polled.settings->name;
}

void Poller::take(const port::BusAnswer& answer, std::uint32_t index, port::Instant now) {
  Unit& unit = units_[index];
  if (unit.is_probed) {
    Line& line = lines_[unit.bus];
    --line.probes_under_way;
    const bool is_in_vain =
        answer.result == port::BusResult::timeout || answer.result == port::BusResult::bad_answer;
    const port::Duration cost =
        now - unit.asked_at + (is_in_vain ? line.polled.settings->quiet : port::Duration{});
    line.probe_allowed = now + cost * (probe_share - 1);
  }
  switch (answer.result) {
    case port::BusResult::ok:
      break;
    case port::BusResult::link_lost:
      return ask_again(index, now);
    case port::BusResult::timeout:
      return fail(index, to_string(answer.result), true, now);
    case port::BusResult::bad_answer:
      return fail(index, to_string(answer.result), false, now);
    case port::BusResult::exception:
      return fail(index, "exception " + std::to_string(answer.exception), false, now);
  }
  NodeReading reading;
  const ReadingFault fault =
      decode_node(answer.registers, lines_[unit.bus].polled.settings->word_order, reading);
  if (fault == ReadingFault::torn && unit.torn_repeats < torn_repeats_max) {
    ++unit.torn_repeats;
    return ask_again(index, now);
  }
  unit.torn_repeats = 0;
  if (fault != ReadingFault::none) return fail(index, explain(fault), false, now);
  if (!listener_.on_reading(index, reading, now)) {
    return fail(index, "not the node that was expected", true, now);
  }
  count_sound(index, now);
  ask_again(index, std::max(now, unit.asked_at + settings_.interval));
}

void Poller::count_sound(std::uint32_t index, port::Instant now) {
  Unit& unit = units_[index];
  Line& line = lines_[unit.bus];
  if ((!unit.has_answered || unit.failures > 0) && line.sound++ == 0) {
    for (Turn& probe : line.probes) {
      probe.due = std::min(probe.due, now);
      units_[probe.unit].failures = std::min(units_[probe.unit].failures, failures_free);
    }
    std::make_heap(line.probes.begin(), line.probes.end(), later);
    line.probe_allowed = now;
  }
  unit.has_answered = true;
  unit.failures = 0;
}

void Poller::fail(std::uint32_t index, const std::string& why, bool is_silence, port::Instant now) {
  Unit& unit = units_[index];
  if (unit.has_answered && unit.failures == 0) --lines_[unit.bus].sound;
  ++unit.failures;
  // One line for each spell of failures; units that were never there are no news.
  if (unit.failures == 1 && (unit.has_answered || !is_silence)) {
    log_.write(port::Level::warning, name(index) + ": " + why);
  }
  ask_again(index, std::max(now, unit.asked_at + pause_of(index)));
}

port::Duration Poller::pause_of(std::uint32_t index) const {
  const std::uint32_t failures = units_[index].failures;
  if (failures <= failures_free || lines_[units_[index].bus].sound == 0) return settings_.interval;
  const std::uint32_t doublings = std::min(failures - failures_free, doublings_max);
  const port::Duration pause =
      std::clamp(settings_.interval * (std::int64_t{1} << doublings), settings_.interval,
                 std::max(settings_.interval, settings_.absent_interval));
  // Up to an eighth less.
  return pause - pause / 8 / 1024 * (mix(index, failures) % 1024);
}

void Poller::ask_again(std::uint32_t index, port::Instant due) {
  const Unit& unit = units_[index];
  Line& line = lines_[unit.bus];
  std::vector<Turn>& turns = unit.failures > 0 ? line.probes : line.turns;
  turns.push_back({.due = due, .unit = index});
  std::push_heap(turns.begin(), turns.end(), later);
}

}  // namespace etcm::firmware
