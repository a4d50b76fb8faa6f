#include "mesh_map_tables.h"

#include <array>
#include <string_view>

namespace etcm::firmware {

namespace {

// Whole units rounded down, and the sub-units that are left.
constexpr std::uint32_t whole(std::int64_t coordinate) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(coordinate >> subunit_bits));
}
constexpr std::uint32_t fraction(std::int64_t coordinate) {
  return static_cast<std::uint32_t>(coordinate & (subunits_per_unit - 1));
}

constexpr std::uint32_t flag(bool is_set, std::uint32_t bits) { return is_set ? bits : 0u; }

// Rows follow each other without a gap.
template <typename Source, std::size_t count>
constexpr std::array<MapRow<Source>, count> in_sequence(std::array<MapRow<Source>, count> rows) {
  std::uint16_t next = 0;
  for (MapRow<Source>& row : rows) {
    row.offset = next;
    next = static_cast<std::uint16_t>(next + row.registers);
  }
  return rows;
}

constexpr auto header_table = in_sequence(std::to_array<MapRow<HeaderSource>>({
    {"generation", 2, "of this block, as in every block",
     [](const HeaderSource& source) { return source.snapshot.generation; }},
    {"magic", 1, "0x4D45; 0x454D shows swapped bytes", [](const HeaderSource&) { return 0x4D45u; }},
    {"version", 1, "{}, the version of this map", [](const HeaderSource&) { return 1u; }},
    {"state", 1,
     "0 all well; bit 0 partial: a node or feature is not in the mesh; bit 1 stale: a node has not "
     "answered lately; bit 2 room or budget was too small",
     [](const HeaderSource& source) { return std::uint32_t{source.snapshot.state}; }},
    {"block_registers", 1, "{}", [](const HeaderSource&) { return block_size; }},
    {"blocks_per_unit", 1, "{}", [](const HeaderSource&) { return unit_blocks; }},
    {"vertices_per_block", 1, "{}", [](const HeaderSource&) { return block_vertices; }},
    {"neighbours_per_block", 1, "{}", [](const HeaderSource&) { return block_neighbours; }},
    {"reserved", 1, "{}", [](const HeaderSource&) { return 0u; }},
    {"node_count", 2, "nodes in the mesh, anchors not counted",
     [](const HeaderSource& source) { return source.snapshot.node_count; }},
    {"steiner_count", 2, "Steiner vertices in the mesh",
     [](const HeaderSource& source) { return source.snapshot.steiner_count; }},
    {"edge_count", 2, "edges of the mesh",
     [](const HeaderSource& source) { return source.snapshot.edge_count; }},
    {"triangle_count", 2, "triangles of the mesh",
     [](const HeaderSource& source) { return source.snapshot.triangle_count; }},
    {"features_active", 2, "features in the mesh",
     [](const HeaderSource& source) { return source.snapshot.features_active; }},
    {"features_configured", 2, "features in the configuration",
     [](const HeaderSource& source) { return source.snapshot.features_configured; }},
    {"quarantined_count", 2,
     "nodes, anchors and features that are kept out, and doubtful answers; the log has the reasons",
     [](const HeaderSource& source) { return source.snapshot.quarantined_count; }},
    {"stale_count", 2, "nodes in the mesh that have not answered lately",
     [](const HeaderSource& source) { return source.snapshot.stale_count; }},
    {"oldest_age_ms", 2, "age of the oldest position in the mesh when this generation was made",
     [](const HeaderSource& source) { return source.snapshot.oldest_age_ms; }},
    {"vertex_rows", 2, "rows of the vertex table in use, free ones between them included",
     [](const HeaderSource& source) {
       return static_cast<std::uint32_t>(source.snapshot.vertices.size());
     }},
    {"vertex_block_first", 2, "number of the first vertex block",
     [](const HeaderSource& source) { return source.layout.vertex_block_first; }},
    {"vertex_blocks", 2, "vertex blocks there are; fixed by vertices_max",
     [](const HeaderSource& source) { return source.layout.vertex_blocks; }},
    {"neighbour_entries", 2, "entries of the neighbour list in use",
     [](const HeaderSource& source) {
       return static_cast<std::uint32_t>(source.snapshot.neighbours.size());
     }},
    {"neighbour_block_first", 2, "number of the first neighbour block",
     [](const HeaderSource& source) { return source.layout.neighbour_block_first; }},
    {"neighbour_blocks", 2, "neighbour blocks there are; fixed by vertices_max",
     [](const HeaderSource& source) { return source.layout.neighbour_blocks; }},
    {"mesh_hash_high", 2, "the same for the same mesh, whatever its history; high half",
     [](const HeaderSource& source) {
       return static_cast<std::uint32_t>(source.snapshot.mesh_hash >> 32);
     }},
    {"mesh_hash_low", 2, "low half",
     [](const HeaderSource&
            source) { return static_cast<std::uint32_t>(source.snapshot.mesh_hash & 0xffffffffu); }},
    {"radio_range", 2, "[analysis] radio_range; 0: not set, and so are the next five",
     [](const HeaderSource& source) { return source.snapshot.analysis.radio_range; }},
    {"least_range_alone", 2,
     "least radio range that keeps the nodes one network; rounded up to units",
     [](const HeaderSource& source) { return source.snapshot.analysis.least_range_alone; }},
    {"least_range_with_relays", 2, "the same with a relay at each Steiner vertex and each anchor",
     [](const HeaderSource& source) { return source.snapshot.analysis.least_range_with_relays; }},
    {"parts_alone", 2, "networks into which the nodes fall at radio_range",
     [](const HeaderSource& source) { return source.snapshot.analysis.parts_alone; }},
    {"long_link_count", 2,
     "nodes that are neighbours among the nodes alone and farther apart than radio_range",
     [](const HeaderSource& source) { return source.snapshot.analysis.long_link_count; }},
    {"relay_count", 2,
     "relays proposed: Steiner vertices, anchors, and more where pieces of features are longer "
     "than "
     "radio_range",
     [](const HeaderSource& source) { return source.snapshot.analysis.relay_count; }},
    {"sensing_range", 2, "[analysis] sensing_range; 0: not set, and so are the next three",
     [](const HeaderSource& source) { return source.snapshot.analysis.sensing_range; }},
    {"hole_count", 2,
     "coverage holes: places of the domain farther than sensing_range from every node, each the "
     "worst around; 0: all is seen",
     [](const HeaderSource& source) { return source.snapshot.analysis.hole_count; }},
    {"gap_count", 2,
     "barrier gaps: stretches of features that the nodes on the feature do not see whole",
     [](const HeaderSource& source) { return source.snapshot.analysis.gap_count; }},
    {"unwatched_gap_count", 2,
     "of these, those where nodes beside the feature do not see all of it either",
     [](const HeaderSource& source) { return source.snapshot.analysis.unwatched_gap_count; }},
    {"anchor_count", 2, "anchors in the mesh",
     [](const HeaderSource& source) { return source.snapshot.anchor_count; }},
}));

constexpr auto vertex_table = in_sequence(std::to_array<MapRow<SnapshotVertex>>({
    {"kind", 1,
     "0 free row, 1 node, 2 Steiner vertex, 3 anchor; plus 0x0100 when the node is stale",
     [](const SnapshotVertex& vertex) {
       return (vertex.is_anchor ? 3u : static_cast<std::uint32_t>(vertex.kind)) |
              flag(vertex.stale, 0x0100);
     }},
    {"degree", 1, "count of neighbours",
     [](const SnapshotVertex& vertex) { return std::uint32_t{vertex.degree}; }},
    {"serial", 2, "of a node; else 0", [](const SnapshotVertex& vertex) { return vertex.serial; }},
    {"feature", 2, "number of the feature a Steiner vertex stands on, from 1 as configured; else 0",
     [](const SnapshotVertex& vertex) { return vertex.feature; }},
    {"x", 2, "int32, whole units (rounded down)",
     [](const SnapshotVertex& vertex) { return whole(vertex.point.x); }},
    {"x_fraction", 2, "what is left, in 2^-28 units; 0 for a node",
     [](const SnapshotVertex& vertex) { return fraction(vertex.point.x); }},
    {"y", 2, "int32, whole units (rounded down)",
     [](const SnapshotVertex& vertex) { return whole(vertex.point.y); }},
    {"y_fraction", 2, "what is left, in 2^-28 units; 0 for a node",
     [](const SnapshotVertex& vertex) { return fraction(vertex.point.y); }},
    {"neighbour_first", 2, "number of its first entry in the neighbour list",
     [](const SnapshotVertex& vertex) { return vertex.first_neighbour; }},
}));
static_assert(VertexKind{} == VertexKind::none && static_cast<int>(VertexKind::node) == 1 &&
              static_cast<int>(VertexKind::steiner) == 2);
static_assert(subunit_bits == 28);

constexpr auto neighbour_table = in_sequence(std::to_array<MapRow<SnapshotNeighbour>>({
    {"neighbour", 2,
     "row of the neighbour in the vertex table, from 0; bit 31 is set when the edge is part of a "
     "feature; with a radio_range also bit 30 when it is in the Gabriel subgraph and bit 29 when "
     "it is in the Urquhart subgraph",
     [](const SnapshotNeighbour& neighbour) {
       return neighbour.row | flag(neighbour.constrained, 1u << 31) |
              flag(neighbour.gabriel, 1u << 30) | flag(neighbour.urquhart, 1u << 29);
     }},
}));

template <typename Source>
constexpr std::uint32_t size_of(std::span<const MapRow<Source>> rows) {
  return rows.back().offset + rows.back().registers;
}
template <typename Source>
constexpr bool has_plain_widths(std::span<const MapRow<Source>> rows) {
  for (const MapRow<Source>& row : rows) {
    if (row.registers != 1 && row.registers != 2) return false;
  }
  return true;
}
// FNV-1a over names and places: what a master's program relies on.
template <typename Source>
constexpr std::uint32_t fingerprint(std::span<const MapRow<Source>> rows) {
  std::uint32_t hash = 2166136261u;
  const auto add = [&](std::uint32_t value) { hash = (hash ^ value) * 16777619u; };
  for (const MapRow<Source>& row : rows) {
    for (const char letter : std::string_view(row.name)) add(static_cast<unsigned char>(letter));
    add(row.offset);
    add(row.registers);
  }
  return hash;
}

using HeaderRows = std::span<const MapRow<HeaderSource>>;
using VertexRows = std::span<const MapRow<SnapshotVertex>>;
using NeighbourRows = std::span<const MapRow<SnapshotNeighbour>>;
static_assert(has_plain_widths(HeaderRows(header_table)));
static_assert(has_plain_widths(VertexRows(vertex_table)));
static_assert(has_plain_widths(NeighbourRows(neighbour_table)));
static_assert(size_of(HeaderRows(header_table)) <= block_size);
static_assert(size_of(VertexRows(vertex_table)) == vertex_registers);
static_assert(size_of(NeighbourRows(neighbour_table)) == neighbour_registers);
static_assert(header_table[0].offset == 0 && header_table[0].registers == generation_registers);

// Masters in the field read version 1 as it is here. If one of these fails, a published register
// was renamed or moved: append behind these rows instead, or raise the version.
static_assert(fingerprint(HeaderRows(header_table).first(37)) == 0xd3284692);
static_assert(fingerprint(VertexRows(vertex_table)) == 0x0efde454);
static_assert(fingerprint(NeighbourRows(neighbour_table)) == 0xd0a7cf4e);

}  // namespace

std::span<const MapRow<HeaderSource>> header_rows() { return header_table; }
std::span<const MapRow<SnapshotVertex>> vertex_rows() { return vertex_table; }
std::span<const MapRow<SnapshotNeighbour>> neighbour_rows() { return neighbour_table; }

}  // namespace etcm::firmware
