// A mesh in Triangle's files: BASE.node, BASE.ele, BASE.edge and BASE.poly.
#pragma once

#include <string>

#include "etcm/files/file_set.h"
#include "etcm/files/mesh_image.h"
#include "etcm/files/text_sink.h"

namespace etcm::files {

void write_node(TextSink& out, const MeshImage& image);
void write_ele(TextSink& out, const MeshImage& image);
void write_edge(TextSink& out, const MeshImage& image);
// Subsegments with their feature's marker, holes, regions; its nodes are in the .node.
void write_poly(TextSink& out, const MeshImage& image);

// All four. `image` is needed until they are committed.
void add_mesh_files(const MeshImage& image, const std::string& base, FileSet& files);

// Reads the four files back. Throws InputError for anything add_mesh_files would not write:
// coordinates off the sub-unit grid, indices out of range. Nothing geometric is checked.
// Vertices are Steiner vertices where their marker is the lowest of the file and negative; a
// subsegment's feature is unknown (0), and it is an edge where the .edge has it.
MeshImage read_mesh(const std::string& base);

}  // namespace etcm::files
