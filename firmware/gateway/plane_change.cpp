#include "firmware/gateway/plane_change.h"

#include <string>
#include <vector>

#include "firmware/config/shared_site.h"
#include "firmware/logging/counted.h"
#include "firmware/persist/saved_unit.h"

namespace etcm::firmware {

namespace {

bool is_device(const AskedDevices& asked, UnitIndex unit) {
  if (unit.is_none()) return false;
  return asked.devices.at(asked.poller.bus_of(unit), asked.poller.address_of(unit)) != nullptr;
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
  const SitePlane plane = to.plane(), before = from.plane();
  std::vector<NodeRecord*> moved;
  for (NodeRecord& node : nodes.records()) {
    // What another gateway hears, that one tells. Whose place the broker has told has not said it.
    const bool has_place = node.has_position() || node.is_placed() || node.is_quarantined();
    if (!node.is_known() || node.is_foreign() || !has_place) continue;
    if (!is_device(asked, node.last_unit)) continue;
    if (const auto place = position_in(plane, before, node.position)) {
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

bool follow_plane(const SiteSettings& to, port::ProjectionSource* projections,
                  const AskedDevices& asked, SavedState& saved, port::Log& log) {
  if (!saved.plane || *saved.plane == plane_of(to)) return false;
  std::string why;
  const SitePlane plane = to.plane();
  const std::optional<SitePlane> before = site_plane_of(*saved.plane, projections, why);
  const auto is_saved_device = [&](const SavedNode& node) {
    return is_device(asked, saved_unit(asked.poller, saved, node));
  };
  const auto loses_place = [&](SavedNode& node) {
    const auto place = before ? position_in(plane, *before, node.position) : std::nullopt;
    node.position = place.value_or(Position{});
    return !place;
  };
  for (SavedMissing& each : saved.missing) {
    if (!each.has_position || !is_saved_device(each.node)) continue;
    each.has_position = !loses_place(each.node);
  }
  bool has_devices = false;
  const std::size_t left_out = std::erase_if(saved.nodes, [&](SavedNode& node) {
    if (!is_saved_device(node)) return false;
    has_devices = true;
    return loses_place(node);
  });
  if (!has_devices) return true;
  saved.anchors.clear();
  saved.features.clear();
  saved.steiner.clear();
  saved.is_canonical = true;
  if (left_out == 0) return true;
  log.write(port::Level::warning,
            to_string(Counted{left_out, "device has", "devices have"}) +
                " no place in the plane of the site until heard" +
                (before ? "" : ": the plane of before cannot be had: " + why));
  return true;
}

}  // namespace etcm::firmware
