#include <string>

#include "etcm/files/decimal.h"
#include "etcm/files/mesh_text.h"

namespace etcm::files {

namespace {

std::string header(const MeshImage& image) {
  std::string text = "# etcm: " + std::to_string(image.node_count) +
                     " nodes, Steiner vertices: " + std::to_string(image.steiner_count());
  if (image.steiner_count() > 0) {
    text += " (marker " + std::to_string(image.vertices.back().marker) + ")";
  }
  text += ", " + std::to_string(image.triangles.size()) + " triangles\n";
  if (!image.unit_note.empty()) text += "# " + image.unit_note + "\n";
  return text;
}

void append(std::string& text, std::int64_t value) { text += std::to_string(value); }

void append_fields(std::string& text, std::initializer_list<std::int64_t> values) {
  const char* separator = "";
  for (const std::int64_t value : values) {
    text += separator;
    append(text, value);
    separator = " ";
  }
}

}  // namespace

std::string node_text(const MeshImage& image) {
  std::string text = header(image);
  append_fields(text, {static_cast<std::int64_t>(image.vertices.size()), 2,
                       static_cast<std::int64_t>(image.attribute_count), 1});
  text += '\n';
  for (std::size_t i = 0; i < image.vertices.size(); ++i) {
    const ImageVertex& vertex = image.vertices[i];
    append(text, static_cast<std::int64_t>(i) + image.index_base);
    text += ' ';
    append_coordinate(text, vertex.point.x);
    text += ' ';
    append_coordinate(text, vertex.point.y);
    for (std::size_t a = 0; a < image.attribute_count; ++a) {
      text += ' ';
      text += image.attributes[i * image.attribute_count + a];
    }
    text += ' ';
    append(text, vertex.marker);
    text += '\n';
  }
  return text;
}

std::string ele_text(const MeshImage& image) {
  std::string text = header(image);
  append_fields(text, {static_cast<std::int64_t>(image.triangles.size()), 3, 0});
  text += '\n';
  std::int64_t number = image.index_base;
  for (const auto& corner : image.triangles) {
    append_fields(text, {number++, std::int64_t{corner[0]} + image.index_base,
                         std::int64_t{corner[1]} + image.index_base,
                         std::int64_t{corner[2]} + image.index_base});
    text += '\n';
  }
  return text;
}

std::string edge_text(const MeshImage& image) {
  std::string text = header(image);
  append_fields(text, {static_cast<std::int64_t>(image.edges.size()), 1});
  text += '\n';
  std::int64_t number = image.index_base;
  for (const ImageEdge& edge : image.edges) {
    append_fields(text, {number++, std::int64_t{edge.from} + image.index_base,
                         std::int64_t{edge.to} + image.index_base, edge.marker});
    text += '\n';
  }
  return text;
}

std::string poly_text(const MeshImage& image) {
  std::string text = header(image);
  append_fields(text, {0, 2, static_cast<std::int64_t>(image.attribute_count), 1});
  text += '\n';
  append_fields(text, {static_cast<std::int64_t>(image.subsegments.size()), 1});
  text += '\n';
  std::int64_t number = image.index_base;
  for (const ImageSubsegment& piece : image.subsegments) {
    append_fields(text, {number++, std::int64_t{piece.from} + image.index_base,
                         std::int64_t{piece.to} + image.index_base, piece.marker});
    text += '\n';
  }
  append(text, static_cast<std::int64_t>(image.holes.size()));
  text += '\n';
  number = image.index_base;
  for (const GraphHole& hole : image.holes) {
    append(text, number++);
    text += ' ' + hole.x.to_string() + ' ' + hole.y.to_string() + '\n';
  }
  if (image.regions.empty()) return text;
  append(text, static_cast<std::int64_t>(image.regions.size()));
  text += '\n';
  number = image.index_base;
  for (const GraphRegion& region : image.regions) {
    append(text, number++);
    text += ' ' + region.x.to_string() + ' ' + region.y.to_string();
    for (const std::string& value : region.values) text += ' ' + value;
    text += '\n';
  }
  return text;
}

void add_mesh_files(const MeshImage& image, const std::string& base, FileSet& files) {
  files.add(base + ".node", node_text(image));
  files.add(base + ".ele", ele_text(image));
  files.add(base + ".edge", edge_text(image));
  files.add(base + ".poly", poly_text(image));
}

}  // namespace etcm::files
