#include "firmware/fleet/merged_set.h"

#include <utility>

#include "firmware/fleet/fleet_hash.h"

namespace etcm::firmware {

void MergedSet::add(const MergedNode& node) {
  const FleetRecord& record = *node.record;
  if (record.has_left()) return;
  ++count_;
  record_hash_ += node.record_hash;
  if (record.node.position) hash_ += place_hash(record.node.serial, *record.node.position);
}

void MergedSet::subtract(const MergedNode& node) {
  const FleetRecord& record = *node.record;
  if (record.has_left()) return;
  --count_;
  record_hash_ -= node.record_hash;
  if (record.node.position) hash_ -= place_hash(record.node.serial, *record.node.position);
}

void MergedSet::set(MergedNode& node, std::shared_ptr<const FleetRecord> record,
                    port::Instant now) {
  if (node.record) subtract(node);
  node.record = std::move(record);
  node.record_hash = firmware::record_hash(*node.record);
  add(node);
  node.received_at = now;
  node.uncovered_since = node.needless_since = port::never;
}

MergedSet::Offered MergedSet::offer(std::shared_ptr<const FleetRecord> record, port::Instant now) {
  const Serial serial = record->node.serial;
  const auto at = nodes_.find(serial);
  if (at == nodes_.end()) {
    const bool is_full =
        record->has_left() ? nodes_.size() - count_ >= nodes_max_ : count_ >= nodes_max_;
    if (is_full) return Offered::no_room;
    set(nodes_[serial], std::move(record), now);
    return Offered::newer;
  }
  const auto order = compare(*record, *at->second.record);
  if (order < 0) return Offered::older;
  if (order == 0) {
    at->second.record = std::move(record);
    return Offered::same;
  }
  set(at->second, std::move(record), now);
  return Offered::newer;
}

void MergedSet::amend(std::shared_ptr<const FleetRecord> record, port::Instant now) {
  MergedNode& node = nodes_[record->node.serial];
  set(node, std::move(record), now);
}

MergedSet::Nodes::iterator MergedSet::forget(Nodes::iterator at) {
  subtract(at->second);
  return nodes_.erase(at);
}

MergedNode* MergedSet::find(Serial serial) {
  const auto at = nodes_.find(serial);
  return at == nodes_.end() ? nullptr : &at->second;
}

const MergedNode* MergedSet::find(Serial serial) const {
  const auto at = nodes_.find(serial);
  return at == nodes_.end() ? nullptr : &at->second;
}

}  // namespace etcm::firmware
