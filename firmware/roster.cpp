#include "roster.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

namespace {

// Nodes without a unit are few, and leave soon: a quarter of the units, and some.
constexpr std::uint32_t record_count(std::uint32_t unit_count) {
  return unit_count + unit_count / 4 + 16;
}

}  // namespace

Roster::Roster(std::uint32_t unit_count)
    : records_(record_count(unit_count)),
      by_unit_(unit_count, no_slot),
      released_heard_at_(unit_count) {
  by_serial_.reserve(records_.size());
  free_.reserve(records_.size());
  for (auto slot = static_cast<std::uint32_t>(records_.size()); slot-- > 0;) free_.push_back(slot);
}

NodeRecord* Roster::at(std::uint32_t unit) {
  return by_unit_[unit] == no_slot ? nullptr : &records_[by_unit_[unit]];
}

std::vector<Roster::Entry>::iterator Roster::lower_bound(std::uint32_t serial) {
  return std::lower_bound(
      by_serial_.begin(), by_serial_.end(), serial,
      [](const Entry& entry, std::uint32_t wanted) { return entry.serial < wanted; });
}

NodeRecord* Roster::find(std::uint32_t serial) {
  const auto found = lower_bound(serial);
  if (found == by_serial_.end() || found->serial != serial) return nullptr;
  return &records_[found->slot];
}

NodeRecord* Roster::add(std::uint32_t serial, port::Instant now) {
  if (free_.empty()) return nullptr;
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  by_serial_.insert(lower_bound(serial), {.serial = serial, .slot = slot});
  NodeRecord& node = records_[slot];
  node.serial = serial;
  node.known_since = node.heard_at = now;
  return &node;
}

void Roster::seat(NodeRecord& node, std::uint32_t unit) {
  if (NodeRecord* const before = at(unit); before != nullptr) before->unit = no_unit;
  if (node.unit != no_unit) by_unit_[node.unit] = no_slot;
  by_unit_[unit] = static_cast<std::uint32_t>(&node - records_.data());
  node.unit = unit;
}

void Roster::release(NodeRecord& node) {
  const auto entry = lower_bound(node.serial);
  free_.push_back(entry->slot);
  by_serial_.erase(entry);
  if (node.unit != no_unit) {
    by_unit_[node.unit] = no_slot;
    released_heard_at_[node.unit] = node.heard_at;
  }
  node = {};
}

}  // namespace etcm::firmware
