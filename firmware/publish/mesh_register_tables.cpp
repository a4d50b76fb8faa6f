#include "firmware/publish/mesh_register_tables.h"

#include <array>

namespace etcm::firmware {

namespace {

// Whole units rounded down, and the sub-units that are left.
constexpr std::uint32_t whole(std::int64_t coordinate) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(coordinate >> subunit_bits));
}
constexpr std::uint32_t fraction(std::int64_t coordinate) {
  return static_cast<std::uint32_t>(coordinate & (subunits_per_unit - 1));
}

constexpr auto header_table = in_sequence(std::to_array<RegisterRow<HeaderSource>>({
    {"generation", 2, "of this block, as in every block",
     [](const HeaderSource& source) { return source.snapshot.generation; }},
    {"magic", 1, "0x4D45; 0x454D shows swapped bytes", [](const HeaderSource&) { return 0x4D45u; }},
    {"version", 1, "{}, the version of this map", [](const HeaderSource&) { return 1u; }},
    {"state", 1,
     "0 all well; bit 0 partial: a node or feature is not in the mesh; bit 1 stale: a node has not "
     "answered lately, or has no fix; bit 2 room or budget was too small; bit 3 missing: a node "
     "fell "
     "silent, left the mesh for that and has not come back; bit 4 bus silent: no node of a bus "
     "answers, or none of its units has since the start, for leave_after",
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
     "nodes, anchors and features that are kept out, and doubtful answers; the quarantine list has "
     "the reasons",
     [](const HeaderSource& source) { return source.snapshot.quarantined_count; }},
    {"stale_count", 2, "nodes in the mesh that have not answered lately, or have no fix",
     [](const HeaderSource& source) { return source.snapshot.stale_count; }},
    {"oldest_age_ms", 2, "age of the oldest position in the mesh when this generation was made",
     [](const HeaderSource& source) { return source.snapshot.oldest_age_ms; }},
    {"vertex_rows", 2, "rows of the vertex table in use, free ones between them included",
     [](const HeaderSource& source) {
       return static_cast<std::uint32_t>(source.snapshot.vertices.size());
     }},
    {"vertex_block_first", 2, "number of the first vertex block",
     [](const HeaderSource& source) { return source.layout.vertices.first; }},
    {"vertex_blocks", 2, "vertex blocks there are; fixed by vertices_max",
     [](const HeaderSource& source) { return source.layout.vertices.count; }},
    {"neighbour_entries", 2, "entries of the neighbour list in use",
     [](const HeaderSource& source) {
       return static_cast<std::uint32_t>(source.snapshot.neighbours.size());
     }},
    {"neighbour_block_first", 2, "number of the first neighbour block",
     [](const HeaderSource& source) { return source.layout.neighbours.first; }},
    {"neighbour_blocks", 2, "neighbour blocks there are; fixed by vertices_max",
     [](const HeaderSource& source) { return source.layout.neighbours.count; }},
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
     "relays proposed: Steiner vertices, anchors, and more where subsegments are longer "
     "than "
     "radio_range",
     [](const HeaderSource& source) { return source.snapshot.analysis.relay_count; }},
    {"sensing_range", 2, "[analysis] sensing_range; 0: not set, and so are the next three",
     [](const HeaderSource& source) { return source.snapshot.analysis.sensing_range; }},
    {"hole_count", 2,
     "coverage holes: places of the domain farther than sensing_range from every node, each the "
     "worst around; 0: all is seen, or there is no node",
     [](const HeaderSource& source) { return source.snapshot.analysis.hole_count; }},
    {"gap_count", 2,
     "barrier gaps: segments of features that the nodes on the feature do not see whole",
     [](const HeaderSource& source) { return source.snapshot.analysis.gap_count; }},
    {"unwatched_gap_count", 2,
     "of these, those where nodes beside the feature do not see all of it either",
     [](const HeaderSource& source) { return source.snapshot.analysis.unwatched_gap_count; }},
    {"anchor_count", 2, "anchors in the mesh",
     [](const HeaderSource& source) { return source.snapshot.anchor_count; }},
    {"relays_per_block", 1, "{}", [](const HeaderSource&) { return block_relays; }},
    {"relay_entries", 2, "entries of the list of relays in use",
     [](const HeaderSource&
            source) { return static_cast<std::uint32_t>(source.snapshot.analysis.relays.size()); }},
    {"relay_block_first", 2, "number of the first block of relays",
     [](const HeaderSource& source) { return source.layout.relays.first; }},
    {"relay_blocks", 2, "blocks of relays there are; fixed by the configuration",
     [](const HeaderSource& source) { return source.layout.relays.count; }},
    {"holes_per_block", 1, "{}", [](const HeaderSource&) { return block_holes; }},
    {"hole_entries", 2, "entries of the list of coverage holes in use",
     [](const HeaderSource& source) {
       return static_cast<std::uint32_t>(source.snapshot.analysis.holes.size());
     }},
    {"hole_block_first", 2, "number of the first block of coverage holes",
     [](const HeaderSource& source) { return source.layout.holes.first; }},
    {"hole_blocks", 2, "blocks of coverage holes there are; fixed by the configuration",
     [](const HeaderSource& source) { return source.layout.holes.count; }},
    {"gaps_per_block", 1, "{}", [](const HeaderSource&) { return block_gaps; }},
    {"gap_entries", 2, "entries of the list of barrier gaps in use",
     [](const HeaderSource& source) {
       return static_cast<std::uint32_t>(source.snapshot.analysis.gaps.size());
     }},
    {"gap_block_first", 2, "number of the first block of barrier gaps",
     [](const HeaderSource& source) { return source.layout.gaps.first; }},
    {"gap_blocks", 2, "blocks of barrier gaps there are; fixed by the configuration",
     [](const HeaderSource& source) { return source.layout.gaps.count; }},
    {"long_links_per_block", 1, "{}", [](const HeaderSource&) { return block_long_links; }},
    {"long_link_entries", 2, "entries of the list of links that are too long in use",
     [](const HeaderSource& source) {
       return static_cast<std::uint32_t>(source.snapshot.analysis.long_links.size());
     }},
    {"long_link_block_first", 2, "number of the first block of links that are too long",
     [](const HeaderSource& source) { return source.layout.long_links.first; }},
    {"long_link_blocks", 2,
     "blocks of links that are too long there are; fixed by the configuration",
     [](const HeaderSource& source) { return source.layout.long_links.count; }},
    {"quarantine_per_block", 1, "{}", [](const HeaderSource&) { return block_quarantined; }},
    {"quarantine_entries", 2, "entries of the list of what is in quarantine in use",
     [](const HeaderSource& source) {
       return static_cast<std::uint32_t>(source.snapshot.quarantine.size());
     }},
    {"quarantine_block_first", 2, "number of the first block of what is in quarantine",
     [](const HeaderSource& source) { return source.layout.quarantine.first; }},
    {"quarantine_blocks", 2,
     "blocks of what is in quarantine there are; fixed by the configuration",
     [](const HeaderSource& source) { return source.layout.quarantine.count; }},
    {"word_order_check", 2,
     "0x01020304 to a master that puts 32-bit values together rightly; 0x03040102 shows swapped "
     "words, 0x02010403 swapped bytes, 0x04030201 both",
     [](const HeaderSource&) { return 0x01020304u; }},
    {"missing_count", 2, "nodes that fell silent, left the mesh for that and have not come back",
     [](const HeaderSource& source) { return source.snapshot.missing_count; }},
    {"silent_bus_count", 2, "buses that are silent, as bit 4 of the state has it",
     [](const HeaderSource& source) { return source.snapshot.silent_bus_count; }},
    {"waiting_count", 2, "nodes that answer and have not told yet where they are",
     [](const HeaderSource& source) { return source.snapshot.waiting_count; }},
    {"reading_head_block", 2,
     "number of the block that says where readings are; 0: no device measures",
     [](const HeaderSource& source) {
       return source.layout.reading_head.count == 0 ? 0u : source.layout.reading_head.first;
     }},
    {"absent_count", 2, "units that the settings name one by one and that have never answered",
     [](const HeaderSource& source) { return source.snapshot.absent_count; }},
}));

constexpr auto vertex_table = in_sequence(std::to_array<RegisterRow<SnapshotVertex>>({
    {"kind", 1,
     "0 free row, 1 node, 2 Steiner vertex, 3 anchor; plus 0x0100 when the node is stale",
     [](const SnapshotVertex& vertex) {
       return (vertex.is_anchor ? 3u : static_cast<std::uint32_t>(vertex.kind)) |
              flag(vertex.stale, 0x0100);
     }},
    {"degree", 1, "count of neighbours",
     [](const SnapshotVertex& vertex) { return std::uint32_t{vertex.degree}; }},
    {"serial", 2, "of a node; else 0",
     [](const SnapshotVertex& vertex) { return register_of(vertex.serial); }},
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

constexpr auto neighbour_table = in_sequence(std::to_array<RegisterRow<SnapshotNeighbour>>({
    {"neighbour", 2,
     "row of the neighbour in the vertex table, from 0; bit 31 is set when the edge is part of a "
     "feature; with a radio_range also bit 30 when it is in the Gabriel subgraph and bit 29 when "
     "it is in the Urquhart subgraph",
     [](const SnapshotNeighbour& neighbour) {
       return neighbour.row | flag(neighbour.constrained, 1u << 31) |
              flag(neighbour.gabriel, 1u << 30) | flag(neighbour.urquhart, 1u << 29);
     }},
}));

// Columns that several lists have.
template <typename Source>
constexpr std::uint32_t x_of(const Source& source) {
  return whole(source.point.x);
}
template <typename Source>
constexpr std::uint32_t x_fraction_of(const Source& source) {
  return fraction(source.point.x);
}
template <typename Source>
constexpr std::uint32_t y_of(const Source& source) {
  return whole(source.point.y);
}
template <typename Source>
constexpr std::uint32_t y_fraction_of(const Source& source) {
  return fraction(source.point.y);
}

constexpr auto relay_table = in_sequence(std::to_array<RegisterRow<ProposedRelay>>({
    {"x", 2, "int32, whole units (rounded down)", x_of<ProposedRelay>},
    {"x_fraction", 2, "what is left, in 2^-28 units", x_fraction_of<ProposedRelay>},
    {"y", 2, "int32, whole units (rounded down)", y_of<ProposedRelay>},
    {"y_fraction", 2, "what is left, in 2^-28 units", y_fraction_of<ProposedRelay>},
    {"feature", 2, "number of the feature it is on, from 1 as configured; 0: an anchor on none",
     [](const ProposedRelay& relay) { return relay.feature; }},
    {"row", 2,
     "row of the Steiner vertex or anchor that stands there, from 0; 4294967295: it is between "
     "vertices",
     [](const ProposedRelay& relay) { return relay.row; }},
}));

constexpr auto hole_table = in_sequence(std::to_array<RegisterRow<CoverageHole>>({
    {"x", 2, "int32, whole units (rounded down)", x_of<CoverageHole>},
    {"x_fraction", 2, "what is left, in 2^-28 units", x_fraction_of<CoverageHole>},
    {"y", 2, "int32, whole units (rounded down)", y_of<CoverageHole>},
    {"y_fraction", 2, "what is left, in 2^-28 units", y_fraction_of<CoverageHole>},
    {"distance", 2, "to the nearest node, in units, rounded up",
     [](const CoverageHole& hole) { return hole.distance; }},
    {"hole_flags", 1, "bit 0: on the boundary of the domain",
     [](const CoverageHole& hole) { return flag(hole.on_boundary, 1); }},
    {"reserved", 1, "{}", [](const CoverageHole&) { return 0u; }},
}));

constexpr auto gap_table = in_sequence(std::to_array<RegisterRow<BarrierGap>>({
    {"feature", 2, "number of the feature, from 1 as configured",
     [](const BarrierGap& gap) { return gap.feature; }},
    {"from_row", 2, "row of the vertex where it begins: a node, or an anchor that ends the feature",
     [](const BarrierGap& gap) { return gap.from_row; }},
    {"to_row", 2, "row of the vertex where it ends",
     [](const BarrierGap& gap) { return gap.to_row; }},
    {"gap_flags", 1, "bit 0: nodes beside the feature see all of it",
     [](const BarrierGap& gap) { return flag(gap.watched, 1); }},
    {"reserved", 1, "{}", [](const BarrierGap&) { return 0u; }},
}));

constexpr auto long_link_table = in_sequence(std::to_array<RegisterRow<LongLink>>({
    {"from_row", 2, "row of one of the two nodes",
     [](const LongLink& link) { return link.from_row; }},
    {"to_row", 2, "row of the other", [](const LongLink& link) { return link.to_row; }},
}));

constexpr auto quarantined_table = in_sequence(std::to_array<RegisterRow<SnapshotQuarantined>>({
    {"kind", 1, "1 node, 2 feature, 3 anchor, 4 doubtful answer of a unit",
     [](const SnapshotQuarantined& entry) { return static_cast<std::uint32_t>(entry.kind); }},
    {"reason", 1, "see below",
     [](const SnapshotQuarantined& entry) { return std::uint32_t{entry.reason}; }},
    {"serial", 2, "of a node or a doubtful answer; else 0",
     [](const SnapshotQuarantined& entry) { return register_of(entry.serial); }},
    {"feature", 2, "number of a feature, from 1 as configured; else 0",
     [](const SnapshotQuarantined& entry) { return entry.feature; }},
    {"bus", 1, "of the unit that answers, from 1 as configured; 0: not known",
     [](const SnapshotQuarantined& entry) { return std::uint32_t{entry.bus}; }},
    {"unit", 1, "on that bus",
     [](const SnapshotQuarantined& entry) { return std::uint32_t{entry.address}; }},
    {"x", 2, "int32, units: where a node or an anchor cannot be; else 0",
     [](const SnapshotQuarantined& entry) { return static_cast<std::uint32_t>(entry.position.x); }},
    {"y", 2, "int32, units",
     [](const SnapshotQuarantined& entry) { return static_cast<std::uint32_t>(entry.position.y); }},
    {"age_s", 2, "seconds it had been there when this generation was made",
     [](const SnapshotQuarantined& entry) { return entry.age_s; }},
}));
static_assert(static_cast<int>(QuarantineKind::node) == 1 &&
              static_cast<int>(QuarantineKind::feature) == 2 &&
              static_cast<int>(QuarantineKind::anchor) == 3 &&
              static_cast<int>(QuarantineKind::answer) == 4);

using HeaderRows = std::span<const RegisterRow<HeaderSource>>;
using VertexRows = std::span<const RegisterRow<SnapshotVertex>>;
using NeighbourRows = std::span<const RegisterRow<SnapshotNeighbour>>;
using RelayRows = std::span<const RegisterRow<ProposedRelay>>;
using HoleRows = std::span<const RegisterRow<CoverageHole>>;
using GapRows = std::span<const RegisterRow<BarrierGap>>;
using LongLinkRows = std::span<const RegisterRow<LongLink>>;
using QuarantinedRows = std::span<const RegisterRow<SnapshotQuarantined>>;
static_assert(has_plain_widths(HeaderRows(header_table)));
static_assert(has_plain_widths(VertexRows(vertex_table)));
static_assert(has_plain_widths(NeighbourRows(neighbour_table)));
static_assert(has_plain_widths(RelayRows(relay_table)));
static_assert(has_plain_widths(HoleRows(hole_table)));
static_assert(has_plain_widths(GapRows(gap_table)));
static_assert(has_plain_widths(LongLinkRows(long_link_table)));
static_assert(has_plain_widths(QuarantinedRows(quarantined_table)));
static_assert(size_of(HeaderRows(header_table)) <= block_size);
static_assert(size_of(VertexRows(vertex_table)) == vertex_registers);
static_assert(size_of(NeighbourRows(neighbour_table)) == neighbour_registers);
static_assert(size_of(RelayRows(relay_table)) == relay_registers);
static_assert(size_of(HoleRows(hole_table)) == hole_registers);
static_assert(size_of(GapRows(gap_table)) == gap_registers);
static_assert(size_of(LongLinkRows(long_link_table)) == long_link_registers);
static_assert(size_of(QuarantinedRows(quarantined_table)) == quarantined_registers);
static_assert(header_table[0].offset == 0 && header_table[0].registers == generation_registers);

// Masters in the field read version 1 as it is here. If one of these fails, a published register
// was renamed or moved: append behind these rows instead, or raise the version.
static_assert(fingerprint(HeaderRows(header_table).first(58)) == 0x0bacaa2c);
static_assert(fingerprint(VertexRows(vertex_table)) == 0x0efde454);
static_assert(fingerprint(NeighbourRows(neighbour_table)) == 0xd0a7cf4e);
static_assert(fingerprint(RelayRows(relay_table)) == 0x81679c81);
static_assert(fingerprint(HoleRows(hole_table)) == 0x86c9083f);
static_assert(fingerprint(GapRows(gap_table)) == 0x096a3f79);
static_assert(fingerprint(LongLinkRows(long_link_table)) == 0xa6a3a596);
static_assert(fingerprint(QuarantinedRows(quarantined_table)) == 0xe4612885);

}  // namespace

std::span<const RegisterRow<HeaderSource>> header_rows() { return header_table; }
std::span<const RegisterRow<SnapshotVertex>> vertex_rows() { return vertex_table; }
std::span<const RegisterRow<SnapshotNeighbour>> neighbour_rows() { return neighbour_table; }
std::span<const RegisterRow<ProposedRelay>> relay_rows() { return relay_table; }
std::span<const RegisterRow<CoverageHole>> hole_rows() { return hole_table; }
std::span<const RegisterRow<BarrierGap>> gap_rows() { return gap_table; }
std::span<const RegisterRow<LongLink>> long_link_rows() { return long_link_table; }
std::span<const RegisterRow<SnapshotQuarantined>> quarantined_rows() { return quarantined_table; }

}  // namespace etcm::firmware
