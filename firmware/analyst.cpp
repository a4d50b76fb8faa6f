#include "analyst.h"

#include <algorithm>
#include <limits>
#include <span>

#include "etcm/domain.h"

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

Analyst::Analyst(const AnalysisSettings& settings, const MeshConfig& config) : settings_(settings) {
  if (settings.radio_range == 0 && settings.sensing_range == 0) return;
  const MeshConfig nodes{.vertices_max = config.vertices_max};
  nodes_memory_.resize(storage_bytes(nodes) / sizeof(std::uint64_t) + 1);
  positions_.reserve(config.vertices_max);
  // Cannot fail: the mesh itself was opened for as many.
  static_cast<void>(nodes_mesh_.open(std::as_writable_bytes(std::span(nodes_memory_)), nodes));
  if (settings.radio_range != 0) {
    parts_.resize(std::size_t{config.vertices_max} + 1);
    links_.resize(std::max<std::size_t>(analysis_list_max, config.vertices_max));
    relays_.resize(analysis_list_max);
  }
  if (settings.sensing_range != 0) {
    region_.resize(2 * std::size_t{config.vertices_max});
    waiting_.resize(region_.size());
    gaps_.resize(analysis_list_max);
    holes_.resize(analysis_list_max);
  }
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

void Analyst::look_at(const Mesh& mesh, const FeatureBook& features, Snapshot& snapshot) {
  if (settings_.radio_range == 0 && settings_.sensing_range == 0) return;
  MeshAnalysis& analysis = snapshot.analysis;
  analysis.radio_range = settings_.radio_range;
  analysis.sensing_range = settings_.sensing_range;
  const Mesh& nodes = nodes_alone(mesh);
  if (settings_.radio_range != 0) {
    look_at_links(mesh, nodes, analysis);
    look_at_relays(mesh, features, analysis);
    mark_subgraphs(mesh, snapshot);
  }
  if (settings_.sensing_range != 0) {
    look_at_coverage(mesh, nodes, analysis);
    look_at_gaps(mesh, nodes, features, analysis);
  }
}

// The mesh itself, where it has no Steiner vertices.
const Mesh& Analyst::nodes_alone(const Mesh& mesh) {
  if (mesh.steiner_count() == 0) return mesh;
  positions_.clear();
  for (IdValue value = 1; value < mesh.vertex_id_end(); ++value) {
    const VertexId vertex{value};
    if (mesh.kind(vertex) == VertexKind::node) positions_.push_back(mesh.position(vertex));
  }
  nodes_mesh_.clear();
  // Nodes of one mesh are distinct and in range, and there is room for them.
  static_cast<void>(nodes_mesh_.build(positions_, {}));
  return nodes_mesh_;
}

void Analyst::look_at_links(const Mesh& mesh, const Mesh& nodes, MeshAnalysis& analysis) {
  Connectivity alone, with_relays;
  static_cast<void>(connectivity(nodes, settings_.radio_range, parts_, alone));
  with_relays = alone;
  if (&nodes != &mesh) {
    static_cast<void>(connectivity(mesh, settings_.radio_range, parts_, with_relays));
  }
  analysis.least_range_alone = range_for(alone.least);
  analysis.parts_alone = alone.parts;
  analysis.least_range_with_relays = range_for(with_relays.least);
  analysis.parts_with_relays = with_relays.parts;

  const std::span<Link> too_long = std::span(links_).first(analysis_list_max);
  analysis.long_link_count = links(mesh, settings_.radio_range, too_long);
  analysis.long_links.clear();
  for (const Link& link : listed<Link>(too_long, analysis.long_link_count)) {
    analysis.long_links.push_back({row_of(link.from), row_of(link.to)});
  }
}

void Analyst::look_at_relays(const Mesh& mesh, const FeatureBook& features,
                             MeshAnalysis& analysis) {
  const std::uint64_t count = relays(mesh, settings_.radio_range, relays_);
  analysis.relay_count = saturated(count);
  analysis.relays.clear();
  for (const Relay& relay : listed<Relay>(relays_, count)) {
    analysis.relays.push_back(
        {relay.place, features.number_of(relay.feature) + 1, row_of(relay.vertex)});
  }
}

void Analyst::look_at_coverage(const Mesh& mesh, const Mesh& nodes, MeshAnalysis& analysis) {
  static_cast<void>(label_domain(mesh, Exterior::automatic, {}, region_, waiting_));
  analysis.hole_count =
      coverage_holes(nodes, {.mesh = &mesh, .region = region_}, settings_.sensing_range, holes_);
  analysis.holes.clear();
  for (const Hole& hole : listed<Hole>(holes_, analysis.hole_count)) {
    analysis.holes.push_back(
        {hole.place, range_for(squared_distance(hole.place, hole.sensor)), hole.on_boundary});
  }
}

void Analyst::look_at_gaps(const Mesh& mesh, const Mesh& nodes, const FeatureBook& features,
                           MeshAnalysis& analysis) {
  analysis.gap_count = barrier_gaps(mesh, nodes, settings_.sensing_range, gaps_);
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
