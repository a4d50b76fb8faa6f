// The registers of the gateway: a snapshot laid out for Modbus masters.
//
// Which value stands where is in mesh_register_tables.h and reading_register_tables.h.
#pragma once

#include <cstdint>
#include <string>

#include "etcm/port/mesh_server.h"
#include "firmware/protocol/mesh_register_layout.h"
#include "firmware/publish/reading_snapshot.h"
#include "firmware/publish/snapshot.h"

namespace etcm::firmware {

// REQUIRES: no list of the snapshot is longer than its capacity.
// Into an image that is empty or of the same configuration; then it takes no memory.
void encode_mesh(const Snapshot& snapshot, const MeshRegisterCapacity& capacity,
                 port::RegisterImage& image);

// The readings, into an image that has the mesh of their generation and the same capacity. What is
// longer than its capacity is cut off. Takes no memory.
void encode_readings(const ReadingSnapshot& readings, const MeshRegisterCapacity& capacity,
                     port::RegisterImage& image);

// The tables, as Markdown; `etcm-gateway --register-map` prints them.
std::string describe_mesh_registers();

}  // namespace etcm::firmware
