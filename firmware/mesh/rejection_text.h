// Why the mesh has rejected something, in words.
#pragma once

#include "firmware/logging/text_line.h"
#include "firmware/mesh/kept_mesh.h"
#include "firmware/records/node_table.h"
#include "firmware/site/rejection.h"

namespace etcm::firmware {

// Adds to a line of the log why the mesh has just rejected something, and what is in its way.
void write_rejection(TextLine& text, const KeptMesh& kept, const NodeTable& nodes,
                     const Rejection& rejection);

}  // namespace etcm::firmware
