// Serials that this gateway and another one hear in two places: told once in the log, and listed as
// long as it is so.
#pragma once

#include <vector>

#include "etcm/port/log.h"
#include "firmware/fleet/fleet_clashes.h"
#include "firmware/polling/poller.h"
#include "firmware/publish/quarantine.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

class SerialClashes {
 public:
  // All must outlive it.
  SerialClashes(const NodeTable& nodes, const Poller& poller, port::Log& log)
      : nodes_(nodes), poller_(poller), log_(log) {}

  // Those that there are now, by serial and gateway.
  void take(std::vector<FleetClash> clashes);
  // Adds them to the list. The most there can be are twice clashes_max.
  void list(std::vector<QuarantineEntry>& quarantine) const;

 private:
  UnitIndex unit_of(Serial serial) const;
  void tell(const FleetClash& clash) const;

  const NodeTable& nodes_;
  const Poller& poller_;
  port::Log& log_;
  std::vector<FleetClash> clashes_;
};

}  // namespace etcm::firmware
