// The mesh as a picture one would show: SVG, y up, nodes, Steiner vertices, features, the domain
// shaded, scale bar, legend.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "etcm/files/mesh_image.h"

namespace etcm::files {

struct PictureText {
  std::string title;
  std::string unit = "units";  // what the scale bar counts
};

// What an analysis found, drawn over the mesh.
struct PictureMarks {
  // The domain is shaded within this distance of a sensor, and striking elsewhere; 0: no such
  // thing.
  std::uint32_t sensing_range = 0;  // in units
  std::vector<Point> sensors;
  std::vector<Point> holes;
  std::vector<Point> relays;
};

// Line widths and symbols follow the density of the mesh, from five nodes to many thousands.
std::string svg_text(const MeshImage& image, const PictureText& words,
                     const PictureMarks& marks = {});

}  // namespace etcm::files
