#include "firmware/publish/mesh_registers.h"

#include <algorithm>

#include "firmware/protocol/register_pairs.h"
#include "firmware/publish/mesh_register_tables.h"
#include "firmware/publish/quarantine_reason.h"
#include "firmware/publish/reading_register_tables.h"

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

std::span<std::uint16_t> block_of(port::RegisterImage& image, std::uint32_t number) {
  return std::span(image.registers).subspan(std::size_t{number} * block_size, block_size);
}

}  // namespace

void encode_mesh(const Snapshot& snapshot, const MeshRegisterCapacity& capacity,
                 port::RegisterImage& image) {
  const MeshRegisterLayout layout = mesh_register_layout(capacity);
  const HeaderSource header{snapshot, layout};
  image.registers_per_unit = registers_per_unit;
  image.registers.assign(std::size_t{layout.block_count()} * block_size, 0);
  const auto block = [&](std::uint32_t number) { return block_of(image, number); };
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

void encode_readings(const ReadingSnapshot& readings, const MeshRegisterCapacity& capacity,
                     port::RegisterImage& image) {
  if (capacity.readings == 0) return;
  const MeshRegisterLayout layout = mesh_register_layout(capacity);
  const ReadingHeadSource head{readings, layout, capacity};
  put_all(block_of(image, layout.reading_head.first), reading_head_rows(), head);
  const std::size_t quantities =
      std::min<std::size_t>(readings.quantities.size(), capacity.quantities);
  for (std::uint32_t i = 0; i < quantities; ++i) {
    const std::size_t at =
        generation_registers + std::size_t{i % block_quantities} * quantity_registers;
    put_all(block_of(image, layout.quantities.first + i / block_quantities)
                .subspan(at, quantity_registers),
            quantity_rows(), readings.quantities[i]);
  }
  for (std::uint32_t number = 0; number < layout.readings.count; ++number) {
    const std::span block = block_of(image, layout.readings.first + number);
    std::fill(block.begin(), block.end(), std::uint16_t{0});
    put_all(block, reading_head_rows().first(2), head);
  }
  const std::size_t count = std::min<std::size_t>(readings.readings.size(), capacity.readings);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t at =
        reading_generation_registers + std::size_t{i % block_readings} * reading_registers;
    put_all(
        block_of(image, layout.readings.first + i / block_readings).subspan(at, reading_registers),
        reading_rows(), ReadingEntrySource{readings.readings[i], readings.taken_at});
  }
}

std::string describe_mesh_registers() {
  const Snapshot snapshot{};
  const ReadingSnapshot readings{};
  const MeshRegisterCapacity capacity{};
  const MeshRegisterLayout layout = mesh_register_layout(capacity);
  const auto list = [](const char* name, std::uint32_t count, const char* what,
                       std::uint32_t registers) {
    return "\n" + std::string(name) + " block: " + describe_block(count, what, registers);
  };
  std::string text =
      "Header: block 0" + describe(header_rows(), "", HeaderSource{snapshot, layout}) +
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
      "\nReading head: block `reading_head_block`" +
      describe(reading_head_rows(), "", ReadingHeadSource{readings, layout, capacity}) +
      list("Quantity", block_quantities, "quantities", quantity_registers) +
      describe(quantity_rows(), " of the quantity", Quantity{}) +
      "\nReading block: registers 0-1 the generation, 2-3 the sequence, then " +
      std::to_string(block_readings) + " readings of " + std::to_string(reading_registers) +
      " registers from register " + std::to_string(reading_generation_registers) +
      describe(reading_rows(), " of the reading", ReadingEntrySource{}) +
      "\n| reason | what it means |\n|---|---|\n";
  for (const QuarantineReason& reason : quarantine_reasons()) {
    text += "| " + std::to_string(reason.code) + " | " + reason.meaning + " |\n";
  }
  return text;
}

}  // namespace etcm::firmware
