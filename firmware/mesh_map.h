// The registers of the gateway: a snapshot laid out for Modbus masters.
//
// All tables of firmware/README.md are printed from the rows below (`etcm-gateway
// --register-map`), and the encoder writes by the same rows.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "etcm/port/mesh_server.h"
#include "snapshot.h"

namespace etcm::firmware {

// The image is a row of blocks; each begins with the generation, so that a reader can tell whether
// what it read belongs together. No block lies across two units.
inline constexpr std::uint32_t block_size = 120;
inline constexpr std::uint32_t unit_blocks = 546;
inline constexpr std::uint32_t registers_per_unit = block_size * unit_blocks;
inline constexpr std::uint32_t generation_registers = 2;
inline constexpr std::uint32_t vertex_registers = 16;
inline constexpr std::uint32_t block_vertices = 7;
inline constexpr std::uint32_t neighbour_registers = 2;
inline constexpr std::uint32_t block_neighbours = 59;
inline constexpr std::uint32_t units_max = 247;

// Where everything is, for a mesh of at most vertices_max vertices: fixed for a configuration, so a
// master's addresses do not change while nodes join.
struct MeshMapLayout {
  std::uint32_t vertex_block_first = 1;
  std::uint32_t vertex_blocks = 0;
  std::uint32_t neighbour_block_first = 1;
  std::uint32_t neighbour_blocks = 0;
  std::uint32_t block_count() const { return neighbour_block_first + neighbour_blocks; }
};
MeshMapLayout mesh_map_layout(std::uint32_t vertices_max);

// The most vertices the units can hold.
std::uint32_t mesh_map_vertices_max();

// REQUIRES: snapshot.vertices.size() <= vertices_max.
port::RegisterImage encode_mesh(const Snapshot& snapshot, std::uint32_t vertices_max);

// The tables, as Markdown.
std::string describe_mesh_map();

// One value of a block.
enum class HeaderField : std::uint8_t {
  magic,
  version,
  state,
  block_registers,
  blocks_per_unit,
  vertices_per_block,
  neighbours_per_block,
  reserved,
  node_count,
  steiner_count,
  edge_count,
  triangle_count,
  features_active,
  features_configured,
  quarantined_count,
  stale_count,
  oldest_age_ms,
  vertex_rows,
  vertex_block_first,
  vertex_blocks,
  neighbour_entries,
  neighbour_block_first,
  neighbour_blocks,
  mesh_hash_high,
  mesh_hash_low
};
enum class VertexField : std::uint8_t {
  kind,
  degree,
  serial,
  feature,
  x,
  x_fraction,
  y,
  y_fraction,
  neighbour_first
};

struct MapRow {
  std::uint16_t offset;  // from the start of the block or of the vertex
  std::uint16_t registers;
  const char* name;
  const char* meaning;
};

// Rows in the order of the enumerations.
std::span<const MapRow> header_rows();
std::span<const MapRow> vertex_rows();

inline constexpr std::uint16_t mesh_magic = 0x4D45;
inline constexpr std::uint16_t mesh_map_version = 1;
inline constexpr std::uint16_t vertex_kind_mask = 0x00ff;  // 0 free row, 1 node, 2 Steiner vertex
inline constexpr std::uint16_t vertex_stale = 0x0100;
inline constexpr std::uint32_t neighbour_constrained = 0x80000000u;

}  // namespace etcm::firmware
