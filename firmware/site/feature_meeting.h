// Whether two features can both be in the mesh, by where they run.
#pragma once

#include <optional>

#include "etcm/status.h"
#include "etcm/types.h"

namespace etcm::firmware {

struct FeatureLine {
  Position from;
  Position to;
};

struct Meeting {
  // repeated_feature, overlapping_features, crossing_features; ok: both can be.
  Status status = Status::ok;
  // Where they cross, if that is a place for a node: where one stands, both can be.
  std::optional<Position> crossing{};
  // Where they cross, to the nearest place for a node; none where they do not.
  std::optional<Position> near_crossing{};
};

// As the mesh sees it, exactly. Neither is of length zero, and all positions are in_range().
Meeting meeting_of(const FeatureLine& one, const FeatureLine& other);

// Whether the place is on the line, its ends not counted.
bool runs_through(const FeatureLine& line, Position place);

}  // namespace etcm::firmware
