#include "firmware/gateway/serial_clashes.h"

#include <algorithm>
#include <utility>

#include "firmware/logging/text_line.h"

namespace etcm::firmware {

namespace {

bool is_same(const FleetClash& a, const FleetClash& b) {
  return a.serial == b.serial && a.gateway == b.gateway;
}

bool has_clash(const std::vector<FleetClash>& clashes, const FleetClash& wanted) {
  return std::any_of(clashes.begin(), clashes.end(),
                     [&](const FleetClash& each) { return is_same(each, wanted); });
}

}  // namespace

void SerialClashes::take(std::vector<FleetClash> clashes) {
  for (const FleetClash& clash : clashes) {
    if (!has_clash(clashes_, clash)) tell(clash);
  }
  for (const FleetClash& clash : clashes_) {
    if (has_clash(clashes, clash)) continue;
    log_.write(port::Level::info, TextLine() << "serial " << clash.serial.value
                                             << " is no longer heard in another place by gateway "
                                             << clash.gateway << " too");
  }
  clashes_ = std::move(clashes);
}

void SerialClashes::list(std::vector<QuarantineEntry>& quarantine) const {
  for (const FleetClash& clash : clashes_) {
    quarantine.push_back({.serial = clash.serial,
                          .unit_index = unit_of(clash.serial),
                          .position = clash.here,
                          .conflict = IdentityConflict::other_gateway,
                          .since = clash.since});
  }
}

// Where it answers here.
UnitIndex SerialClashes::unit_of(Serial serial) const {
  const NodeRecord* const node = nodes_.find(serial);
  return node == nullptr ? UnitIndex::none() : node->unit_index;
}

void SerialClashes::tell(const FleetClash& clash) const {
  const NodeRecord* const node = nodes_.find(clash.serial);
  const UnitIndex unit = unit_of(clash.serial);
  const bool is_first_in_mesh =
      clash.of.empty() ? node != nullptr && !node->is_foreign() : clash.is_owner;
  TextLine line;
  line << "two nodes with serial " << clash.serial.value << ": ";
  if (!clash.of.empty()) {
    line << "one that gateway " << clash.of << " hears at (";
  } else if (unit.is_none()) {
    line << "one here, at (";
  } else {
    line << poller_.name(unit) << ", at (";
  }
  line << clash.here.x << ", " << clash.here.y << "), and one that gateway " << clash.gateway
       << " hears at (" << clash.there.x << ", " << clash.there.y << "); the mesh has the "
       << (is_first_in_mesh ? "first" : "second") << "; give one of them a serial of its own";
  log_.write(port::Level::error, line);
}

}  // namespace etcm::firmware
