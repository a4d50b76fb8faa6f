// The mesh in formats other programs read. Coordinates are doubles in full: every place of the grid
// is one, so nothing is lost.
#pragma once

#include <string>

#include "etcm/files/mesh_image.h"
#include "etcm/files/text_sink.h"

namespace etcm::files {

// A FeatureCollection: a Polygon for each triangle, a LineString for each subsegment, a Point for
// each vertex; the property "kind" tells them apart. Planar coordinates, not longitude and
// latitude: the member "coordinates" says so. What the image has of a vertex beside its place is a
// property by its name.
void write_geojson(TextSink& out, const MeshImage& image);
std::string geojson_text(const MeshImage& image);

// A legacy ASCII unstructured grid for ParaView: triangles, subsegments and vertices as cells with
// the scalar "kind" (0 triangle, 1 subsegment, 2 node, 3 Steiner vertex), and "marker".
std::string vtk_text(const MeshImage& image);

}  // namespace etcm::files
