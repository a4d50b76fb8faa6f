#include "firmware/publish/analyst.h"

#include <algorithm>
#include <limits>
#include <span>

namespace etcm::firmware {

namespace {

std::uint32_t row_of(VertexId vertex) { return vertex.is_none() ? no_row : vertex.value - 1u; }

// What a list holds when there are `count` entries.
template <class Entry>
std::span<const Entry> listed(std::span<const Entry> list, std::uint64_t count) {
  return list.first(static_cast<std::size_t>(std::min<std::uint64_t>(count, list.size())));
}

std::uint32_t saturated(std::uint64_t count) {
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(count, std::numeric_limits<std::uint32_t>::max()));
}

}  // namespace

Analyst::Analyst(const AnalysisSettings& settings, const MeshConfig& config)
    : settings_(settings), domain_(settings.sensing_range != 0 ? config.vertices_max : 0) {
  if (settings.radio_range == 0 && settings.sensing_range == 0) return;
  const MeshConfig devices{.vertices_max = config.vertices_max};
  devices_memory_.resize(storage_bytes(devices) / sizeof(std::uint64_t) + 1);
  positions_.reserve(config.vertices_max);
  device_row_.reserve(config.vertices_max);
  // Cannot fail: the mesh itself was opened for as many.
  static_cast<void>(
      devices_mesh_.open(std::as_writable_bytes(std::span(devices_memory_)), devices));
  if (settings.radio_range != 0) {
    parts_.resize(std::size_t{config.vertices_max} + 1);
    links_.resize(std::max<std::size_t>(analysis_list_max, config.vertices_max));
    relays_.resize(analysis_list_max);
  }
  if (settings.sensing_range != 0) {
    gaps_.resize(analysis_list_max);
    holes_.resize(analysis_list_max);
  }
}

void Analyst::take_site(const SiteDomain& site) {
  if (settings_.sensing_range != 0) static_cast<void>(domain_.take(site));
}

void reserve(MeshAnalysis& analysis, const AnalysisSettings& settings) {
  if (settings.radio_range != 0) {
    analysis.long_links.reserve(analysis_list_max);
    analysis.relays.reserve(analysis_list_max);
  }
  if (settings.sensing_range != 0) {
    analysis.holes.reserve(analysis_list_max);
    analysis.gaps.reserve(analysis_list_max);
  }
}

void Analyst::look_at(const Mesh& mesh, const FeatureTable& features, Snapshot& snapshot) {
  if (settings_.radio_range == 0 && settings_.sensing_range == 0) return;
  MeshAnalysis& analysis = snapshot.analysis;
  analysis.radio_range = settings_.radio_range;
  analysis.sensing_range = settings_.sensing_range;
  const Mesh& devices = devices_alone(mesh, snapshot);
  if (settings_.radio_range != 0) {
    look_at_links(mesh, devices, analysis);
    look_at_relays(mesh, devices, features, analysis);
    mark_subgraphs(mesh, snapshot);
  }
  if (settings_.sensing_range != 0) {
    look_at_coverage(mesh, devices, analysis);
    look_at_gaps(mesh, devices, features, analysis);
  }
}

const Mesh& Analyst::devices_alone(const Mesh& mesh, const Snapshot& snapshot) {
  positions_.clear();
  device_row_.clear();
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    const SnapshotVertex& vertex = snapshot.vertices[row];
    if (vertex.kind != VertexKind::node || vertex.is_anchor) continue;
    positions_.push_back(mesh.position(VertexId{static_cast<IdValue>(row + 1)}));
    device_row_.push_back(row);
  }
  devices_mesh_.clear();
  // Nodes of one mesh are distinct and in range, and there is room for them.
  static_cast<void>(devices_mesh_.build(positions_, {}));
  return devices_mesh_;
}

void Analyst::look_at_links(const Mesh& mesh, const Mesh& devices, MeshAnalysis& analysis) {
  Connectivity alone, with_relays;
  static_cast<void>(connectivity(devices, settings_.radio_range, parts_, alone));
  static_cast<void>(connectivity(mesh, settings_.radio_range, parts_, with_relays));
  analysis.least_range_alone = range_for(alone.least);
  analysis.parts_alone = alone.parts;
  analysis.least_range_with_relays = range_for(with_relays.least);
  analysis.parts_with_relays = with_relays.parts;

  const std::span<Link> too_long = std::span(links_).first(analysis_list_max);
  analysis.long_link_count = links(devices, settings_.radio_range, too_long);
  analysis.long_links.clear();
  for (const Link& link : listed<Link>(too_long, analysis.long_link_count)) {
    analysis.long_links.push_back({device_row_[row_of(link.from)], device_row_[row_of(link.to)]});
  }
}

void Analyst::look_at_relays(const Mesh& mesh, const Mesh& devices, const FeatureTable& features,
                             MeshAnalysis& analysis) {
  const std::uint64_t count = relays(mesh, devices, settings_.radio_range, relays_);
  analysis.relay_count = saturated(count);
  analysis.relays.clear();
  for (const Relay& relay : listed<Relay>(relays_, count)) {
    const std::uint32_t feature =
        relay.feature.is_none() ? 0 : features.number_of(relay.feature) + 1;
    analysis.relays.push_back({relay.position, feature, row_of(relay.vertex)});
  }
}

void Analyst::look_at_coverage(const Mesh& mesh, const Mesh& devices, MeshAnalysis& analysis) {
  analysis.hole_count = coverage_holes(devices, domain_.of(mesh), settings_.sensing_range, holes_);
  analysis.holes.clear();
  for (const Hole& hole : listed<Hole>(holes_, analysis.hole_count)) {
    analysis.holes.push_back(
        {hole.position, range_for(squared_distance(hole.position, hole.sensor)), hole.on_boundary});
  }
}

void Analyst::look_at_gaps(const Mesh& mesh, const Mesh& devices, const FeatureTable& features,
                           MeshAnalysis& analysis) {
  analysis.gap_count = barrier_gaps(mesh, devices, settings_.sensing_range, gaps_);
  analysis.unwatched_gap_count = 0;
  analysis.gaps.clear();
  for (const Gap& gap : listed<Gap>(gaps_, analysis.gap_count)) {
    analysis.gaps.push_back(
        {features.number_of(gap.feature) + 1, row_of(gap.from), row_of(gap.to), gap.watched});
    if (!gap.watched) ++analysis.unwatched_gap_count;
  }
}

void Analyst::mark_subgraphs(const Mesh& mesh, Snapshot& snapshot) {
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    const SnapshotVertex& vertex = snapshot.vertices[row];
    if (vertex.kind == VertexKind::none) continue;
    const std::uint32_t degree = links_at(mesh, VertexId{static_cast<IdValue>(row + 1)}, links_);
    for (std::uint32_t i = 0; i < degree; ++i) {
      SnapshotNeighbour& neighbour = snapshot.neighbours[vertex.first_neighbour + i];
      neighbour.gabriel = links_[i].gabriel;
      neighbour.urquhart = links_[i].urquhart;
    }
  }
}

}  // namespace etcm::firmware
