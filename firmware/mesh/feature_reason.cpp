#include "firmware/mesh/feature_reason.h"

#include <algorithm>
#include <string_view>

#include "firmware/mesh/length_text.h"
#include "firmware/mesh/place_text.h"

namespace etcm::firmware {

namespace {

// The page leads there.
constexpr std::string_view more = "; how: /guide/site.html#where-lines-meet";

// Lines of the site file end where this [[feature]] does, at both of its ends.
bool is_drawn_too(const FeatureSettings& listed, std::span<const FeatureRecord> features) {
  const auto is_end = [features](const FeatureEnd& end) {
    return std::any_of(features.begin(), features.end(), [&end](const FeatureRecord& each) {
      return is_drawn(each.settings) && ends_at(each.settings, end);
    });
  };
  return is_end(listed.from) && is_end(listed.to);
}

// Null: no node is in the mesh.
const NodeRecord* nearest_node(const NodeTable& nodes, Position place) {
  const NodeRecord* nearest = nullptr;
  for (const NodeRecord& node : nodes.records()) {
    if (!node.is_placed()) continue;
    const bool is_nearer = nearest == nullptr || squared_distance(node.placed, place) <
                                                     squared_distance(nearest->placed, place);
    if (is_nearer) nearest = &node;
  }
  return nearest;
}

// Of two [[feature]], which meet at nodes alone.
void write_cure_of_listed(TextLine& cure, const FeatureSettings& feature,
                          const PlacedFeature& other, const NodeRecord* near,
                          const CalledNode& called, const TextLine& far) {
  if (near != nullptr && ends_at(feature, near->serial)) {
    cure << "let " << other << " run over " << called
         << ", where this one ends, as two [[feature]]";
  } else if (near != nullptr && ends_at(other.settings, near->serial)) {
    cure << "let it run over " << called << ", where "
         << CalledFeature{other.number, other.settings.name} << " ends, as two [[feature]]";
  } else {
    cure << "let both end at a node that is near there";
    if (near != nullptr) cure << " (" << far.view() << called << ")";
    cure << ", each as two [[feature]]";
  }
  cure
      << ", or draw both in a site file with a vertex there and take both [[feature]] out, or take "
         "one out";
}

// Of a line of the site file and a [[feature]] that are in each other's way. Most often somebody
// has drawn the [[feature]] and left it where it was: to change the drawing would lead in a circle.
void write_cure_of_drawn(TextLine& cure, Status status, const FeatureSettings& listed,
                         std::span<const FeatureRecord> features) {
  cure << "take the [[feature]] of " << listed.source << " out";
  const bool is_along = status != Status::crossing_features;
  if (is_along && is_drawn_too(listed, features)) {
    cure << ", the site file has its line already";
  } else if (is_along) {
    cure
        << " where the site file has its line already; else let one begin where the other one ends";
  } else {
    cure << " where the site file has its line already; else draw it there, give both lines a "
            "vertex at that place, and take the [[feature]] out";
  }
}

}  // namespace

std::optional<FeatureReason> reason_of(const FeatureSettings& feature, Status status,
                                       const std::optional<Blocker>& blocker,
                                       std::span<const FeatureRecord> features,
                                       const NodeTable& nodes, const SitePlane& plane) {
  if (!blocker || blocker->number >= features.size()) return std::nullopt;
  const FeatureSettings& other = features[blocker->number].settings;
  const PlacedFeature named{blocker->number + 1, other};
  FeatureReason reason;
  switch (status) {
    case Status::repeated_feature:
      reason.what << "it has the same ends as " << named;
      reason.cure << "take one of the two out";
      break;
    case Status::overlapping_features:
      reason.what << "it runs along a part of " << named;
      reason.cure << "let it begin where the other one ends, or take one of the two out";
      break;
    case Status::crossing_features:
      reason.what << "it crosses " << named;
      if (blocker->near) write_site_place(reason.what << " at ", plane, *blocker->near);
      if (is_drawn(feature)) {
        reason.cure << "in the site file give both lines a vertex there, at the same coordinates, "
                       "or let one end there, or take one out";
      } else {
        const NodeRecord* const near =
            blocker->near ? nearest_node(nodes, *blocker->near) : nullptr;
        TextLine far;
        if (near != nullptr) write_distance(far, plane, *blocker->near, near->placed, ": ");
        const CalledNode called = near != nullptr ? nodes.called(*near) : CalledNode{};
        write_cure_of_listed(reason.cure, feature, named, near, called, far);
      }
      break;
    default:
      return std::nullopt;
  }
  if (is_drawn(feature) != is_drawn(other)) {
    reason.cure = {};
    write_cure_of_drawn(reason.cure, status, is_drawn(feature) ? other : feature, features);
  }
  reason.cure << more;
  return reason;
}

std::optional<FeatureReason> reason_of(std::uint32_t number,
                                       std::span<const FeatureRecord> features,
                                       const NodeTable& nodes, const SitePlane& plane) {
  const FeatureRecord& feature = features[number];
  return reason_of(feature.settings, feature.rejection, feature.blocker, features, nodes, plane);
}

}  // namespace etcm::firmware
