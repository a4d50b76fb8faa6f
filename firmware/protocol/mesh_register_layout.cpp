#include "firmware/protocol/mesh_register_layout.h"

namespace etcm::firmware {

namespace {

static_assert(generation_registers + block_vertices * vertex_registers <= block_size);
static_assert(generation_registers + block_neighbours * neighbour_registers <= block_size);
static_assert(generation_registers + block_relays * relay_registers <= block_size);
static_assert(generation_registers + block_holes * hole_registers <= block_size);
static_assert(generation_registers + block_gaps * gap_registers <= block_size);
static_assert(generation_registers + block_long_links * long_link_registers <= block_size);
static_assert(generation_registers + block_quarantined * quarantined_registers <= block_size);
static_assert(generation_registers + block_quantities * quantity_registers <= block_size);
static_assert(reading_generation_registers + block_readings * reading_registers <= block_size);
static_assert(registers_per_unit <= 65536);

}  // namespace

MeshRegisterLayout mesh_register_layout(const MeshRegisterCapacity& capacity) {
  std::uint32_t next = 1;  // behind the header
  const auto blocks = [&](std::uint64_t entries, std::uint32_t per_block) {
    const RegisterBlocks list{.first = next, .count = blocks_for(entries, per_block)};
    next = list.end();
    return list;
  };
  // In this order: braces evaluate from left to right.
  return {.vertices = blocks(capacity.vertices, block_vertices),
          .neighbours = blocks(std::uint64_t{capacity.vertices} * neighbours_per_vertex_max,
                               block_neighbours),
          .relays = blocks(capacity.relays, block_relays),
          .holes = blocks(capacity.holes, block_holes),
          .gaps = blocks(capacity.gaps, block_gaps),
          .long_links = blocks(capacity.long_links, block_long_links),
          .quarantine = blocks(capacity.quarantined, block_quarantined),
          .reading_head = blocks(capacity.readings == 0 ? 0 : 1, 1),
          .quantities = blocks(capacity.quantities, block_quantities),
          .readings = blocks(capacity.readings, block_readings)};
}

}  // namespace etcm::firmware
