#include "firmware/mesh/feature_reason.h"

#include <string_view>

#include "firmware/mesh/place_text.h"

namespace etcm::firmware {

namespace {

// The page leads there.
constexpr std::string_view more = "; how: /guide/site.html#where-lines-meet";

// Drawn in a site file, where a line may have vertices that are no nodes; else by [[feature]].
bool is_drawn(const FeatureSettings& feature) {
  const std::string_view source = feature.source;
  const std::string_view file = source.substr(0, source.rfind(':'));
  return file.ends_with(".geojson") || file.ends_with(".json") || file.ends_with(".poly") ||
         file.ends_with(".node");
}

}  // namespace

std::optional<FeatureReason> reason_of(const FeatureSettings& feature, Status status,
                                       const std::optional<Blocker>& blocker,
                                       std::span<const FeatureRecord> features,
                                       const SitePlane& plane) {
  if (!blocker || blocker->number >= features.size()) return std::nullopt;
  const FeatureSettings& other = features[blocker->number].settings;
  const PlacedFeature named{blocker->number + 1, other};
  FeatureReason reason;
  switch (status) {
    case Status::repeated_feature:
      reason.what << "it has the same ends as " << named;
      reason.cure << "take one of the two out" << more;
      return reason;
    case Status::overlapping_features:
      reason.what << "it runs along a part of " << named;
      reason.cure << "let it begin where the other one ends, or take one of the two out" << more;
      return reason;
    case Status::crossing_features:
      break;
    default:
      return std::nullopt;
  }
  reason.what << "it crosses " << named;
  if (blocker->near) write_site_place(reason.what << " at ", plane, *blocker->near);
  if (is_drawn(feature) && is_drawn(other)) {
    reason.cure << "in the site file give both lines a vertex there, at the same coordinates, or "
                   "let one end there, or take one out";
  } else {
    reason.cure << "let both end at a node that is near there, each as two [[feature]], or draw "
                   "both in a site file with a vertex there, or take one out";
  }
  reason.cure << more;
  return reason;
}

std::optional<FeatureReason> reason_of(std::uint32_t number,
                                       std::span<const FeatureRecord> features,
                                       const SitePlane& plane) {
  const FeatureRecord& feature = features[number];
  return reason_of(feature.settings, feature.rejection, feature.blocker, features, plane);
}

}  // namespace etcm::firmware
