#include "firmware/records/node_table.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

NodeTable::NodeTable(std::uint32_t unit_count, std::uint32_t unit_room) {
  const std::uint32_t room = std::max(unit_count, unit_room);
  records_.reserve(roster_capacity(room));
  by_serial_.reserve(roster_capacity(room));
  free_.reserve(roster_capacity(room));
  by_unit_.reserve(room);
  released_heard_at_.reserve(room);
  add_units(unit_count);
}

void NodeTable::add_units(std::uint32_t unit_count) {
  const std::size_t before = records_.size();
  records_.resize(roster_capacity(unit_count));
  for (std::size_t slot = records_.size(); slot-- > before;) {
    free_.push_back(static_cast<std::uint32_t>(slot));
  }
  by_unit_.resize(unit_count, no_slot);
  released_heard_at_.resize(unit_count);
}

NodeRecord* NodeTable::at(UnitIndex unit) {
  return by_unit_[unit.value] == no_slot ? nullptr : &records_[by_unit_[unit.value]];
}

std::vector<NodeTable::Entry>::const_iterator NodeTable::lower_bound(Serial serial) const {
  return std::lower_bound(by_serial_.begin(), by_serial_.end(), serial,
                          [](const Entry& entry, Serial wanted) { return entry.serial < wanted; });
}

NodeRecord* NodeTable::find(Serial serial) {
  const auto found = lower_bound(serial);
  if (found == by_serial_.end() || found->serial != serial) return nullptr;
  return &records_[found->slot];
}

const NodeRecord* NodeTable::find(Serial serial) const {
  const auto found = lower_bound(serial);
  if (found == by_serial_.end() || found->serial != serial) return nullptr;
  return &records_[found->slot];
}

NodeRecord* NodeTable::add(Serial serial, port::Instant now) {
  if (free_.empty()) return nullptr;
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  by_serial_.insert(lower_bound(serial), {.serial = serial, .slot = slot});
  NodeRecord& node = records_[slot];
  node.serial = serial;
  node.known_since = node.heard_at = now;
  return &node;
}

void NodeTable::assign_unit(NodeRecord& node, UnitIndex unit) {
  if (NodeRecord* const before = at(unit); before != nullptr)
    before->unit_index = UnitIndex::none();
  if (!node.unit_index.is_none()) by_unit_[node.unit_index.value] = no_slot;
  by_unit_[unit.value] = static_cast<std::uint32_t>(&node - records_.data());
  node.unit_index = node.last_unit = unit;
}

void NodeTable::vacate(NodeRecord& node) {
  if (node.unit_index.is_none()) return;
  by_unit_[node.unit_index.value] = no_slot;
  released_heard_at_[node.unit_index.value] = node.heard_at;
  node.unit_index = UnitIndex::none();
}

void NodeTable::release(NodeRecord& node) {
  const auto entry = lower_bound(node.serial);
  free_.push_back(entry->slot);
  by_serial_.erase(entry);
  vacate(node);
  node = {};
}

}  // namespace etcm::firmware
