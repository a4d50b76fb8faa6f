// Units that the settings name one by one, by [[bus.device]] or [[node]], and that nobody has
// answered at since the start. Who is known from an earlier run is missing instead (presence.h);
// the other `units` of a bus may be there or not.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "etcm/types.h"
#include "firmware/config/settings.h"
#include "firmware/nodes/presence.h"
#include "firmware/polling/poller.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

// What to do about one.
inline constexpr std::string_view absent_cure =
    "look at its supply, its cable, its address and its profile; if it is not to be there, take it "
    "out of the settings";

// The settings name it, by [[bus.device]], [[node]] or a name.
bool is_named(const Settings& settings, const Poller& poller, UnitIndex unit);

struct AbsentUnit {
  UnitIndex unit{};
  Serial serial{};                     // that its node would have, unless it tells one
  std::optional<Position> position{};  // where it was surveyed
  port::Instant since{};               // when it was first asked for; the origin: at the start
  const char* what() const {
    return since == port::Instant{} ? " has not answered since the start"
                                    : " has not answered since a reload has added it";
  }
  friend bool operator==(const AbsentUnit&, const AbsentUnit&) = default;
};

class AbsentUnits {
 public:
  // Finds them, and tells the log of each once; false: they are those of the last look. None is
  // absent before leave_after has passed from the first look that there is such a unit, nor on a
  // silent bus: there it is the bus that wants looking at. O(u log u) for u units that are named.
  bool look(const Settings& settings, const Poller& poller, const Presence& presence,
            const NodeTable& nodes, port::Log& log, port::Instant now);

  // By unit.
  std::span<const AbsentUnit> list() const { return absent_; }

 private:
  void look_at_unit(const Settings& settings, const Poller& poller, const NodeTable& nodes,
                    BusIndex bus, std::uint32_t address, port::Instant now);
  void tell(const Poller& poller, port::Log& log);

  std::vector<AbsentUnit> absent_;
  std::vector<AbsentUnit> before_;
  std::vector<UnitIndex> told_;  // in order
  // When each unit was there first: those of the start first, then those that a reload has added.
  std::vector<port::Instant> since_;
};

}  // namespace etcm::firmware
