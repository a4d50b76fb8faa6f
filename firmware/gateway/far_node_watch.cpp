#include "firmware/gateway/far_node_watch.h"

#include <algorithm>
#include <utility>

#include "firmware/mesh/length_text.h"
#include "firmware/publish/far_nodes.h"

namespace etcm::firmware {

namespace {

const FarNode* find_in(std::span<const FarNode> nodes, Serial serial) {
  const auto found =
      std::lower_bound(nodes.begin(), nodes.end(), serial,
                       [](const FarNode& node, Serial wanted) { return node.serial < wanted; });
  return found == nodes.end() || found->serial != serial ? nullptr : &*found;
}

Position nearest_unit_of(const Point& point) {
  return {.x = static_cast<std::int32_t>(point.x / subunits_per_unit),
          .y = static_cast<std::int32_t>(point.y / subunits_per_unit)};
}

constexpr std::string_view cure_of_device =
    "correct 'order', 'scale' or 'format' in its profile, or exchange its longitude and latitude "
    "there (etcm-bus probe shows what each is); if it does stand there, acknowledge this";
constexpr std::string_view cure_of_node =
    "correct the place that it tells: a coordinate that is 0, two that are exchanged, or those of "
    "another coordinate system; if it does stand there, acknowledge this";
constexpr std::string_view cure_of_surveyed =
    "correct where its [[node]] or the site file says that it stands (longitude and latitude "
    "exchanged?); if it does stand there, acknowledge this";

}  // namespace

void FarNodeWatch::list(const Snapshot& snapshot, port::Instant now) {
  std::swap(far_, before_);
  far_.clear();
  if (snapshot.far_count == 0) return;
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    const SnapshotVertex& vertex = snapshot.vertices[row];
    if (vertex.far_from == FarFrom::nothing || !vertex.owner.is_none()) continue;
    far_.push_back({.serial = vertex.serial, .row = row, .since = now});
  }
  std::sort(far_.begin(), far_.end(),
            [](const FarNode& a, const FarNode& b) { return a.serial < b.serial; });
  for (FarNode& node : far_) {
    const FarNode* const known = find_in(before_, node.serial);
    if (known == nullptr) continue;
    node.since = known->since;
    node.is_told = known->is_told;
  }
}

void FarNodeWatch::look(const Snapshot& snapshot, const Settings& settings, port::Instant now) {
  if (snapshot.far_count == 0 && far_.empty()) return;
  list(snapshot, now);
  for (FarNode& node : far_) {
    if (now - node.since < settings.poll.stale_after || std::exchange(node.is_told, true)) continue;
    TextLine line;
    explain(node, snapshot, settings, line);
    log_.write(port::Level::warning, line << "; " << cure_of(node));
  }
  for (const FarNode& node : before_) {
    if (!node.is_told || find(node.serial) != nullptr) continue;
    TextLine line;
    log_.write(port::Level::info, line << nodes_.called(node.serial) << " is far off no longer");
  }
}

const FarNode* FarNodeWatch::find(Serial serial) const { return find_in(far_, serial); }

void FarNodeWatch::explain(const FarNode& node, const Snapshot& snapshot, const Settings& settings,
                           TextLine& text) const {
  const SnapshotVertex& vertex = snapshot.vertices[node.row];
  const SitePlane plane = settings.site.plane();
  text << nodes_.called(node.serial);
  const NodeRecord* const record = nodes_.find(node.serial);
  if (record != nullptr && !record->last_unit.is_none()) {
    text << ", " << poller_.name(record->last_unit).view() << ",";
  }
  text << " stands ";
  const Position place = nearest_unit_of(vertex.point);
  switch (vertex.far_from) {
    case FarFrom::nothing:
      return;
    case FarFrom::site:
      return write_distance(text, plane, snapshot.site_middle, place,
                            " from where the site is by its settings");
    case FarFrom::others: {
      const std::size_t before = text.view().size();
      write_distance(text, plane, snapshot.middle, place, " from the others");
      if (text.view().size() == before) text << "far from all others";
      return;
    }
    case FarFrom::another: {
      const SnapshotVertex& other = farthest_from(snapshot, vertex);
      write_distance(text, plane, nearest_unit_of(other.point), place, " from ");
      text << nodes_.called(other.serial) << ", farther than a site reaches: one of them is wrong";
      return;
    }
  }
}

std::string_view FarNodeWatch::cure_of(const FarNode& node) const {
  const NodeRecord* const record = nodes_.find(node.serial);
  if (record == nullptr || record->last_unit.is_none()) return cure_of_node;
  if (poller_.is_surveyed(record->last_unit)) return cure_of_surveyed;
  return poller_.is_node(record->last_unit) ? cure_of_node : cure_of_device;
}

}  // namespace etcm::firmware
