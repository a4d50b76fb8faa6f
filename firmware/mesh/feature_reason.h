// Why a feature of the site is kept out by another one, and what to do about it, for a person.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/logging/text_line.h"
#include "firmware/records/feature_table.h"
#include "firmware/records/node_table.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

struct FeatureReason {
  TextLine what;  // "it crosses feature 1 'fence' (site.geojson:3) at (378, 224)"
  TextLine cure;
};

// By its number, from 0. None where no other feature is in its way. O(f + n) for f features and n
// nodes, of which it names the one nearest to a crossing.
std::optional<FeatureReason> reason_of(std::uint32_t number,
                                       std::span<const FeatureRecord> features,
                                       const NodeTable& nodes, const SitePlane& plane);
std::optional<FeatureReason> reason_of(const FeatureSettings& feature, Status status,
                                       const std::optional<Blocker>& blocker,
                                       std::span<const FeatureRecord> features,
                                       const NodeTable& nodes, const SitePlane& plane);

}  // namespace etcm::firmware
