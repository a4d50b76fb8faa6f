// Several features at once, each linked and conformed in canonical order.
#pragma once

#include "triangulation/change.h"

namespace etcm::internal {

// Links and conforms features, first those that need no Steiner vertex, then the others one by one,
// each in canonical order. Those it has not come to stay in the list.
Status conform_features(Change& change, FeatureList& features) noexcept;

}  // namespace etcm::internal
