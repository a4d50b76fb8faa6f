#include "firmware/publish/mesh_registers.h"

#include "firmware/protocol/register_pairs.h"
#include "firmware/publish/mesh_register_tables.h"
#include "firmware/publish/quarantine_reason.h"

namespace etcm::firmware {

namespace {

template <typename Source>
void put(std::span<std::uint16_t> registers, const RegisterRow<Source>& row, const Source& source) {
  const std::uint32_t value = row.value(source);
  if (row.registers == 1) {
    registers[row.offset] = static_cast<std::uint16_t>(value);
  } else {
    store_u32(registers, row.offset, value);
  }
}

template <typename Source>
void put_all(std::span<std::uint16_t> registers, std::span<const RegisterRow<Source>> rows,
             const Source& source) {
  for (const RegisterRow<Source>& row : rows) put(registers, row, source);
}

template <typename Source>
std::string content_of(const RegisterRow<Source>& row, const Source& empty) {
  std::string text = row.content;
  if (const std::size_t at = text.find("{}"); at != std::string::npos) {
    text.replace(at, 2, std::to_string(row.value(empty)));
  }
  return text;
}

template <typename Source>
std::string describe(std::span<const RegisterRow<Source>> rows, const char* whose,
                     const Source& empty) {
  std::string text = "\n\n| register" + std::string(whose) + " | name | content |\n|---|---|---|\n";
  for (const RegisterRow<Source>& row : rows) {
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

void encode_mesh(const Snapshot& snapshot, const MeshRegisterCapacity& capacity,
                 port::RegisterImage& image) {
  const MeshRegisterLayout layout = mesh_register_layout(capacity);
  const HeaderSource header{snapshot, layout};
  image.registers_per_unit = registers_per_unit;
  image.registers.assign(std::size_t{layout.block_count()} * block_size, 0);
  const auto block = [&](std::uint32_t number) {
    return std::span(image.registers).subspan(std::size_t{number} * block_size, block_size);
  };
  const auto put_list = [&](const RegisterBlocks& blocks, std::uint32_t per_block,
                            std::uint32_t registers, const auto& rows, const auto& entries) {
    for (std::uint32_t i = 0; i < entries.size(); ++i) {
      const std::size_t at = generation_registers + std::size_t{i % per_block} * registers;
      put_all(block(blocks.first + i / per_block).subspan(at, registers), rows, entries[i]);
    }
  };
  for (std::uint32_t number = 0; number < layout.block_count(); ++number) {
    put(block(number), header_rows().front(), header);
  }
  put_all(block(0), header_rows(), header);
  put_list(layout.vertices, block_vertices, vertex_registers, vertex_rows(), snapshot.vertices);
  put_list(layout.neighbours, block_neighbours, neighbour_registers, neighbour_rows(),
           snapshot.neighbours);
  const MeshAnalysis& analysis = snapshot.analysis;
  put_list(layout.relays, block_relays, relay_registers, relay_rows(), analysis.relays);
  put_list(layout.holes, block_holes, hole_registers, hole_rows(), analysis.holes);
  put_list(layout.gaps, block_gaps, gap_registers, gap_rows(), analysis.gaps);
  put_list(layout.long_links, block_long_links, long_link_registers, long_link_rows(),
           analysis.long_links);
  put_list(layout.quarantine, block_quarantined, quarantined_registers, quarantined_rows(),
           snapshot.quarantine);
}

std::string describe_mesh_registers() {
  const Snapshot snapshot{};
  const MeshRegisterLayout layout = mesh_register_layout({});
  const auto list = [](const char* name, std::uint32_t count, const char* what,
                       std::uint32_t registers) {
    return "\n" + std::string(name) + " block: " + describe_block(count, what, registers);
  };
  std::string text = "Header: block 0" +
                     describe(header_rows(), "", HeaderSource{snapshot, layout}) +
                     list("Vertex", block_vertices, "vertices", vertex_registers) +
                     describe(vertex_rows(), " of the vertex", SnapshotVertex{}) +
                     list("Neighbour", block_neighbours, "entries", neighbour_registers) +
                     describe(neighbour_rows(), " of the entry", SnapshotNeighbour{}) +
                     list("Relay", block_relays, "relays", relay_registers) +
                     describe(relay_rows(), " of the relay", ProposedRelay{}) +
                     list("Hole", block_holes, "holes", hole_registers) +
                     describe(hole_rows(), " of the hole", CoverageHole{}) +
                     list("Gap", block_gaps, "gaps", gap_registers) +
                     describe(gap_rows(), " of the gap", BarrierGap{}) +
                     list("Long link", block_long_links, "links", long_link_registers) +
                     describe(long_link_rows(), " of the link", LongLink{}) +
                     list("Quarantine", block_quarantined, "entries", quarantined_registers) +
                     describe(quarantined_rows(), " of the entry", SnapshotQuarantined{}) +
                     "\n| reason | what it means |\n|---|---|\n";
  for (const QuarantineReason& reason : quarantine_reasons()) {
    text += "| " + std::to_string(reason.code) + " | " + reason.meaning + " |\n";
  }
  return text;
}

}  // namespace etcm::firmware
