#include <string>

#include "etcm/files/decimal.h"
#include "etcm/files/mesh_text.h"

namespace etcm::files {

namespace {

void write_header(TextSink& out, const MeshImage& image) {
  out << "# etcm: " << image.node_count << " nodes, Steiner vertices: " << image.steiner_count();
  if (image.steiner_count() > 0) out << " (marker " << image.vertices.back().marker << ")";
  out << ", " << image.triangles.size() << " triangles";
  if (image.mesh_hash != 0) {
    out << ", mesh ";
    for (int shift = 60; shift >= 0; shift -= 4) {
      out << "0123456789abcdef"[image.mesh_hash >> shift & 0xf];
    }
  }
  out << '\n';
  if (!image.unit_note.empty()) out << "# " << image.unit_note << "\n";
}

void write_line(TextSink& out, std::initializer_list<std::int64_t> values) {
  std::string_view separator;
  for (const std::int64_t value : values) {
    out << separator << value;
    separator = " ";
  }
  out << '\n';
}

std::int64_t count(const auto& list) { return static_cast<std::int64_t>(list.size()); }

}  // namespace

void write_node(TextSink& out, const MeshImage& image) {
  write_header(out, image);
  write_line(out, {count(image.vertices), 2, static_cast<std::int64_t>(image.attribute_count), 1});
  for (std::size_t i = 0; i < image.vertices.size(); ++i) {
    const ImageVertex& vertex = image.vertices[i];
    out << static_cast<std::int64_t>(i) + image.index_base << ' ';
    write_coordinate(out, vertex.point.x);
    out << ' ';
    write_coordinate(out, vertex.point.y);
    for (std::size_t a = 0; a < image.attribute_count; ++a) {
      out << ' ' << image.attributes[i * image.attribute_count + a];
    }
    out << ' ' << vertex.marker << '\n';
  }
}

void write_ele(TextSink& out, const MeshImage& image) {
  write_header(out, image);
  write_line(out, {count(image.triangles), 3, 0});
  std::int64_t number = image.index_base;
  for (const auto& corner : image.triangles) {
    write_line(out, {number++, std::int64_t{corner[0]} + image.index_base,
                     std::int64_t{corner[1]} + image.index_base,
                     std::int64_t{corner[2]} + image.index_base});
  }
}

void write_edge(TextSink& out, const MeshImage& image) {
  write_header(out, image);
  write_line(out, {count(image.edges), 1});
  std::int64_t number = image.index_base;
  for (const ImageEdge& edge : image.edges) {
    write_line(out, {number++, std::int64_t{edge.from} + image.index_base,
                     std::int64_t{edge.to} + image.index_base, edge.marker});
  }
}

void write_poly(TextSink& out, const MeshImage& image) {
  write_header(out, image);
  write_line(out, {0, 2, static_cast<std::int64_t>(image.attribute_count), 1});
  write_line(out, {count(image.subsegments), 1});
  std::int64_t number = image.index_base;
  for (const ImageSubsegment& subsegment : image.subsegments) {
    write_line(out, {number++, std::int64_t{subsegment.from} + image.index_base,
                     std::int64_t{subsegment.to} + image.index_base, subsegment.marker});
  }
  write_line(out, {count(image.holes)});
  number = image.index_base;
  for (const GraphHole& hole : image.holes) {
    out << number++ << ' ' << hole.x.to_string() << ' ' << hole.y.to_string() << '\n';
  }
  if (image.regions.empty()) return;
  write_line(out, {count(image.regions)});
  number = image.index_base;
  for (const GraphRegion& region : image.regions) {
    out << number++ << ' ' << region.x.to_string() << ' ' << region.y.to_string();
    for (const std::string& value : region.values) out << ' ' << value;
    out << '\n';
  }
}

void add_mesh_files(const MeshImage& image, const std::string& base, FileSet& files) {
  files.add(base + ".node", [&](TextSink& out) { write_node(out, image); });
  files.add(base + ".ele", [&](TextSink& out) { write_ele(out, image); });
  files.add(base + ".edge", [&](TextSink& out) { write_edge(out, image); });
  files.add(base + ".poly", [&](TextSink& out) { write_poly(out, image); });
}

}  // namespace etcm::files
