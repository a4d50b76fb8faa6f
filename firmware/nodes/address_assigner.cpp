#include "firmware/nodes/address_assigner.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace etcm::firmware {

namespace {

// A node may be busy for a moment with its change of unit.
constexpr std::uint8_t verifications_max = 3;
// Of several at the default unit one was heard, and the next one's answer falls into what is asked
// then; by the next time it has ended.
constexpr std::uint8_t unit_looks_max = 3;
constexpr std::uint8_t silences_wanted = 2;
constexpr port::Duration look_pause = std::chrono::seconds(1);

}  // namespace

AddressAssigner::AddressAssigner(const PollSettings& settings, const Poller& poller,
                                 NodeTable& nodes, port::Log& log)
    : settings_(settings), poller_(poller), nodes_(nodes), log_(log), jobs_(poller.bus_count()) {}

void AddressAssigner::on_newcomer(BusIndex bus, Serial serial, port::Instant now) {
  Job& job = jobs_[bus.value];
  if (poller_.bus(bus).assign.empty() || job.step != Step::none) return;
  if (job.last_serial == serial && now < job.retry_at) return;
  job.serial = serial;
  choose(bus, true, now);
}

port::Instant AddressAssigner::due(BusIndex bus) const {
  const Job& job = jobs_[bus.value];
  if (job.step == Step::none) return port::never;
  // Behind a converter one dead unit may hold up all that is asked for a while: until there is an
  // answer to something that was asked later silence says nothing.
  const bool is_repeated = job.step == Step::look && job.silences > 0;
  if (is_repeated && poller_.bus_counters(bus).heard_asked_at <= job.looked_at) return port::never;
  const port::Instant free_at = job.step == Step::write
                                    ? poller_.write_free_at(poller_.unit_at(bus, default_unit))
                                    : poller_.read_free_at(job.unit_index);
  return std::max(job.due, free_at);
}

void AddressAssigner::next(BusIndex bus, BusRequest& request) {
  Job& job = jobs_[bus.value];
  job.due = port::never;
  if (job.step == Step::write) {
    job.registers = encode_assignment(poller_.address_of(job.unit_index), job.serial,
                                      poller_.bus(bus).word_order);
    request = {
        .address = default_unit, .first = assignment_register_first, .values = job.registers};
    return;
  }
  request = {.address = poller_.address_of(job.unit_index),
             .first = node_register_first,
             .read_count = node_register_count,
             .spare = stranger_register_spare,
             .values = {}};
}

AddressAssigner::Answerer AddressAssigner::done(BusIndex bus, const port::BusAnswer& answer,
                                                port::Instant now) {
  Job& job = jobs_[bus.value];
  // For some converters that is silence: they end the connection where nobody answers.
  const bool is_lost = answer.result == port::BusResult::link_lost;
  const bool is_as_silent = is_lost && job.step == Step::look && poller_.loses_link(job.unit_index);
  if (is_lost && !is_as_silent) {
    end(job, now);
    return {};
  }
  job.due = now;
  switch (job.step) {
    case Step::none:
      break;
    case Step::look:
      job.looked_at = now;
      // Whatever answers there, it is not free. Silence may have been a converter's that was busy:
      // by the second look its unit has the patience that the first one's late answer taught.
      if ((answer.result == port::BusResult::timeout || is_as_silent) &&
          ++job.silences < silences_wanted) {
        break;
      }
      // A poll may have been answered meanwhile.
      if ((port::is_absence(answer) || is_as_silent) && is_free(job.unit_index)) {
        job.step = Step::write;
      } else if (answer.result == port::BusResult::bad_answer && ++job.tries < unit_looks_max) {
        job.due = now + look_pause;
      } else {
        const UnitIndex taken = job.unit_index;
        choose(bus, false, now);
        if (answer.result == port::BusResult::ok) return {.unit = taken};
      }
      break;
    case Step::write:
      if (answer.result == port::BusResult::exception && !port::is_absence(answer)) {
        give_up(job, "it answers with an exception", now);
      } else {
        // It may have changed before it could answer.
        job.step = Step::verify;
        job.tries = 0;
      }
      break;
    case Step::verify: {
      NodeReading reading;
      const bool is_it = answer.result == port::BusResult::ok &&
                         decode_node(answer.registers, poller_.bus(bus).word_order, reading,
                                     answer.left_out) == ReadingFault::none &&
                         reading.serial == job.serial;
      if (is_it) {
        TextLine line;
        log_.write(port::Level::info, line << nodes_.called(job.serial) << " has "
                                           << poller_.name(job.unit_index) << " now");
        job.is_full = false;
        job.unwilling = Serial::none();
        const UnitIndex unit = job.unit_index;
        end(job, now);
        return {.unit = unit, .is_assigned = true};
      }
      if (++job.tries == verifications_max) give_up(job, "it does not answer there", now);
      break;
    }
  }
  return {};
}

bool AddressAssigner::is_free(UnitIndex unit) const {
  return nodes_.at(unit) == nullptr && !poller_.is_sound(unit);
}

port::Instant AddressAssigner::used_at(UnitIndex unit) const {
  return std::max(poller_.counters(unit).answered_at, nodes_.released_heard_at(unit));
}

void AddressAssigner::choose(BusIndex bus, bool is_first, port::Instant now) {
  Job& job = jobs_[bus.value];
  const std::pair before{job.unit_used_at, job.unit_index};
  std::pair best{port::never, UnitIndex::none()};
  for (const UnitRange range : poller_.bus(bus).assign) {
    for (const ModbusAddress address : range) {
      const UnitIndex unit = poller_.unit_at(bus, address);
      const std::pair found{used_at(unit), unit};
      if (is_free(unit) && (is_first || found > before)) best = std::min(best, found);
    }
  }
  std::tie(job.unit_used_at, job.unit_index) = best;
  if (!job.unit_index.is_none()) {
    job.step = Step::look;
    job.tries = job.silences = 0;
    job.due = now;
    return;
  }
  if (!std::exchange(job.is_full, true)) {
    TextLine line;
    log_.write(port::Level::warning, line << "bus " << poller_.bus(bus).name
                                          << ": no unit is free for " << nodes_.called(job.serial)
                                          << ", which stays at 247; give more in `assign`");
  }
  end(job, now + settings_.absent_interval);
}

void AddressAssigner::give_up(Job& job, std::string_view why, port::Instant now) {
  if (std::exchange(job.unwilling, job.serial) != job.serial) {
    TextLine line;
    log_.write(port::Level::warning, line << nodes_.called(job.serial) << " did not take "
                                          << poller_.name(job.unit_index) << ": " << why
                                          << "; it stays at 247, and is asked to again");
  }
  end(job, now + settings_.absent_interval);
}

void AddressAssigner::end(Job& job, port::Instant retry_at) {
  job.last_serial = job.serial;
  job.retry_at = retry_at;
  job.step = Step::none;
  job.due = port::never;
}

}  // namespace etcm::firmware
