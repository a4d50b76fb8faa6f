// The registers of the gateway: a snapshot laid out for Modbus masters.
//
// Which value stands where is in mesh_map_tables.h.
#pragma once

#include <cstdint>
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
// Into an image that is empty or of the same configuration; then it takes no memory.
void encode_mesh(const Snapshot& snapshot, std::uint32_t vertices_max, port::RegisterImage& image);

// The tables, as Markdown; `etcm-gateway --register-map` prints them.
std::string describe_mesh_map();

}  // namespace etcm::firmware
