// A site that gets another plane: devices stand where they did, and say so themselves only once
// they answer. A node of our own counts in units of the mesh, whatever the plane.
#pragma once

#include <cstdint>
#include <optional>

#include "etcm/port/log.h"
#include "firmware/config/settings.h"
#include "firmware/mesh/node_placement.h"
#include "firmware/persist/saved_state.h"
#include "firmware/polling/device.h"
#include "firmware/polling/poller.h"
#include "firmware/records/node_table.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

// What stands there in one plane, in the other one: the nearest unit. Where one of them does not
// say where on the earth it is, both count from the same place. None where the other one does not
// reach so far.
std::optional<Position> position_in(const SitePlane& to, const SitePlane& from, Position place);

// Which units are devices, by the settings of now.
struct AskedDevices {
  const DeviceTable& devices;
  const Poller& poller;
};

// Moves them in the mesh; who has no place in the new plane is not in it until it answers. Does
// nothing where the plane is the same.
void follow_plane(const SiteSettings& to, const SiteSettings& from, const AskedDevices& asked,
                  NodeTable& nodes, NodePlacement& placement, std::uint32_t generation,
                  port::Log& log);

// Moves them in what was saved; those that have no place in the new plane are left out, and the log
// tells how many; of who is missing only the position. What else the mesh had is left out then: it
// is made anew. Where nobody knows that plane any more, as without `projections`, none has a place.
// False where the plane is the same, or was not saved: then it does nothing.
[[nodiscard]] bool follow_plane(const SiteSettings& to, port::ProjectionSource* projections,
                                const AskedDevices& asked, SavedState& saved, port::Log& log);

}  // namespace etcm::firmware
