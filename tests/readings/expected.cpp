#include "expected.h"

#include <array>
#include <cmath>

#include "firmware/readings/thin_plate.h"

namespace etcm::firmware {

std::optional<Expected> expected_value(const NearestNodes& nodes, std::span<const double> values,
                                       std::uint32_t row) {
  std::array<Offset, thin_plate_max> places;
  std::array<double, thin_plate_max> readings{};
  std::size_t count = 0;
  for (const NearNode& near : nodes.around(row)) {
    if (count == thin_plate_max) break;
    if (near.row >= values.size() || !std::isfinite(values[near.row])) continue;
    places[count] = {near.x, near.y};
    readings[count] = values[near.row];
    ++count;
  }
  ThinPlate surface;
  if (!surface.fit(std::span(places).first(count))) return std::nullopt;
  const auto used = std::span(readings).first(count);
  Expected expected{.value = surface.value(used),
                    .noise_gain = surface.noise_gain(),
                    .uncertainty = std::nullopt,
                    .node_count = static_cast<std::uint32_t>(count)};
  if (surface.has_deviation()) expected.uncertainty = surface.deviation(used);
  if (!std::isfinite(expected.value) || !std::isfinite(expected.uncertainty.value_or(0))) {
    return std::nullopt;
  }
  return expected;
}

}  // namespace etcm::firmware
