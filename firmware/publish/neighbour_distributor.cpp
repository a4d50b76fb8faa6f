#include "firmware/publish/neighbour_distributor.h"

#include <algorithm>

namespace etcm::firmware {

namespace {

constexpr std::uint8_t tries_max = 3;
// So many nodes are checked in one call: what else the loop does waits meanwhile.
constexpr std::uint32_t checks_max = 64;
// As many whole serials as one write can carry.
constexpr std::uint16_t neighbour_registers_max = port::write_registers_max / 2 * 2;

// The codes of a node that has no such function or registers.
constexpr std::uint8_t illegal_function = 1;
constexpr std::uint8_t illegal_address = 2;

// Different for different lists, as good as always.
std::uint64_t fingerprint_of(std::span<const Serial> serials) {
  std::uint64_t value = 0x9e3779b97f4a7c15u + serials.size();
  for (const Serial serial : serials) {
    value = (value ^ serial.value) * 0xbf58476d1ce4e5b9u;
    value ^= value >> 29;
  }
  return value;
}

}  // namespace

NeighbourDistributor::NeighbourDistributor(const Settings& settings, const Poller& poller,
                                           const NodeTable& nodes, const Snapshot& snapshot,
                                           port::Log& log)
    : settings_(settings.poll),
      poller_(poller),
      nodes_(nodes),
      snapshot_(snapshot),
      log_(log),
      neighbours_(settings.write_back.is_enabled ? settings.mesh.vertices_max : 0),
      delivered_(settings.write_back.is_enabled ? nodes.records().size() : 0),
      jobs_(settings.write_back.is_enabled ? poller.bus_count() : 0) {}

void NeighbourDistributor::update_settings(const PollSettings& settings) {
  settings_ = settings;
  if (jobs_.empty()) return;
  delivered_.resize(nodes_.records().size());
  jobs_.resize(poller_.bus_count());
}

void NeighbourDistributor::take_snapshot() {
  const auto records = nodes_.records();
  for (std::uint32_t slot = 0; slot < delivered_.size(); ++slot) {
    const NodeRecord& node = records[slot];
    delivered_[slot].row = node.is_placed() ? node.vertex.value - 1u : no_row;
  }
  invalidate();
}

void NeighbourDistributor::invalidate() {
  for (Job& job : jobs_) job.unchecked = static_cast<std::uint32_t>(delivered_.size());
}

port::Instant NeighbourDistributor::due(BusIndex bus) const {
  if (jobs_.empty()) return port::never;
  const Job& job = jobs_[bus.value];
  return job.slot != no_slot || job.unchecked > 0 ? port::Instant{} : job.retry_at;
}

bool NeighbourDistributor::next(BusIndex bus, port::Instant now, BusRequest& request) {
  if (jobs_.empty()) return false;
  Job& job = jobs_[bus.value];
  if (job.slot != no_slot && !is_same(job, bus)) {
    job.slot = no_slot;
    job.unchecked = static_cast<std::uint32_t>(delivered_.size());
  }
  if (job.slot != no_slot) {
    request = next_part(job);
    return true;
  }
  if (job.unchecked == 0) {
    if (job.retry_at > now) return false;
    job.unchecked = static_cast<std::uint32_t>(delivered_.size());
  }
  if (job.unchecked == delivered_.size()) job.retry_at = port::never;
  const auto records = nodes_.records();
  for (std::uint32_t checks = 0; checks < checks_max && job.unchecked > 0; ++checks) {
    const std::uint32_t slot = job.cursor;
    job.cursor = (job.cursor + 1) % static_cast<std::uint32_t>(delivered_.size());
    --job.unchecked;
    const NodeRecord& node = records[slot];
    if (!node.is_known() || node.unit_index.is_none() || poller_.bus_of(node.unit_index) != bus ||
        !poller_.is_node(node.unit_index) || shares_unit(node.unit_index)) {
      continue;
    }
    DeliveredConfig& told = delivered_[slot];
    if (!needs_write(node, told, job, now)) continue;
    job.slot = slot;
    fill(job, bus, told);
    request = next_part(job);
    return true;
  }
  return false;
}

// Any number may wait there for a unit of their own, and each would take what is meant for one.
bool NeighbourDistributor::shares_unit(UnitIndex unit) const {
  return poller_.address_of(unit) == default_unit &&
         !poller_.bus(poller_.bus_of(unit)).assign.empty();
}

// Whether the node is to be written now.
bool NeighbourDistributor::needs_write(const NodeRecord& node, DeliveredConfig& told, Job& job,
                                       port::Instant now) {
  if (told.serial != node.serial || told.boot_count != node.boot_count) {
    // A node that is not in the snapshot with this slot has it since then.
    const bool is_in_snapshot =
        told.row != no_row && snapshot_.vertices[told.row].serial == node.serial;
    told = {.serial = node.serial,
            .row = is_in_snapshot ? told.row : no_row,
            .boot_count = node.boot_count};
  }
  if (told.is_rejected) return false;
  list_ = {};
  if (told.row != no_row) {
    list_ = neighbours_.of(snapshot_, told.row);
  } else if (!told.is_written) {
    return false;  // it has never had any
  }
  const std::uint64_t fingerprint = fingerprint_of(list_);
  if (told.is_written && told.fingerprint == fingerprint) return false;
  if (told.tries > 0 && told.tried == fingerprint) {
    if (told.tries >= tries_max) return false;
    if (now < told.retry_at) {
      job.retry_at = std::min(job.retry_at, told.retry_at);
      return false;
    }
  } else {
    told.tries = 0;
  }
  if ((node.stale && !node.lacks_fix) || !poller_.is_sound(node.unit_index)) {
    job.retry_at = std::min(job.retry_at, now + settings_.interval);
    return false;
  }
  // What it says of an earlier write must not be taken for what it says of this one.
  if (const port::Instant free_at = poller_.write_free_at(node.unit_index); free_at > now) {
    job.retry_at = std::min(job.retry_at, free_at);
    return false;
  }
  told.tried = job.fingerprint = fingerprint;
  return true;
}

// Whether the node under way is still the one it was, and on this bus: it may have left, booted or
// gone elsewhere meanwhile.
bool NeighbourDistributor::is_same(const Job& job, BusIndex bus) const {
  const NodeRecord& node = nodes_.records()[job.slot];
  const DeliveredConfig& told = delivered_[job.slot];
  return node.serial == told.serial && node.boot_count == told.boot_count &&
         !node.unit_index.is_none() && poller_.bus_of(node.unit_index) == bus;
}

void NeighbourDistributor::fill(Job& job, BusIndex bus, const DeliveredConfig& told) const {
  const std::size_t count = std::min<std::size_t>(list_.size(), configuration_neighbours_max);
  job.count = static_cast<std::uint16_t>(encode_configuration(
      snapshot_.generation, list_.first(count), poller_.bus(bus).word_order, job.registers));
  job.written = 0;
  // On a serial line a late answer must not be taken for one to the next try: that has other
  // ranges.
  job.is_split = job.count > port::write_registers_max || told.tries % 2 == 1;
}

BusRequest NeighbourDistributor::next_part(Job& job) const {
  const NodeRecord& node = nodes_.records()[job.slot];
  const auto registers = std::span<const std::uint16_t>(job.registers).first(job.count);
  BusRequest request{.address = poller_.address_of(node.unit_index), .values = {}};
  const auto neighbours_end = static_cast<std::uint16_t>(job.count - configuration_head_count);
  if (!job.is_split) {
    request.first = configuration_register_first;
    request.values = registers;
  } else if (job.written < neighbours_end) {
    const auto begin = static_cast<std::uint16_t>(configuration_head_count + job.written);
    const std::size_t part =
        std::min<std::size_t>(neighbour_registers_max, neighbours_end - job.written);
    request.first = static_cast<std::uint16_t>(configuration_register_first + begin);
    request.values = registers.subspan(begin, part);
  } else {
    request.first = configuration_register_first;
    request.values = registers.first(configuration_head_count);
  }
  job.written = static_cast<std::uint16_t>(job.written + request.values.size());
  return request;
}

void NeighbourDistributor::done(BusIndex bus, const port::BusAnswer& answer, port::Instant now) {
  Job& job = jobs_[bus.value];
  DeliveredConfig& told = delivered_[job.slot];
  if (!is_same(job, bus) || answer.result == port::BusResult::link_lost) {
    job.slot = no_slot;
    job.retry_at = std::min(job.retry_at, now + settings_.interval);
    return;
  }
  if (answer.result != port::BusResult::ok) {
    job.slot = no_slot;
    fail(told, answer, now);
    if (told.tries < tries_max && !told.is_rejected) {
      job.retry_at = std::min(job.retry_at, told.retry_at);
    }
    return;
  }
  if (job.written < job.count) return;
  told.is_written = true;
  told.fingerprint = job.fingerprint;
  told.tries = 0;
  job.slot = no_slot;
}

void NeighbourDistributor::fail(DeliveredConfig& told, const port::BusAnswer& answer,
                                port::Instant now) {
  if (answer.result == port::BusResult::exception &&
      (answer.exception == illegal_function || answer.exception == illegal_address)) {
    told.is_rejected = true;
    TextLine line;
    log_.write(port::Level::info, line << nodes_.called(told.serial)
                                       << " has no registers for its neighbours: exception "
                                       << answer.exception << "; it is not written until it boots");
    return;
  }
  ++told.tries;
  told.retry_at = now + settings_.absent_interval;
  if (told.tries == tries_max) {
    TextLine line;
    log_.write(port::Level::warning,
               line << nodes_.called(told.serial) << " was not told its neighbours: "
                    << to_string(answer.result) << ", three times; tried again when they change");
  }
}

}  // namespace etcm::firmware
