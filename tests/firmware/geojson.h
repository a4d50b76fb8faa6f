// Sites as a site file would give them: anchors, features between them, and a domain.
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "firmware/config/settings.h"

namespace etcm::firmware {

inline FeatureEnd at(std::int32_t x, std::int32_t y) { return FeatureEnd::anchor({x, y}); }

inline FeatureSettings line(FeatureEnd from, FeatureEnd to, const std::string& name = "") {
  return {.from = from, .to = to, .name = name, .source = "site.geojson:1"};
}

// The settings get an anchor for each end that is none yet.
inline void draw(Settings& settings, std::vector<FeatureSettings> features) {
  settings.features = std::move(features);
  settings.anchors.clear();
  for (const FeatureSettings& feature : settings.features) {
    for (const FeatureEnd& end : {feature.from, feature.to}) {
      const bool is_known = std::any_of(
          settings.anchors.begin(), settings.anchors.end(),
          [&](const AnchorSettings& anchor) { return anchor.position == end.position; });
      if (end.is_anchor && !is_known) {
        settings.anchors.push_back({.position = end.position, .source = "site.geojson:1"});
      }
    }
  }
}

// The edges of a square from (from, from) to (to, to).
inline std::vector<DomainEdge> ring(std::int32_t from, std::int32_t to) {
  const Point corner[4] = {to_point({from, from}), to_point({to, from}), to_point({to, to}),
                           to_point({from, to})};
  std::vector<DomainEdge> edges;
  for (int i = 0; i < 4; ++i) edges.push_back({.from = corner[i], .to = corner[(i + 1) % 4]});
  return edges;
}

inline SiteDomain square(std::int32_t from, std::int32_t to) { return {ring(from, to), {}}; }

// Features along the edges, between anchors.
inline std::vector<FeatureSettings> lines_along(
    std::initializer_list<std::vector<DomainEdge>> rings) {
  const auto end = [](const Point& p) {
    return at(static_cast<std::int32_t>(p.x / subunits_per_unit),
              static_cast<std::int32_t>(p.y / subunits_per_unit));
  };
  std::vector<FeatureSettings> features;
  for (const std::vector<DomainEdge>& edges : rings) {
    for (const DomainEdge& edge : edges) features.push_back(line(end(edge.from), end(edge.to)));
  }
  return features;
}

}  // namespace etcm::firmware
