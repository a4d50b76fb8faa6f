#include "firmware/polling/poller.h"

#include <algorithm>
#include <utility>

#include "firmware/protocol/modbus_exception.h"

namespace etcm::firmware {

namespace {

constexpr std::uint8_t torn_repeats_max = 3;
// Where the next block of a sweep has to wait for longer, the device may have moved since: the link
// was lost, or an answer to the same question may still come.
constexpr port::Duration sweep_pause_max = std::chrono::seconds(5);

void note_heard(BusCounters& counters, const port::BusAnswer& answer, port::Instant asked_at,
                port::Instant now) {
  if (port::is_of_converter(answer.result, answer.exception)) {
    counters.absence_told_at = now;
  } else if (answer.result != port::BusResult::timeout &&
             answer.result != port::BusResult::link_lost) {
    counters.heard_at = now;
    counters.heard_asked_at = std::max(counters.heard_asked_at, asked_at);
  }
}

TextLine exception_text(std::uint8_t code, bool is_node) {
  const ExceptionText text = explain_exception(code, is_node);
  return TextLine() << "exception " << code << ": " << text.meaning << "; " << text.cure;
}

constexpr std::string_view link_lost_text =
    "the connection ends each time it is asked, and the others wait for the next one; look at it, "
    "or take it out of `units`";

}  // namespace

TextLine explain_unbelieved(const UnitCounters& counters) {
  TextLine text;
  switch (counters.unbelieved_for) {
    case ReadingFault::none:
      return text << "not the node that is expected there: give each node a serial and a unit of "
                     "its own";
    case ReadingFault::other_axis: {
      const NoPosition why = explain(counters.told);
      return text << why.what << ": " << why.cure;
    }
    default:
      return text << explain(counters.unbelieved_for);
  }
}

Poller::Poller(const PollSettings& settings, std::span<const PolledBus> buses,
               ReadingListener& listener, port::Log& log, RequestSource* requests,
               const DeviceTable* devices)
    : listener_(listener), log_(log), requests_(requests), devices_(devices) {
  for (const PolledBus& polled : buses) add_bus(settings, polled);
}

void Poller::add_bus(const PollSettings& settings, const PolledBus& polled) {
  buses_.push_back({.bus = polled.bus,
                    .schedule = BusSchedule(settings, *polled.settings, *polled.bus),
                    .unit_at = std::vector<UnitIndex>(256, UnitIndex::none()),
                    .clients = ClientRequests(polled.clients)});
  add_units_of(BusIndex{bus_count() - 1});
}

// Those that it has already stay as they are.
void Poller::add_units_of(BusIndex number) {
  const BusSettings bus = buses_[number.value].schedule.settings();
  add_units(number, bus.units, true);
  add_units(number, bus.assign, true);
  if (!bus.assign.empty()) {
    add_units(number, {{{default_unit.value, default_unit.value}}}, true);
  }
  add_units(number, bus.scan, false);
}

void Poller::add_units(BusIndex number, std::span<const UnitRange> ranges, bool is_listed) {
  Bus& bus = buses_[number.value];
  for (const UnitRange range : ranges) {
    for (const ModbusAddress address : range) {
      if (!bus.unit_at[address.value].is_none()) continue;
      bus.unit_at[address.value] = UnitIndex{unit_count()};
      units_.push_back({.bus = number, .address = address});
      if (devices_ != nullptr) {
        PolledUnit& unit = units_.back();
        unit.device = devices_->at(number, address);
        if (unit.device != nullptr) {
          unit.swept.reserve(unit.device->register_count());
          measured_.reserve(unit.device->quantities().size());
        }
      }
      bus.schedule.add_unit(address, is_listed);
    }
  }
}

port::Instant Poller::update_settings(const PollSettings& settings,
                                      std::span<const BusSettings> buses, port::Instant now) {
  port::Instant heard_by = now;
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    heard_by = std::max(heard_by, buses_[i].schedule.update_settings(settings, buses[i], now));
    add_units_of(BusIndex{static_cast<std::uint32_t>(i)});
  }
  return heard_by;
}

void Poller::step(port::Instant now) {
  const port::Duration passed = now - std::exchange(stepped_at_, now);
  for (BusIndex number{0}; number.value < bus_count(); ++number.value) {
    Bus& bus = buses_[number.value];
    if (bus.under_way > 0) bus.counters.busy += passed;
    bus.bus->advance(now);
    port::BusAnswer answer;
    while (bus.bus->take_answer(answer)) {
      if (answer.ticket == request_ticket) {
        finish_request(number, answer, now);
      } else if (answer.ticket == client_ticket) {
        finish_for_client(number, answer, now);
      } else {
        take(answer, UnitIndex{answer.ticket}, now);
      }
    }
    while (const std::optional<std::uint8_t> unit = bus.bus->take_held_up()) {
      if (!bus.unit_at[*unit].is_none()) bus.schedule.note_held_up(ModbusAddress{*unit}, now);
    }
    while (bus.bus->ready() && ask_next(number, now)) {
    }
    if (!bus.bus->is_up()) {
      bus.clients.refuse_all();
      bus.counters.up_since = {};
    } else if (bus.counters.up_since == port::Instant{}) {
      bus.counters.up_since = now;
    }
  }
}

bool Poller::ask_next(BusIndex number, port::Instant now) {
  if (buses_[number.value].paused_until > now) return false;
  if (request_start(number, now) <= now && start_request(number, now)) return true;
  Bus& bus = buses_[number.value];
  if (bus.clients.start_at(bus.schedule, now) <= now && start_for_client(number, now)) return true;
  while (const std::optional<BusSchedule::Question> question = bus.schedule.next_question(now)) {
    const UnitIndex unit = bus.unit_at[question->address.value];
    if (units_[unit.value].swept_at + sweep_pause_max < now) units_[unit.value].block = 0;
    const port::RegisterRead read = read_of(unit);
    const port::Instant free_at = bus.bus->read_free_at(read, now);
    if (free_at > now) {
      bus.schedule.postpone(*question, free_at);
      continue;
    }
    bus.schedule.ask(*question, now);
    ++units_[unit.value].counters.requests;
    ++bus.under_way;
    bus.progressed_at = now;
    bus.bus->start_read(read, now);
    return true;
  }
  return false;
}

port::RegisterRead Poller::read_of(UnitIndex unit) const {
  const BusSchedule& schedule = schedule_of(unit);
  const ModbusAddress address = address_of(unit);
  if (const Device* const device = units_[unit.value].device) {
    const RegisterSpan block = device->blocks()[units_[unit.value].block];
    return {.address = address.value,
            .kind = device->kind(),
            .first = block.first,
            .count = block.count,
            .timeout = schedule.timeout(address),
            .ticket = unit.value};
  }
  return {.address = address.value,
          .first = node_register_first,
          .count = node_register_count,
          .timeout = schedule.timeout(address),
          .ticket = unit.value,
          .spare = schedule.has_answered(address) ? node_register_spare : stranger_register_spare};
}

port::Instant Poller::read_free_at(UnitIndex unit) const {
  return buses_[bus_of(unit).value].bus->read_free_at({.address = address_of(unit).value,
                                                       .first = node_register_first,
                                                       .count = node_register_count,
                                                       .spare = stranger_register_spare},
                                                      stepped_at_);
}

port::Instant Poller::write_free_at(UnitIndex unit) const {
  return buses_[bus_of(unit).value].bus->write_free_at(address_of(unit).value);
}

port::Instant Poller::next_deadline() const {
  port::Instant deadline = port::never;
  for (BusIndex number{0}; number.value < bus_count(); ++number.value) {
    const Bus& bus = buses_[number.value];
    deadline = std::min(deadline, bus.bus->next_deadline());
    if (!bus.bus->ready()) continue;
    const port::Instant next = std::min(
        {request_start(number, stepped_at_), bus.schedule.discovery_start(stepped_at_),
         bus.schedule.next_due(stepped_at_), bus.clients.start_at(bus.schedule, stepped_at_)});
    deadline = std::min(deadline, std::max(next, bus.paused_until));
  }
  return deadline;
}

bool Poller::is_stalled(BusIndex number, port::Instant now, port::Duration patience) const {
  const Bus& bus = buses_[number.value];
  if (bus.under_way > 0) {
    return bus.progressed_at + bus.schedule.cost_max() + bus.bus->delay_max() + patience < now;
  }
  if (!bus.bus->ready()) return false;
  const port::Instant due = bus.schedule.next_due(now);
  return due <= now && std::max(due, bus.progressed_at) + patience < now;
}

void Poller::ask_at_once(ModbusAddress address, port::Instant now) {
  for (Bus& bus : buses_) {
    if (!bus.unit_at[address.value].is_none()) bus.schedule.call_for(address, now);
  }
}

void Poller::ask_unit_at_once(UnitIndex unit, port::Instant now) {
  schedule_of(unit).ask_at_once(address_of(unit), now);
}

void Poller::expect_silence(UnitIndex unit) { schedule_of(unit).expect_silence(address_of(unit)); }

TextLine Poller::name(UnitIndex unit) const {
  return TextLine() << "unit " << address_of(unit).value << " of " << bus(bus_of(unit)).name;
}

void Poller::take(const port::BusAnswer& answer, UnitIndex index, port::Instant now) {
  const bool is_absence = port::is_absence(answer);
  PolledUnit& unit = units_[index.value];
  Bus& bus = buses_[unit.bus.value];
  note_heard(bus.counters, answer, bus.schedule.asked_at(unit.address), now);
  count_answer(unit, is_absence ? port::BusResult::timeout : answer.result, now);
  if (answer.result == port::BusResult::exception) unit.counters.exception = answer.exception;
  pause_after(answer, index, now);
  // What is to be believed comes from one sweep.
  if (answer.result != port::BusResult::ok) unit.block = 0;
  BusSchedule& schedule = schedule_of(index);
  schedule.note_cost(address_of(index), answer, now);
  if (port::is_of_converter(answer.result, answer.exception)) {
    const TextLine why = exception_text(answer.exception, unit.device == nullptr);
    return fail(index, {.why = why, .is_silence = true, .is_miss = true}, now);
  }
  switch (answer.result) {
    case port::BusResult::ok:
      return take_registers(answer, index, now);
    case port::BusResult::link_lost:
      if (schedule.note_link_lost(address_of(index), now)) {
        fail(index, {.why = link_lost_text, .is_silence = false}, now);
      }
      return;
    case port::BusResult::timeout:
    case port::BusResult::bad_answer:
      return fail(
          index, {.why = to_string(answer.result), .is_silence = is_absence, .is_miss = true}, now);
    case port::BusResult::exception: {
      const TextLine why = exception_text(answer.exception, unit.device == nullptr);
      return fail(index, {.why = why, .is_silence = false}, now);
    }
  }
}

void Poller::pause_after(const port::BusAnswer& answer, UnitIndex index, port::Instant now) {
  const PolledUnit& unit = units_[index.value];
  if (unit.device == nullptr || port::is_absence(answer)) return;
  Bus& bus = buses_[unit.bus.value];
  bus.paused_until = std::max(bus.paused_until, now + unit.device->pause());
}

bool Poller::complete_sweep(const port::BusAnswer& answer, PolledUnit& unit, port::Instant now) {
  if (unit.block == 0) unit.swept.clear();
  unit.swept.insert(unit.swept.end(), answer.registers.begin(), answer.registers.end());
  unit.swept_at = now;
  unit.block = static_cast<std::uint8_t>(unit.block + 1);
  if (unit.block < unit.device->blocks().size()) return false;
  unit.block = 0;
  return true;
}

void Poller::take_registers(const port::BusAnswer& answer, UnitIndex index, port::Instant now) {
  PolledUnit& unit = units_[index.value];
  BusSchedule& schedule = schedule_of(index);
  NodeReading reading;
  ReadingFault fault = ReadingFault::none;
  measured_.clear();
  if (unit.device == nullptr) {
    fault = decode_node(answer.registers, bus(unit.bus).word_order, reading, answer.left_out);
  } else if (complete_sweep(answer, unit, now)) {
    fault = unit.device->decode(unit.swept, reading, unit.counters.told);
    if (fault == ReadingFault::none) unit.device->measure(unit.swept, measured_);
  } else {
    return schedule.note_more(unit.address);
  }
  if (fault == ReadingFault::torn && unit.torn_repeats < torn_repeats_max) {
    ++unit.torn_repeats;
    ++unit.counters.torn;
    unit.counters.note_fault(UnitFault::torn, now);
    return schedule.note_more(unit.address);
  }
  unit.torn_repeats = 0;
  if (fault != ReadingFault::none) {
    const bool is_torn = fault == ReadingFault::torn;
    ++(is_torn ? unit.counters.torn : unit.counters.unbelieved);
    unit.counters.note_fault(is_torn ? UnitFault::torn : UnitFault::unbelieved, now);
    unit.counters.unbelieved_for = fault;
    const TextLine why = explain_unbelieved(unit.counters);
    return fail(index, {.why = why}, now);
  }
  if (!can_follow(index, reading, now)) return;
  if (!listener_.on_reading(index, reading, measured_, now)) {
    ++unit.counters.unbelieved;
    unit.counters.note_fault(UnitFault::unbelieved, now);
    unit.counters.unbelieved_for = ReadingFault::none;
    return fail(index, {.why = {}, .is_silence = true}, now);  // the listener has said why
  }
  note_sound(unit, now);
  schedule.note_success(unit.address, now);
}

// Before the schedule knows of it.
void Poller::note_sound(PolledUnit& unit, port::Instant now) {
  const Bus& bus = buses_[unit.bus.value];
  if (!bus.schedule.is_sound(unit.address) || unit.counters.sound_since < bus.counters.up_since) {
    unit.counters.sound_since = now;
  }
  unit.counters.sound_at = now;
}

bool Poller::is_answering(UnitIndex unit) const {
  const Bus& bus = buses_[bus_of(unit).value];
  return bus.bus->is_up() && is_sound(unit) && counters(unit).sound_since >= bus.counters.up_since;
}

bool Poller::can_follow(UnitIndex index, const NodeReading& reading, port::Instant now) {
  PolledUnit& unit = units_[index.value];
  const auto speed_max = unit.device == nullptr ? std::nullopt : unit.device->speed_max();
  if (!speed_max || (reading.status & node_status::fix_valid) == 0) return true;
  switch (unit.jumps.judge(reading.position, *speed_max, now)) {
    case JumpCheck::Verdict::take:
      return true;
    case JumpCheck::Verdict::take_instead:
      ++unit.counters.jumped;
      return true;
    case JumpCheck::Verdict::ask_again:
      schedule_of(index).note_more(unit.address);
      return false;
    case JumpCheck::Verdict::drop:
      ++unit.counters.jumped;
      unit.counters.note_fault(UnitFault::jumped, now);
      fail(index, {.why = "its position jumps farther than speed_max allows, each time elsewhere"},
           now);
      return false;
  }
  return true;
}

void Poller::count_answer(PolledUnit& unit, port::BusResult result, port::Instant now) {
  Bus& bus = buses_[unit.bus.value];
  --bus.under_way;
  bus.progressed_at = now;
  UnitCounters& counters = unit.counters;
  ++counters.results[static_cast<std::size_t>(result)];
  counters.recent.add(result == port::BusResult::ok);
  if (result != port::BusResult::ok) counters.note_fault(fault_of(result), now);
  if (result == port::BusResult::ok || result == port::BusResult::exception) {
    counters.answered_at = now;
  }
  if (result != port::BusResult::ok) return;
  bus.counters.answered_at = now;
  bus.counters.floor += bus.schedule.exchange_floor();
  counters.answer_time_last = now - bus.schedule.asked_at(unit.address);
  counters.answer_time += counters.answer_time_last;
  counters.answer_time_max = std::max(counters.answer_time_max, counters.answer_time_last);
}

void Poller::fail(UnitIndex index, const Failure& failure, port::Instant now) {
  BusSchedule& schedule = schedule_of(index);
  const ModbusAddress address = address_of(index);
  // One line for each spell of failures; units that were never there are no news.
  if (schedule.failures(address) == 0 && !failure.why.empty() &&
      (schedule.has_answered(address) || !failure.is_silence)) {
    log_.write(port::Level::warning, TextLine() << name(index) << ": " << failure.why);
  }
  schedule.note_failure(address, failure.is_miss, now);
}

port::Instant Poller::request_start(BusIndex number, port::Instant now) const {
  const Bus& bus = buses_[number.value];
  if (requests_ == nullptr || bus.request_under_way) return port::never;
  return bus.schedule.request_start(requests_->request_due(number), now);
}

bool Poller::start_request(BusIndex number, port::Instant now) {
  BusRequest request;
  if (!requests_->next_request(number, now, request)) return false;
  Bus& bus = buses_[number.value];
  bus.request_under_way = true;
  bus.request_asked_at = bus.progressed_at = now;
  ++bus.under_way;
  const port::Duration timeout = timeout_of(bus.schedule.settings(), request.address);
  if (request.read_count > 0) {
    bus.bus->start_read({.address = request.address.value,
                         .first = request.first,
                         .count = request.read_count,
                         .timeout = timeout,
                         .ticket = request_ticket,
                         .spare = request.spare},
                        now);
  } else {
    bus.bus->start_write({.address = request.address.value,
                          .first = request.first,
                          .values = request.values,
                          .timeout = timeout,
                          .ticket = request_ticket},
                         now);
  }
  return true;
}

void Poller::finish_request(BusIndex number, const port::BusAnswer& answer, port::Instant now) {
  Bus& bus = buses_[number.value];
  bus.request_under_way = false;
  --bus.under_way;
  bus.progressed_at = now;
  bus.schedule.charge_request(bus.schedule.cost_of(bus.request_asked_at, answer, now), now);
  requests_->on_request_done(number, answer, now);
}

bool Poller::start_for_client(BusIndex number, port::Instant now) {
  Bus& bus = buses_[number.value];
  if (!bus.clients.start(*bus.bus, bus.schedule, client_ticket, now)) return false;
  ++bus.under_way;
  bus.progressed_at = now;
  return true;
}

void Poller::finish_for_client(BusIndex number, const port::BusAnswer& answer, port::Instant now) {
  Bus& bus = buses_[number.value];
  --bus.under_way;
  bus.progressed_at = now;
  const UnitIndex unit = bus.unit_at[answer.address];
  if (!unit.is_none()) pause_after(answer, unit, now);
  bus.clients.finish(answer, bus.schedule, now);
}

}  // namespace etcm::firmware
