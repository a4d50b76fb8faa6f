#include "mesh_map.h"

#include <algorithm>
#include <array>

#include "words.h"

namespace etcm::firmware {

namespace {

// A planar graph of n vertices has less than 3n edges, and each stands in two lists.
constexpr std::uint32_t neighbours_per_vertex_max = 6;

constexpr std::array<MapRow, 25> header_table{{
    {2, 1, "magic", "0x4D45; 0x454D shows swapped bytes"},
    {3, 1, "version", "1, the version of this map"},
    {4, 1, "state",
     "0 all well; bit 0 partial: a node or feature is not in the mesh; bit 1 stale: "
     "a node has not answered lately; bit 2 room or budget was too small"},
    {5, 1, "block_registers", "120"},
    {6, 1, "blocks_per_unit", "546"},
    {7, 1, "vertices_per_block", "7"},
    {8, 1, "neighbours_per_block", "59"},
    {9, 1, "reserved", "0"},
    {10, 2, "node_count", "nodes in the mesh"},
    {12, 2, "steiner_count", "Steiner vertices in the mesh"},
    {14, 2, "edge_count", "edges of the mesh"},
    {16, 2, "triangle_count", "triangles of the mesh"},
    {18, 2, "features_active", "features in the mesh"},
    {20, 2, "features_configured", "features in the configuration"},
    {22, 2, "quarantined_count", "nodes and features the mesh refused; the log has the reasons"},
    {24, 2, "stale_count", "nodes in the mesh that have not answered lately"},
    {26, 2, "oldest_age_ms",
     "age of the oldest position in the mesh when this generation was made"},
    {28, 2, "vertex_rows", "rows of the vertex table in use, free ones between them included"},
    {30, 2, "vertex_block_first", "number of the first vertex block"},
    {32, 2, "vertex_blocks", "vertex blocks there are; fixed by vertices_max"},
    {34, 2, "neighbour_entries", "entries of the neighbour list in use"},
    {36, 2, "neighbour_block_first", "number of the first neighbour block"},
    {38, 2, "neighbour_blocks", "neighbour blocks there are; fixed by vertices_max"},
    {40, 2, "mesh_hash_high", "the same for the same mesh, whatever its history; high half"},
    {42, 2, "mesh_hash_low", "low half"},
}};

constexpr std::array<MapRow, 9> vertex_table{{
    {0, 1, "kind", "0 free row, 1 node, 2 Steiner vertex; plus 0x0100 when the node is stale"},
    {1, 1, "degree", "count of neighbours"},
    {2, 2, "serial", "of a node; 0 for a Steiner vertex"},
    {4, 2, "feature",
     "number of the feature a Steiner vertex stands on, from 1 as configured; "
     "else 0"},
    {6, 2, "x", "int32, whole units (rounded down)"},
    {8, 2, "x_fraction", "what is left, in 2^-28 units; 0 for a node"},
    {10, 2, "y", "int32, whole units (rounded down)"},
    {12, 2, "y_fraction", "what is left, in 2^-28 units; 0 for a node"},
    {14, 2, "neighbour_first", "number of its first entry in the neighbour list"},
}};

// Rows follow each other without a gap, so no two of them share a register.
constexpr bool is_dense(std::span<const MapRow> rows, std::uint32_t begin, std::uint32_t end_max) {
  std::uint32_t next = begin;
  for (const MapRow& row : rows) {
    if (row.offset != next) return false;
    next += row.registers;
  }
  return next <= end_max;
}
static_assert(is_dense(header_table, generation_registers, block_size));
static_assert(is_dense(vertex_table, 0, vertex_registers));
static_assert(generation_registers + block_vertices * vertex_registers <= block_size);
static_assert(generation_registers + block_neighbours * neighbour_registers <= block_size);
static_assert(registers_per_unit <= 65536);

constexpr std::uint32_t blocks_for(std::uint64_t count, std::uint32_t per_block) {
  return static_cast<std::uint32_t>((count + per_block - 1) / per_block);
}

void put(std::span<std::uint16_t> registers, const MapRow& row, std::uint32_t value) {
  if (row.registers == 1) {
    registers[row.offset] = static_cast<std::uint16_t>(value);
  } else {
    store_u32(registers, row.offset, value);
  }
}

void encode_header(std::span<std::uint16_t> block, const Snapshot& snapshot,
                   const MeshMapLayout& layout) {
  const auto set = [&](HeaderField field, std::uint32_t value) {
    put(block, header_table[static_cast<std::size_t>(field)], value);
  };
  set(HeaderField::magic, mesh_magic);
  set(HeaderField::version, mesh_map_version);
  set(HeaderField::state, snapshot.state);
  set(HeaderField::block_registers, block_size);
  set(HeaderField::blocks_per_unit, unit_blocks);
  set(HeaderField::vertices_per_block, block_vertices);
  set(HeaderField::neighbours_per_block, block_neighbours);
  set(HeaderField::node_count, snapshot.node_count);
  set(HeaderField::steiner_count, snapshot.steiner_count);
  set(HeaderField::edge_count, snapshot.edge_count);
  set(HeaderField::triangle_count, snapshot.triangle_count);
  set(HeaderField::features_active, snapshot.features_active);
  set(HeaderField::features_configured, snapshot.features_configured);
  set(HeaderField::quarantined_count, snapshot.quarantined_count);
  set(HeaderField::stale_count, snapshot.stale_count);
  set(HeaderField::oldest_age_ms, snapshot.oldest_age_ms);
  set(HeaderField::vertex_rows, static_cast<std::uint32_t>(snapshot.vertices.size()));
  set(HeaderField::vertex_block_first, layout.vertex_block_first);
  set(HeaderField::vertex_blocks, layout.vertex_blocks);
  set(HeaderField::neighbour_entries, static_cast<std::uint32_t>(snapshot.neighbours.size()));
  set(HeaderField::neighbour_block_first, layout.neighbour_block_first);
  set(HeaderField::neighbour_blocks, layout.neighbour_blocks);
  set(HeaderField::mesh_hash_high, static_cast<std::uint32_t>(snapshot.mesh_hash >> 32));
  set(HeaderField::mesh_hash_low, static_cast<std::uint32_t>(snapshot.mesh_hash & 0xffffffffu));
}

// Whole units rounded down, and the sub-units that are left.
std::uint32_t whole(std::int64_t coordinate) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(coordinate >> subunit_bits));
}
std::uint32_t fraction(std::int64_t coordinate) {
  return static_cast<std::uint32_t>(coordinate & (subunits_per_unit - 1));
}

void encode_vertex(std::span<std::uint16_t> registers, const SnapshotVertex& vertex) {
  const auto set = [&](VertexField field, std::uint32_t value) {
    put(registers, vertex_table[static_cast<std::size_t>(field)], value);
  };
  set(VertexField::kind,
      static_cast<std::uint32_t>(vertex.kind) | (vertex.stale ? std::uint32_t{vertex_stale} : 0u));
  set(VertexField::degree, vertex.degree);
  set(VertexField::serial, vertex.serial);
  set(VertexField::feature, vertex.feature);
  set(VertexField::x, whole(vertex.point.x));
  set(VertexField::x_fraction, fraction(vertex.point.x));
  set(VertexField::y, whole(vertex.point.y));
  set(VertexField::y_fraction, fraction(vertex.point.y));
  set(VertexField::neighbour_first, vertex.first_neighbour);
}

void describe(std::string& out, std::span<const MapRow> rows) {
  for (const MapRow& row : rows) {
    const std::string last =
        row.registers == 1 ? "" : "-" + std::to_string(row.offset + row.registers - 1);
    out +=
        "| " + std::to_string(row.offset) + last + " | " + row.name + " | " + row.meaning + " |\n";
  }
}

}  // namespace

std::span<const MapRow> header_rows() { return header_table; }
std::span<const MapRow> vertex_rows() { return vertex_table; }

MeshMapLayout mesh_map_layout(std::uint32_t vertices_max) {
  MeshMapLayout layout;
  layout.vertex_blocks = blocks_for(vertices_max, block_vertices);
  layout.neighbour_block_first = layout.vertex_block_first + layout.vertex_blocks;
  layout.neighbour_blocks =
      blocks_for(std::uint64_t{vertices_max} * neighbours_per_vertex_max, block_neighbours);
  return layout;
}

std::uint32_t mesh_map_vertices_max() {
  // One block is the header, and either table may waste a part of its last one.
  constexpr std::uint64_t blocks = std::uint64_t{units_max} * unit_blocks - 3;
  constexpr std::uint64_t per_vertex =
      block_neighbours + neighbours_per_vertex_max * block_vertices;
  return static_cast<std::uint32_t>(blocks * block_vertices * block_neighbours / per_vertex);
}

port::RegisterImage encode_mesh(const Snapshot& snapshot, std::uint32_t vertices_max) {
  const MeshMapLayout layout = mesh_map_layout(vertices_max);
  port::RegisterImage image{
      .registers_per_unit = registers_per_unit,
      .registers = std::vector<std::uint16_t>(std::size_t{layout.block_count()} * block_size)};
  const auto block = [&](std::uint32_t number) {
    return std::span(image.registers).subspan(std::size_t{number} * block_size, block_size);
  };
  for (std::uint32_t number = 0; number < layout.block_count(); ++number) {
    store_u32(block(number), 0, snapshot.generation);
  }
  encode_header(block(0), snapshot, layout);
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    encode_vertex(
        block(layout.vertex_block_first + row / block_vertices)
            .subspan(generation_registers + std::size_t{row % block_vertices} * vertex_registers),
        snapshot.vertices[row]);
  }
  for (std::uint32_t entry = 0; entry < snapshot.neighbours.size(); ++entry) {
    const SnapshotNeighbour& neighbour = snapshot.neighbours[entry];
    store_u32(block(layout.neighbour_block_first + entry / block_neighbours),
              generation_registers + std::size_t{entry % block_neighbours} * neighbour_registers,
              neighbour.row | (neighbour.constrained ? neighbour_constrained : 0u));
  }
  return image;
}

std::string describe_mesh_map() {
  std::string out =
      "Header: block 0\n\n| register | name | content |\n|---|---|---|\n"
      "| 0-1 | generation | of this block, as in every block |\n";
  describe(out, header_table);
  out +=
      "\nVertex block: registers 0-1 the generation, then 7 vertices of 16 registers from register "
      "2\n\n| register of the vertex | name | content |\n|---|---|---|\n";
  describe(out, vertex_table);
  out +=
      "\nNeighbour block: registers 0-1 the generation, then 59 entries of 2 registers from "
      "register "
      "2\n\n| register of the entry | name | content |\n|---|---|---|\n"
      "| 0-1 | neighbour | row of the neighbour in the vertex table, from 0; bit 31 is set when "
      "the "
      "edge is part of a feature |\n";
  return out;
}

}  // namespace etcm::firmware
