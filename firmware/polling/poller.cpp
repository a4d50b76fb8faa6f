#include "firmware/polling/poller.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

namespace {

constexpr std::uint8_t torn_repeats_max = 3;
// A unit may miss this many answers in a row before it is asked less often.
constexpr std::uint32_t failures_free = 2;
// A day doubled this often is still a Duration.
constexpr std::uint32_t doublings_max = 16;

// A unit that is only looked for, was found, and has not answered so often is looked for again.
constexpr std::uint32_t failures_of_the_lost = 8;
// Bytes on a serial line for one question and one answer.
constexpr std::int64_t exchange_characters = 8 + 29;

// The least time a question and its answer keep a line; nothing where there is none.
port::Duration exchange_floor(const BusSettings& bus) {
  const auto* const line = std::get_if<port::SerialLine>(&bus.link);
  return line == nullptr ? port::Duration{}
                         : exchange_characters * character_time(*line) + 2 * frame_silence(*line);
}

// The most a question costs that is not answered.
port::Duration cost_max(const BusSettings& bus) {
  port::Duration timeout = bus.timeout;
  for (const UnitTimeout& other : bus.unit_timeouts) timeout = std::max(timeout, other.timeout);
  const bool is_line = std::holds_alternative<port::SerialLine>(bus.link);
  return timeout + (is_line ? bus.quiet + exchange_floor(bus) : port::Duration{});
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
               ReadingListener& listener, port::Log& log, RequestSource* requests)
    : settings_(settings), listener_(listener), log_(log), requests_(requests) {
  for (const PolledBus& bus : buses) {
    Line line{.polled = bus,
              .unit_at = std::vector<std::uint32_t>(256, no_unit),
              .turns = {},
              .repeats = {},
              .retries = {},
              .retries_max = std::max(1u, bus.settings->outstanding_max / 2),
              .retry_cost_max = cost_max(*bus.settings),
              .exchange_floor = exchange_floor(*bus.settings)};
    const auto add = [&](const std::vector<UnitRange>& ranges, bool is_listed) {
      for (const UnitRange range : ranges) {
        for (unsigned address = range.first; address <= range.last; ++address) {
          if (line.unit_at[address] != no_unit) continue;
          add_unit(line, static_cast<std::uint8_t>(address), is_listed);
        }
      }
    };
    add(bus.settings->units, true);
    add(bus.settings->assign, true);
    if (!bus.settings->assign.empty()) add({{default_unit, default_unit}}, true);
    add(bus.settings->scan, false);
    line.turns.reserve(line.turns.size() + line.discovery.size());
    line.repeats.reserve(line.turns.capacity());
    line.retries.reserve(line.turns.capacity());
    lines_.push_back(std::move(line));
  }
}

void Poller::add_unit(Line& line, std::uint8_t address, bool is_listed) {
  const std::uint32_t unit = unit_count();
  line.unit_at[address] = unit;
  units_.push_back({.bus = static_cast<std::uint32_t>(lines_.size()),
                    .address = address,
                    .timeout = timeout_of(*line.polled.settings, address),
                    .is_listed = is_listed,
                    .is_undiscovered = !is_listed});
  if (is_listed) {
    line.turns.push_back({.due = port::Instant{}, .unit = unit});
  } else {
    line.discovery.push_back(unit);
    ++line.undiscovered;
  }
}

port::Instant Poller::update_settings(port::Instant now) {
  for (Unit& unit : units_) {
    unit.timeout = timeout_of(*lines_[unit.bus].polled.settings, unit.address);
  }
  const port::Instant asked_by = now + settings_.interval;
  port::Instant heard_by = asked_by;
  for (Line& line : lines_) {
    line.retry_cost_max = cost_max(*line.polled.settings);
    heard_by = std::max(heard_by, asked_by + line.retry_cost_max);
    for (std::vector<Turn>* const turns : {&line.turns, &line.repeats, &line.retries}) {
      for (Turn& turn : *turns) turn.due = std::min(turn.due, now + pause_of(turn.unit));
      std::make_heap(turns->begin(), turns->end(), later);
    }
    line.scan_due = std::min(line.scan_due, asked_by);
    line.scan_allowed = std::min(line.scan_allowed, now + scan_pause(line, line.retry_cost_max));
  }
  return heard_by;
}

void Poller::step(port::Instant now) {
  const port::Duration passed = now - std::exchange(stepped_at_, now);
  for (std::uint32_t number = 0; number < bus_count(); ++number) {
    Line& line = lines_[number];
    if (line.under_way > 0) line.counters.busy += passed;
    port::NodeBus& bus = *line.polled.bus;
    bus.advance(now);
    port::BusAnswer answer;
    while (bus.take_answer(answer)) {
      if (answer.ticket == request_ticket) {
        finish_request(number, answer, now);
      } else {
        take(answer, answer.ticket, now);
      }
    }
    while (bus.ready() && ask_next(number, now)) {
    }
  }
}

// Whoever has a share of a busy bus comes before those that are due; their shares are small.
bool Poller::ask_next(std::uint32_t number, port::Instant now) {
  Line& line = lines_[number];
  if (request_start(number, now) <= now && start_request(number, now)) return true;
  if (scan_start(line, now) <= now) {
    const std::uint32_t discovery = next_discovery(line, now);
    if (discovery != no_unit) {
      ask(line, {.due = now, .unit = discovery}, Asking::scan, now);
      return true;
    }
    line.scan_due = now + settings_.interval;
  }
  while (std::vector<Turn>* const turns = next_turns(line, now)) {
    std::pop_heap(turns->begin(), turns->end(), later);
    Turn& turn = turns->back();
    const port::Instant free_at = line.polled.bus->read_free_at(read_of(turn.unit), now);
    if (free_at > now) {
      turn.due = free_at;
      std::push_heap(turns->begin(), turns->end(), later);
      continue;
    }
    const Turn next = turn;
    turns->pop_back();
    const Asking asking = turns == &line.turns     ? Asking::turn
                          : turns == &line.repeats ? Asking::repeat
                                                   : Asking::retry;
    ask(line, next, asking, now);
    return true;
  }
  return false;
}

port::RegisterRead Poller::read_of(std::uint32_t index) const {
  const Unit& unit = units_[index];
  return {.unit = unit.address,
          .first = node_register_first,
          .count = node_register_count,
          .timeout = unit.timeout,
          .ticket = index,
          .spare = unit.has_answered ? node_register_spare : stranger_register_spare};
}

port::Instant Poller::read_free_at(std::uint32_t unit) const {
  return lines_[units_[unit].bus].polled.bus->read_free_at({.unit = units_[unit].address,
                                                            .first = node_register_first,
                                                            .count = node_register_count,
                                                            .spare = stranger_register_spare},
                                                           stepped_at_);
}

port::Instant Poller::write_free_at(std::uint32_t unit) const {
  return lines_[units_[unit].bus].polled.bus->write_free_at(units_[unit].address);
}

void Poller::ask(Line& line, const Turn& turn, Asking asking, port::Instant now) {
  Unit& unit = units_[turn.unit];
  unit.due = turn.due;
  unit.asking = asking;
  if (asking == Asking::repeat || asking == Asking::retry) ++line.retries_under_way;
  if (asking == Asking::scan) line.scan_under_way = true;
  unit.asked_at = now;
  ++unit.counters.requests;
  ++line.under_way;
  line.progressed_at = now;
  line.polled.bus->start_read(read_of(turn.unit), now);
}

// Where the next question comes from: whoever has waited longest and may be asked. Null for nobody.
std::vector<Poller::Turn>* Poller::next_turns(Line& line, port::Instant now) const {
  const port::Instant turn = line.turns.empty() ? port::never : line.turns.front().due;
  const port::Instant repeat = repeat_start(line, now);
  const port::Instant retry = retry_start(line, now);
  if (std::min({turn, repeat, retry}) > now) return nullptr;
  std::vector<Turn>* const failing = repeat <= retry ? &line.repeats : &line.retries;
  if (!takes_one(line)) return turn <= std::min(repeat, retry) ? &line.turns : failing;
  if (turn > now) return failing;
  if (repeat <= now) return &line.repeats;
  // A retry of a busy line has its share of the time, however long the others have waited; but
  // where they will soon have been asked it comes after them, unless somebody calls for it.
  const bool is_first = retry <= now && (line.retries.front().due == port::Instant{} ||
                                         now - retry >= settings_.interval);
  return is_first ? &line.retries : &line.turns;
}

// When the first of these failing units may be asked, as far as that is known now.
port::Instant Poller::start_at_cost(const Line& line, const std::vector<Turn>& turns,
                                    const TimeShare& share, port::Instant now) const {
  if (turns.empty() || line.retries_under_way >= line.retries_max) return port::never;
  const port::Instant due = turns.front().due;
  if (!takes_one(line) || line.turns.empty()) return due;
  const port::Duration cost = retry_cost(line, units_[turns.front().unit]);
  const bool is_idle = line.turns.front().due > std::max(due, now) + cost;
  return is_idle ? due : std::max(due, share.free_at());
}

port::Instant Poller::repeat_start(const Line& line, port::Instant now) const {
  const bool is_first = !line.repeats.empty() && !units_[line.repeats.front().unit].has_answered;
  return start_at_cost(line, line.repeats, is_first ? line.first_repeat_share : line.repeat_share,
                       now);
}

port::Instant Poller::retry_start(const Line& line, port::Instant now) const {
  return start_at_cost(line, line.retries, line.retry_share, now);
}

port::Instant Poller::next_deadline() const {
  port::Instant deadline = port::never;
  for (std::uint32_t number = 0; number < bus_count(); ++number) {
    const Line& line = lines_[number];
    deadline = std::min(deadline, line.polled.bus->next_deadline());
    if (!line.polled.bus->ready()) continue;
    deadline =
        std::min({deadline, request_start(number, stepped_at_), scan_start(line, stepped_at_)});
    if (!line.turns.empty()) deadline = std::min(deadline, line.turns.front().due);
    deadline =
        std::min({deadline, repeat_start(line, stepped_at_), retry_start(line, stepped_at_)});
  }
  return deadline;
}

bool Poller::is_stalled(std::uint32_t bus, port::Instant now, port::Duration patience) const {
  const Line& line = lines_[bus];
  if (line.under_way > 0) {
    return line.progressed_at + cost_max(*line.polled.settings) + line.polled.bus->delay_max() +
               patience <
           now;
  }
  if (!line.polled.bus->ready()) return false;
  const port::Instant turn = line.turns.empty() ? port::never : line.turns.front().due;
  const port::Instant due = std::min({turn, repeat_start(line, now), retry_start(line, now)});
  return due <= now && std::max(due, line.progressed_at) + patience < now;
}

void Poller::ask_unit_at_once(std::uint32_t unit, port::Instant now) {
  Line& line = lines_[units_[unit].bus];
  for (TimeShare* const share : {&line.repeat_share, &line.first_repeat_share, &line.retry_share}) {
    share->open(now);
  }
  bring_forward(unit, port::Instant{});
}

// It is asked in its turn, but as if it had been due then.
void Poller::bring_forward(std::uint32_t index, port::Instant due) {
  Unit& unit = units_[index];
  Line& line = lines_[unit.bus];
  if (unit.is_undiscovered) {
    unit.is_undiscovered = false;
    --line.undiscovered;
    return ask_again(index, due);
  }
  for (std::vector<Turn>* const turns : {&line.turns, &line.repeats, &line.retries}) {
    const auto found = std::find_if(turns->begin(), turns->end(),
                                    [&](const Turn& turn) { return turn.unit == index; });
    if (found == turns->end()) continue;
    found->due = std::min(found->due, due);
    std::make_heap(turns->begin(), turns->end(), later);
  }
}

void Poller::expect_silence(std::uint32_t index) {
  Unit& unit = units_[index];
  if (is_sound(index)) --lines_[unit.bus].sound;
  unit.has_answered = false;
}

TextLine Poller::name(std::uint32_t unit) const {
  return TextLine() << "unit " << units_[unit].address << " of " << bus(units_[unit].bus).name;
}

void Poller::take(const port::BusAnswer& answer, std::uint32_t index, port::Instant now) {
  Unit& unit = units_[index];
  count_answer(unit, port::is_absence(answer) ? port::BusResult::timeout : answer.result, now);
  unit.silence = answer.silence;
  note_cost(unit, answer, now);
  if (port::is_of_converter(answer.result, answer.exception)) {
    TextLine why;
    why << "exception " << answer.exception << ": nobody is there, says the converter";
    return miss(index, why, true, now);
  }
  switch (answer.result) {
    case port::BusResult::ok:
      break;
    case port::BusResult::link_lost:
      return unit.is_listed || unit.has_answered ? ask_again(index, now) : rest(index);
    case port::BusResult::timeout:
    case port::BusResult::bad_answer:
      return miss(index, to_string(answer.result), answer.result == port::BusResult::timeout, now);
    case port::BusResult::exception:
      return fail(index, TextLine() << "exception " << answer.exception, false, now);
  }
  NodeReading reading;
  const ReadingFault fault = decode_node(
      answer.registers, lines_[unit.bus].polled.settings->word_order, reading, answer.left_out);
  if (fault == ReadingFault::torn && unit.torn_repeats < torn_repeats_max) {
    ++unit.torn_repeats;
    ++unit.counters.torn;
    return ask_again(index, unit.due);
  }
  unit.torn_repeats = 0;
  if (fault != ReadingFault::none) {
    ++(fault == ReadingFault::torn ? unit.counters.torn : unit.counters.unbelieved);
    return fail(index, explain(fault), false, now);
  }
  if (!listener_.on_reading(index, reading, now)) {
    ++unit.counters.unbelieved;
    return fail(index, {}, true, now);  // the listener has said why
  }
  count_sound(index, now);
  ask_again(index, std::max(now, next_due(unit, settings_.interval)));
}

void Poller::miss(std::uint32_t index, std::string_view why, bool is_silence, port::Instant now) {
  const bool was_sound = is_sound(index);
  fail(index, why, is_silence, now);
  const Unit& unit = units_[index];
  const Line& line = lines_[unit.bus];
  // Networks lose no frame; what is behind them does, but not of all at once.
  if (was_sound && (takes_one(line) || line.sound > 0)) bring_forward(index, unit.due);
}

void Poller::count_answer(Unit& unit, port::BusResult result, port::Instant now) {
  Line& line = lines_[unit.bus];
  --line.under_way;
  line.progressed_at = now;
  UnitCounters& counters = unit.counters;
  ++counters.results[static_cast<std::size_t>(result)];
  if (result == port::BusResult::ok || result == port::BusResult::exception) {
    counters.answered_at = now;
  }
  if (result != port::BusResult::ok) return;
  line.counters.answered_at = now;
  line.counters.floor += line.exchange_floor;
  counters.answer_time_last = now - unit.asked_at;
  counters.answer_time += counters.answer_time_last;
  counters.answer_time_max = std::max(counters.answer_time_max, counters.answer_time_last);
}

void Poller::count_sound(std::uint32_t index, port::Instant now) {
  Unit& unit = units_[index];
  Line& line = lines_[unit.bus];
  if ((!unit.has_answered || unit.failures > 0) && line.sound++ == 0) {
    for (std::vector<Turn>* const turns : {&line.repeats, &line.retries}) {
      for (Turn& turn : *turns) {
        turn.due = std::min(turn.due, now);
        units_[turn.unit].failures = std::min(units_[turn.unit].failures, failures_free);
      }
      std::make_heap(turns->begin(), turns->end(), later);
    }
    line.repeat_share.open(now);
    line.first_repeat_share.open(now);
    line.retry_share.open(now);
  }
  unit.has_answered = true;
  unit.failures = 0;
}

void Poller::fail(std::uint32_t index, std::string_view why, bool is_silence, port::Instant now) {
  Unit& unit = units_[index];
  if (unit.has_answered && unit.failures == 0) --lines_[unit.bus].sound;
  ++unit.failures;
  // One line for each spell of failures; units that were never there are no news.
  if (unit.failures == 1 && !why.empty() && (unit.has_answered || !is_silence)) {
    log_.write(port::Level::warning, TextLine() << name(index) << ": " << why);
  }
  const bool is_lost = unit.failures >= failures_of_the_lost && lines_[unit.bus].sound > 0;
  if (!unit.is_listed && (!unit.has_answered || is_lost)) return rest(index);
  ask_again(index, std::max(now, next_due(unit, pause_of(index))));
}

// Being late does not add up, but what was missed by a whole interval is not made up for either.
port::Instant Poller::next_due(const Unit& unit, port::Duration pause) const {
  const bool is_on_time = unit.asked_at - unit.due < settings_.interval;
  return (is_on_time ? unit.due : unit.asked_at) + pause;
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
  std::vector<Turn>& turns = unit.failures == 0        ? line.turns
                             : is_repeated(line, unit) ? line.repeats
                                                       : line.retries;
  turns.push_back({.due = due, .unit = index});
  std::push_heap(turns.begin(), turns.end(), later);
}

}  // namespace etcm::firmware
