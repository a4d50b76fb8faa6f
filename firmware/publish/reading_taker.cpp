#include "firmware/publish/reading_taker.h"

#include <algorithm>
#include <tuple>

namespace etcm::firmware {

namespace {

std::uint32_t row_of(const NodeRecord& node, const Snapshot& mesh) {
  if (!node.is_placed()) return no_row;
  // It may have joined since then.
  const std::uint32_t row = node.vertex.value - 1u;
  const bool is_there = row < mesh.vertices.size() && mesh.vertices[row].kind == VertexKind::node &&
                        mesh.vertices[row].serial == node.serial;
  return is_there ? row : no_row;
}

}  // namespace

ReadingSnapshot& ReadingTaker::take(ReadingTable& table, ForeignReadings& foreign,
                                    const NodeTable& nodes, const Snapshot& mesh,
                                    port::Instant now) {
  const std::size_t count_before = snapshot_.readings.size();
  snapshot_.readings.clear();
  for (const ReadingRecord& record : table.records()) {
    if (record.serial.is_none()) continue;
    const NodeRecord* const node = nodes.find(record.serial);
    if (node == nullptr || node->last_unit != record.unit_index) continue;
    snapshot_.readings.push_back({.serial = record.serial,
                                  .unit_index = record.unit_index,
                                  .quantity = record.quantity,
                                  .definition = record.definition,
                                  .row = row_of(*node, mesh),
                                  .nano = record.nano,
                                  .taken_at = record.taken_at,
                                  .is_stale = record.is_stale || node->is_missing});
  }
  add_foreign(foreign, nodes, mesh);
  std::sort(snapshot_.readings.begin(), snapshot_.readings.end(),
            [](const PublishedReading& a, const PublishedReading& b) {
              return std::tie(a.serial, a.quantity) < std::tie(b.serial, b.quantity);
            });
  ++snapshot_.sequence;
  // Another generation may have nodes in other rows, and a node that was dismissed has gone.
  if (table.has_other_values() || foreign.has_news() || snapshot_.generation != mesh.generation ||
      snapshot_.readings.size() != count_before) {
    snapshot_.value_sequence = snapshot_.sequence;
  }
  snapshot_.generation = mesh.generation;
  snapshot_.taken_at = now;
  table.clear_news();
  foreign.clear_news();
  return snapshot_;
}

// In the quantities of this gateway where it has the same.
void ReadingTaker::add_foreign(const ForeignReadings& foreign, const NodeTable& nodes,
                               const Snapshot& mesh) {
  std::vector<QuantityIndex>& numbers = foreign_numbers_;
  numbers.clear();
  for (const Quantity& quantity : foreign.quantities()) {
    numbers.push_back(number_of(snapshot_, quantity));
  }
  for (const auto& [serial, told] : foreign.nodes()) {
    const NodeRecord* const node = nodes.find(serial);
    if (node == nullptr || !node->is_foreign()) continue;
    for (const ForeignReadings::Reading& reading : told.readings) {
      snapshot_.readings.push_back({.serial = serial,
                                    .unit_index = {},
                                    .quantity = numbers[reading.quantity],
                                    .row = row_of(*node, mesh),
                                    .nano = reading.nano,
                                    .taken_at = told.taken_at,
                                    .is_stale = told.is_stale || node->is_missing});
    }
  }
}

}  // namespace etcm::firmware
