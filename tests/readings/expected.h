// What the nodes around a node predict that it reads, the node itself left out, by the surface with
// which the gateway judges sensors.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware/readings/nearest_nodes.h"

namespace etcm::firmware {

struct Expected {
  double value = 0;
  // Standard deviation of the value where each reading has independent noise of deviation 1; at
  // most noise_gain_max.
  double noise_gain = 0;
  // Standard deviation of a sound reading from `value`, judged by how the readings around differ
  // from a plane. None: they are just as many as a plane takes, so nothing tells.
  std::optional<double> uncertainty;
  std::uint32_t node_count = 0;  // that it rests on, at most thin_plate_max
};

// From one value a row, in any one unit; a value that is not finite is none. Of the nodes around
// (nearest_nodes.h) the nearest that have a value count. A field that is linear in x and y is
// predicted exactly, up to rounding, inside the site and at its hull.
//
// None: the row is no node; or fewer than three nodes around it have a value; or these are on one
// line (of which two will do) and the node is not; or it is too far outside of them; or the
// values are so large that the answer is not finite. Takes no memory; costs one ThinPlate::fit().
std::optional<Expected> expected_value(const NearestNodes& nodes, std::span<const double> values,
                                       std::uint32_t row);

}  // namespace etcm::firmware
