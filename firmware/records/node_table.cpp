#include "firmware/records/node_table.h"

#include <algorithm>
#include <array>
#include <utility>

namespace etcm::firmware {

std::uint32_t count_units(const Settings& settings) {
  std::uint32_t count = 0;
  for (const BusSettings& bus : settings.buses) {
    std::array<bool, 256> is_unit{};
    for (const std::vector<UnitRange>* const ranges : {&bus.units, &bus.assign, &bus.scan}) {
      for (const UnitRange range : *ranges) {
        for (const ModbusAddress address : range) is_unit[address.value] = true;
      }
    }
    if (!bus.assign.empty()) is_unit[default_unit.value] = true;
    count += static_cast<std::uint32_t>(std::count(is_unit.begin(), is_unit.end(), true));
  }
  return count;
}

NodeTable::NodeTable(std::uint32_t unit_count)
    : records_(roster_capacity(unit_count)),
      by_unit_(unit_count, no_slot),
      released_heard_at_(unit_count) {
  by_serial_.reserve(records_.size());
  free_.reserve(records_.size());
  for (auto slot = static_cast<std::uint32_t>(records_.size()); slot-- > 0;) free_.push_back(slot);
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
