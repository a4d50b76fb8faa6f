// What stands in which register of the gateway. The encoder writes by these tables and the tables
// of firmware/guide/registers.md are printed from them.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/publish/mesh_registers.h"
#include "firmware/publish/register_row.h"
#include "firmware/publish/snapshot.h"

namespace etcm::firmware {

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
