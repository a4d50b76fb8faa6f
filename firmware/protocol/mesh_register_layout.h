// Where everything stands in the registers of the gateway: blocks, and how many entries each has.
//
// What stands in an entry is in firmware/publish/mesh_register_tables.h.
#pragma once

#include <cstdint>

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
inline constexpr std::uint32_t relay_registers = 12;
inline constexpr std::uint32_t block_relays = 9;
inline constexpr std::uint32_t hole_registers = 12;
inline constexpr std::uint32_t block_holes = 9;
inline constexpr std::uint32_t gap_registers = 8;
inline constexpr std::uint32_t block_gaps = 14;
inline constexpr std::uint32_t long_link_registers = 4;
inline constexpr std::uint32_t block_long_links = 29;
inline constexpr std::uint32_t quarantined_registers = 14;
inline constexpr std::uint32_t block_quarantined = 8;
inline constexpr std::uint32_t quantity_registers = 36;
inline constexpr std::uint32_t block_quantities = 3;
// Blocks of readings begin with the generation and the sequence of the readings.
inline constexpr std::uint32_t reading_generation_registers = 4;
inline constexpr std::uint32_t reading_registers = 14;
inline constexpr std::uint32_t block_readings = 8;
inline constexpr std::uint32_t units_max = 247;

// Lists of the analysis, and that of the quarantine, are cut off at these lengths; the counts
// beside them are not.
inline constexpr std::uint32_t analysis_list_max = 1000;
inline constexpr std::uint32_t quarantine_listed_max = 1000;
// So are quantities and readings.
inline constexpr std::uint32_t quantities_listed_max = 300;
inline constexpr std::uint32_t readings_listed_max = 10000;

// A planar graph of n vertices has less than 3n edges, and each stands in two lists.
inline constexpr std::uint32_t neighbours_per_vertex_max = 6;

// The most entries of each list: fixed for a configuration.
struct MeshRegisterCapacity {
  std::uint32_t vertices = 0;
  std::uint32_t relays = 0;
  std::uint32_t holes = 0;
  std::uint32_t gaps = 0;
  std::uint32_t long_links = 0;
  std::uint32_t quarantined = 0;
  std::uint32_t quantities = 0;
  std::uint32_t readings = 0;  // 0: no device measures
  friend bool operator==(const MeshRegisterCapacity&, const MeshRegisterCapacity&) = default;
};

// The blocks of one list.
struct RegisterBlocks {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::uint32_t end() const { return first + count; }
};

// Where everything is: fixed for a configuration, so a master's addresses do not change while nodes
// join.
struct MeshRegisterLayout {
  RegisterBlocks vertices;
  RegisterBlocks neighbours;
  RegisterBlocks relays;
  RegisterBlocks holes;
  RegisterBlocks gaps;
  RegisterBlocks long_links;
  RegisterBlocks quarantine;
  RegisterBlocks reading_head;  // one block, or none
  RegisterBlocks quantities;
  RegisterBlocks readings;
  std::uint32_t block_count() const { return readings.end(); }
};
MeshRegisterLayout mesh_register_layout(const MeshRegisterCapacity& capacity);

constexpr std::uint32_t blocks_for(std::uint64_t count, std::uint32_t per_block) {
  return static_cast<std::uint32_t>((count + per_block - 1) / per_block);
}

// The most vertices the units can hold, beside the longest lists.
constexpr std::uint32_t mesh_registers_vertices_max() {
  constexpr std::uint32_t list_max = analysis_list_max;
  constexpr std::uint64_t lists =
      blocks_for(list_max, block_relays) + blocks_for(list_max, block_holes) +
      blocks_for(list_max, block_gaps) + blocks_for(list_max, block_long_links) +
      blocks_for(quarantine_listed_max, block_quarantined) + 1 +
      blocks_for(quantities_listed_max, block_quantities) +
      blocks_for(readings_listed_max, block_readings);
  // One block is the header, and either table may waste a part of its last one.
  constexpr std::uint64_t blocks = std::uint64_t{units_max} * unit_blocks - 3 - lists;
  constexpr std::uint64_t per_vertex =
      block_neighbours + neighbours_per_vertex_max * block_vertices;
  return static_cast<std::uint32_t>(blocks * block_vertices * block_neighbours / per_vertex);
}

}  // namespace etcm::firmware
