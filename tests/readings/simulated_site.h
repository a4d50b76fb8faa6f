// Sites of sensors and the fields they stand in.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "firmware/publish/snapshot.h"
#include "firmware/readings/disagreement.h"
#include "inputs/graph.h"

namespace etcm::test {

inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

// What the gateway would publish of a graph: node i in row i, with serial 1000 + i.
firmware::Snapshot snapshot_of(const inputs::Graph& graph);

// So many nodes, evenly at random in a square of this side; no two equal.
std::vector<Position> scattered(std::size_t count, std::int32_t side, std::uint64_t seed);

// All of them, and a sensor in each of some.
std::vector<std::uint32_t> rows_of(const firmware::Snapshot& snapshot);
std::vector<firmware::PlacedSensor> sensors_in(const std::vector<std::uint32_t>& rows);

// In units of the site.
double x_of(const firmware::Snapshot& snapshot, std::uint32_t row);
double y_of(const firmware::Snapshot& snapshot, std::uint32_t row);

// Values of a smooth random field at the nodes, from 0 to 1: many waves at random, with a Gaussian
// covariance of this length.
std::vector<double> smooth_field(const firmware::Snapshot& snapshot, double length,
                                 std::uint64_t seed);

}  // namespace etcm::test
