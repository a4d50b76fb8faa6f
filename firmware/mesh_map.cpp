#include "mesh_map.h"

#include "mesh_map_tables.h"
#include "words.h"

namespace etcm::firmware {

namespace {

// A planar graph of n vertices has less than 3n edges, and each stands in two lists.
constexpr std::uint32_t neighbours_per_vertex_max = 6;

static_assert(generation_registers + block_vertices * vertex_registers <= block_size);
static_assert(generation_registers + block_neighbours * neighbour_registers <= block_size);
static_assert(registers_per_unit <= 65536);

constexpr std::uint32_t blocks_for(std::uint64_t count, std::uint32_t per_block) {
  return static_cast<std::uint32_t>((count + per_block - 1) / per_block);
}

template <typename Source>
void put(std::span<std::uint16_t> registers, const MapRow<Source>& row, const Source& source) {
  const std::uint32_t value = row.value(source);
  if (row.registers == 1) {
    registers[row.offset] = static_cast<std::uint16_t>(value);
  } else {
    store_u32(registers, row.offset, value);
  }
}

template <typename Source>
void put_all(std::span<std::uint16_t> registers, std::span<const MapRow<Source>> rows,
             const Source& source) {
  for (const MapRow<Source>& row : rows) put(registers, row, source);
}

template <typename Source>
std::string content_of(const MapRow<Source>& row, const Source& empty) {
  std::string text = row.content;
  if (const std::size_t at = text.find("{}"); at != std::string::npos) {
    text.replace(at, 2, std::to_string(row.value(empty)));
  }
  return text;
}

template <typename Source>
std::string describe(std::span<const MapRow<Source>> rows, const char* whose, const Source& empty) {
  std::string text = "\n\n| register" + std::string(whose) + " | name | content |\n|---|---|---|\n";
  for (const MapRow<Source>& row : rows) {
    text += "| " + std::to_string(row.offset);
    if (row.registers > 1) text += "-" + std::to_string(row.offset + row.registers - 1);
    text += std::string(" | ") + row.name + " | " + content_of(row, empty) + " |\n";
  }
  return text;
}

// How many entries of how many registers a block other than the header has.
std::string describe_block(std::uint32_t count, const char* what, std::uint32_t registers) {
  return "registers 0-" + std::to_string(generation_registers - 1) + " the generation, then " +
         std::to_string(count) + " " + what + " of " + std::to_string(registers) +
         " registers from register " + std::to_string(generation_registers);
}

}  // namespace

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

void encode_mesh(const Snapshot& snapshot, std::uint32_t vertices_max, port::RegisterImage& image) {
  const MeshMapLayout layout = mesh_map_layout(vertices_max);
  const HeaderSource header{snapshot, layout};
  image.registers_per_unit = registers_per_unit;
  image.registers.assign(std::size_t{layout.block_count()} * block_size, 0);
  const auto block = [&](std::uint32_t number) {
    return std::span(image.registers).subspan(std::size_t{number} * block_size, block_size);
  };
  // Entry `index` of a table whose blocks begin with number `first`.
  const auto entry = [&](std::uint32_t first, std::uint32_t index, std::uint32_t per_block,
                         std::uint32_t registers) {
    return block(first + index / per_block)
        .subspan(generation_registers + std::size_t{index % per_block} * registers, registers);
  };
  for (std::uint32_t number = 0; number < layout.block_count(); ++number) {
    put(block(number), header_rows().front(), header);
  }
  put_all(block(0), header_rows(), header);
  for (std::uint32_t row = 0; row < snapshot.vertices.size(); ++row) {
    put_all(entry(layout.vertex_block_first, row, block_vertices, vertex_registers), vertex_rows(),
            snapshot.vertices[row]);
  }
  for (std::uint32_t number = 0; number < snapshot.neighbours.size(); ++number) {
    put_all(entry(layout.neighbour_block_first, number, block_neighbours, neighbour_registers),
            neighbour_rows(), snapshot.neighbours[number]);
  }
}

std::string describe_mesh_map() {
  const Snapshot snapshot{};
  const MeshMapLayout layout = mesh_map_layout(0);
  return "Header: block 0" + describe(header_rows(), "", HeaderSource{snapshot, layout}) +
         "\nVertex block: " + describe_block(block_vertices, "vertices", vertex_registers) +
         describe(vertex_rows(), " of the vertex", SnapshotVertex{}) +
         "\nNeighbour block: " + describe_block(block_neighbours, "entries", neighbour_registers) +
         describe(neighbour_rows(), " of the entry", SnapshotNeighbour{});
}

}  // namespace etcm::firmware
