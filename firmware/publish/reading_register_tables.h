// What stands in which register of the readings (mesh_register_tables.h).
#pragma once

#include <cstdint>
#include <span>

#include "firmware/protocol/mesh_register_layout.h"
#include "firmware/publish/reading_snapshot.h"
#include "firmware/publish/register_row.h"

namespace etcm::firmware {

struct ReadingHeadSource {
  const ReadingSnapshot& readings;
  const MeshRegisterLayout& layout;
  const MeshRegisterCapacity& capacity;
};

// An entry is made at the time of its snapshot.
struct ReadingEntrySource {
  PublishedReading reading;
  port::Instant snapshot_at{};
};

// The first two rows are generation and sequence, with which every block of readings begins.
std::span<const RegisterRow<ReadingHeadSource>> reading_head_rows();
std::span<const RegisterRow<Quantity>> quantity_rows();
std::span<const RegisterRow<ReadingEntrySource>> reading_rows();

}  // namespace etcm::firmware
