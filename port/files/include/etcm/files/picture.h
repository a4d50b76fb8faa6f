// The mesh as a picture one would show: SVG, y up, nodes, Steiner vertices, features, the domain
// shaded, scale bar, legend.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "etcm/files/mesh_image.h"
#include "etcm/files/outline.h"
#include "etcm/files/text_sink.h"

namespace etcm::files {

struct PictureText {
  std::string title;                // of a mesh without a name of its own
  std::string unit_name = "units";  // what the scale bar counts where metres are not known
  bool are_features_dashed = false;
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

// A place on the page in hundredths of a pixel, in which all paths of the map are drawn.
struct PictureSpot {
  std::int64_t x = 0;
  std::int64_t y = 0;
};

// What a picture is worked out in, kept from one to the next.
struct PictureRoom {
  // Takes all the memory now that a mesh of so many vertices needs.
  void reserve(std::size_t vertices);

  std::vector<std::int64_t> coordinates;
  std::vector<PictureSpot> spots;  // by vertex
  std::vector<double> lengths;     // of the edges
  Outline outline;
};

// Line widths and symbols follow the density of the mesh, from five nodes to many thousands.
void write_svg(TextSink& out, const MeshImage& image, const PictureText& words,
               const PictureMarks& marks, PictureRoom& room);
std::string svg_text(const MeshImage& image, const PictureText& words,
                     const PictureMarks& marks = {});

}  // namespace etcm::files
