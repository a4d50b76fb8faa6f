#include "firmware/records/node_table.h"

#include <algorithm>
#include <utility>

namespace etcm::firmware {

NodeTable::NodeTable(std::uint32_t unit_count, std::uint32_t unit_room, std::uint32_t foreign_room)
    : foreign_room_(foreign_room) {
  const std::uint32_t room = std::max(unit_count, unit_room);
  const std::uint32_t capacity = node_record_capacity(room) + foreign_room;
  records_.reserve(capacity);
  by_serial_.reserve(capacity);
  free_.reserve(capacity);
  by_unit_.reserve(room);
  released_heard_at_.reserve(room);
  add_units(unit_count);
}

void NodeTable::add_units(std::uint32_t unit_count) {
  const std::size_t before = records_.size();
  records_.resize(node_record_capacity(unit_count) + foreign_room_);
  for (std::size_t slot = records_.size(); slot-- > before;) {
    free_.push_back(static_cast<std::uint32_t>(slot));
  }
  by_unit_.resize(unit_count, no_slot);
  released_heard_at_.resize(unit_count);
}

NodeRecord* NodeTable::at(UnitIndex unit) {
  return by_unit_[unit.value] == no_slot ? nullptr : &records_[by_unit_[unit.value]];
}

const NodeRecord* NodeTable::at(UnitIndex unit) const {
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

NameIndex NodeTable::name_of(const NodeRecord& node) const {
  const UnitIndex own = node.unit_index.is_none() ? node.last_unit : node.unit_index;
  return names_->find(node.serial, node.is_foreign() ? UnitIndex::none() : own);
}

CalledNode NodeTable::called(const NodeRecord& node) const {
  return {.serial = node.serial, .name = names_->text(name_of(node))};
}

CalledNode NodeTable::called(Serial serial) const {
  const NodeRecord* const node = find(serial);
  if (node != nullptr) return called(*node);
  return {.serial = serial, .name = names_->text(names_->find(serial, UnitIndex::none()))};
}

}  // namespace etcm::firmware
