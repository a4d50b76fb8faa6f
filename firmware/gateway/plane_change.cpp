#include "firmware/gateway/plane_change.h"

#include <string>
#include <vector>

#include "firmware/config/shared_site.h"
#include "firmware/logging/counted.h"

namespace etcm::firmware {

namespace {

bool is_device(const AskedDevices& asked, UnitIndex unit) {
  if (unit.is_none()) return false;
  return asked.devices.at(asked.poller.bus_of(unit), asked.poller.address_of(unit)) != nullptr;
}

bool is_device(const AskedDevices& asked, const SavedState& saved, const SavedNode& node) {
  if (node.bus == no_saved_bus) return false;
  for (BusIndex bus{0}; bus.value < asked.poller.bus_count(); ++bus.value) {
    if (saved_bus_name(asked.poller.bus(bus).name) != saved.buses[node.bus]) continue;
    return asked.devices.at(bus, ModbusAddress{node.address}) != nullptr;
  }
  return false;
}

}  // namespace

std::optional<Position> position_in(const SitePlane& to, const SitePlane& from, Position place) {
  if (to.projection != nullptr && from.projection != nullptr) {
    const std::optional<port::EarthPoint> earth = earth_point(from, to_point(place));
    return earth ? nearest_position(to, *earth) : std::nullopt;
  }
  std::int64_t x = 0;
  std::int64_t y = 0;
  const bool is_beyond = __builtin_mul_overflow(std::int64_t{place.x}, from.unit_length, &x) ||
                         __builtin_add_overflow(x, from.origin_x, &x) ||
                         __builtin_mul_overflow(std::int64_t{place.y}, from.unit_length, &y) ||
                         __builtin_add_overflow(y, from.origin_y, &y);
  return is_beyond ? std::nullopt : nearest_position(to, x, y);
}

void follow_plane(const SiteSettings& to, const SiteSettings& from, const AskedDevices& asked,
                  NodeTable& nodes, NodePlacement& placement, std::uint32_t generation,
                  port::Log& log) {
  if (plane_of(to) == plane_of(from)) return;
  std::vector<NodeRecord*> moved;
  for (NodeRecord& node : nodes.records()) {
    // What another gateway hears, that one tells.
    if (!node.is_known() || node.is_foreign() || !node.has_position()) continue;
    if (!is_device(asked, node.is_missing ? node.last_unit : node.unit_index)) continue;
    if (const auto place = position_in(to.plane(), from.plane(), node.position)) {
      node.position = *place;
      moved.push_back(&node);
      continue;
    }
    node.positioned_at = {};
    if (node.is_placed()) placement.leave(node, "beyond the plane of the site", generation);
  }
  // Else what follows would read as if they had been carried away.
  if (!moved.empty()) {
    log.write(port::Level::info,
              "the site has another plane: " +
                  to_string(Counted{moved.size(), "device stands", "devices stand"}) +
                  " where before, which is another place in units of the mesh");
  }
  // All places are known by now, so that who is displaced by another one goes where it belongs.
  for (NodeRecord* const node : moved) {
    if (node->is_placed()) {
      placement.move(*node, generation);
    } else if (node->is_quarantined()) {
      placement.join(*node, generation);
    }
  }
}

std::size_t follow_plane(const SitePlane& to, const SitePlane* from, const AskedDevices& asked,
                         SavedState& saved) {
  const auto loses_place = [&](SavedNode& node) {
    const auto place = from != nullptr ? position_in(to, *from, node.position) : std::nullopt;
    node.position = place.value_or(Position{});
    return !place;
  };
  for (SavedMissing& each : saved.missing) {
    if (!each.has_position || !is_device(asked, saved, each.node)) continue;
    each.has_position = !loses_place(each.node);
  }
  bool has_devices = false;
  const std::size_t left_out = std::erase_if(saved.nodes, [&](SavedNode& node) {
    if (!is_device(asked, saved, node)) return false;
    has_devices = true;
    return loses_place(node);
  });
  if (!has_devices) return 0;
  saved.anchors.clear();
  saved.features.clear();
  saved.steiner.clear();
  saved.is_canonical = true;
  return left_out;
}

}  // namespace etcm::firmware
