#include "simulated_site.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include "support/meshes.h"

namespace etcm::test {

using firmware::Snapshot;

Snapshot snapshot_of(const inputs::Graph& graph) {
  const auto owned = built(graph);
  const Mesh& mesh = **owned;
  Snapshot snapshot;
  std::vector<Neighbour> around(mesh.vertex_id_end());
  for (IdValue id = 1; id < mesh.vertex_id_end(); ++id) {
    firmware::SnapshotVertex vertex;
    vertex.kind = mesh.kind(VertexId{id});
    if (vertex.kind != VertexKind::none) {
      vertex.point = mesh.point(VertexId{id});
      if (vertex.kind == VertexKind::node) vertex.serial = firmware::Serial{999u + id};
      vertex.first_neighbour = static_cast<std::uint32_t>(snapshot.neighbours.size());
      vertex.degree = static_cast<std::uint16_t>(mesh.neighbours(VertexId{id}, around));
      for (std::size_t i = 0; i < vertex.degree; ++i) {
        snapshot.neighbours.push_back(
            {.row = around[i].vertex.value - 1u, .constrained = around[i].constrained});
      }
    }
    snapshot.vertices.push_back(vertex);
  }
  return snapshot;
}

std::vector<Position> scattered(std::size_t count, std::int32_t side, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::set<std::pair<std::int32_t, std::int32_t>> taken;
  std::vector<Position> positions;
  while (positions.size() < count) {
    const auto x = static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(side));
    const auto y = static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(side));
    if (taken.emplace(x, y).second) positions.push_back({x, y});
  }
  return positions;
}

std::vector<std::uint32_t> rows_of(const Snapshot& snapshot) {
  std::vector<std::uint32_t> rows(snapshot.vertices.size());
  std::iota(rows.begin(), rows.end(), 0u);
  return rows;
}

std::vector<firmware::PlacedSensor> sensors_in(const std::vector<std::uint32_t>& rows) {
  std::vector<firmware::PlacedSensor> sensors;
  for (const std::uint32_t row : rows) sensors.push_back({.row = row, .definition = 7});
  return sensors;
}

double x_of(const Snapshot& snapshot, std::uint32_t row) {
  return static_cast<double>(snapshot.vertices[row].point.x) / double{subunits_per_unit};
}
double y_of(const Snapshot& snapshot, std::uint32_t row) {
  return static_cast<double>(snapshot.vertices[row].point.y) / double{subunits_per_unit};
}

std::vector<double> smooth_field(const Snapshot& snapshot, double length, std::uint64_t seed) {
  constexpr int wave_count = 300;
  std::mt19937_64 random(seed);
  // Not those of <random>, whose numbers differ between libraries.
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<double> values(snapshot.vertices.size());
  for (int wave = 0; wave < wave_count; ++wave) {
    const double radius = std::sqrt(-2 * std::log(1 - uniform())) / length;
    const double angle = 2 * std::numbers::pi * uniform();
    const double phase = 2 * std::numbers::pi * uniform();
    for (std::uint32_t row = 0; row < values.size(); ++row) {
      values[row] += std::cos(
          radius * (std::cos(angle) * x_of(snapshot, row) + std::sin(angle) * y_of(snapshot, row)) +
          phase);
    }
  }
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  const double from = *least;
  const double range = *greatest - from;
  for (double& value : values) value = (value - from) / range;
  return values;
}

}  // namespace etcm::test
