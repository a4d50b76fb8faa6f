// The mesh as a picture one would show: SVG, y up, nodes, Steiner vertices, features, the domain
// shaded, scale bar, legend.
#pragma once

#include <string>

#include "etcm/files/mesh_image.h"

namespace etcm::files {

struct PictureText {
  std::string title;
  std::string unit = "units";  // what the scale bar counts
};

// Line widths and symbols follow the density of the mesh, from five nodes to many thousands.
std::string svg_text(const MeshImage& image, const PictureText& words);

}  // namespace etcm::files
