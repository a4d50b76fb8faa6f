// What stands in which register of the gateway. The encoder writes by these tables and the tables
// of firmware/guide/registers.md are printed from them.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/publish/mesh_registers.h"
#include "firmware/publish/snapshot.h"

namespace etcm::firmware {

// One value of a header or of an entry of a list; its offset follows from the rows before it.
template <typename Source>
struct RegisterRow {
  const char* name;
  std::uint16_t registers;  // 1, or 2 with the high word first
  const char* content;      // for the guide; {} stands for a value that is always the same
  std::uint32_t (*value)(const Source&);
  std::uint16_t offset = 0;  // from the start of the block or of the entry
};

struct HeaderSource {
  const Snapshot& snapshot;
  const MeshRegisterLayout& layout;
};

// The first row of the header is the generation, with which every block begins.
std::span<const RegisterRow<HeaderSource>> header_rows();
std::span<const RegisterRow<SnapshotVertex>> vertex_rows();
std::span<const RegisterRow<SnapshotNeighbour>> neighbour_rows();
std::span<const RegisterRow<ProposedRelay>> relay_rows();
std::span<const RegisterRow<CoverageHole>> hole_rows();
std::span<const RegisterRow<BarrierGap>> gap_rows();
std::span<const RegisterRow<LongLink>> long_link_rows();
std::span<const RegisterRow<SnapshotQuarantined>> quarantined_rows();

}  // namespace etcm::firmware
