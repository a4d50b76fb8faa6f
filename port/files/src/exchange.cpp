#include "etcm/files/exchange.h"

#include "etcm/files/decimal.h"

namespace etcm::files {

namespace {

constexpr double unit = static_cast<double>(subunits_per_unit);

class GeoJson {
 public:
  GeoJson(TextSink& out, const MeshImage& image) : out_(out), image_(image) {}

  void write() {
    out_ << "{\"type\":\"FeatureCollection\",\n";
    if (!image_.name.empty()) {
      out_ << "\"name\":";
      write_text(image_.name);
      out_ << ",\n";
    }
    if (image_.degrees.empty()) {
      out_ << "\"coordinates\":\"planar grid units, not longitude and latitude";
      if (!image_.unit_note.empty()) out_ << "; " << image_.unit_note;
      out_ << "\",\n";
    }
    out_ << "\"features\":[";
    for (std::size_t i = 0; i < image_.triangles.size(); ++i) write_triangle(i);
    for (std::size_t i = 0; i < image_.subsegments.size(); ++i) write_subsegment(i);
    for (std::size_t i = 0; i < image_.vertices.size(); ++i) write_vertex(i);
    out_ << "\n]}\n";
  }

 private:
  void open(const char* geometry) {
    out_ << separator_ << "\n{\"type\":\"Feature\",\"geometry\":{\"type\":\"" << geometry
         << "\",\"coordinates\":";
    separator_ = ",";
  }

  void close(const char* kind, std::size_t index) {
    out_ << "},\"properties\":{\"kind\":\"" << kind
         << "\",\"id\":" << static_cast<std::int64_t>(index) + image_.index_base;
  }

  void write_text(const std::string& text) {
    out_ << '"';
    for (const char letter : text) {
      if (letter == '"' || letter == '\\') out_ << '\\';
      out_ << letter;
    }
    out_ << '"';
  }

  void place(std::uint32_t vertex) {
    if (!image_.degrees.empty()) {
      out_ << '[';
      write_nano(out_, image_.degrees[vertex].longitude);
      out_ << ',';
      write_nano(out_, image_.degrees[vertex].latitude);
      out_ << ']';
      return;
    }
    const Point& point = image_.vertices[vertex].point;
    out_ << '[' << static_cast<double>(point.x) / unit << ',' << static_cast<double>(point.y) / unit
         << ']';
  }

  void write_triangle(std::size_t index) {
    open("Polygon");
    out_ << "[[";
    for (const std::uint32_t corner : image_.triangles[index]) {
      place(corner);
      out_ << ',';
    }
    place(image_.triangles[index][0]);
    out_ << "]]";
    close("triangle", index);
    out_ << "}}";
  }

  void write_subsegment(std::size_t index) {
    const ImageSubsegment& subsegment = image_.subsegments[index];
    open("LineString");
    out_ << '[';
    place(subsegment.from);
    out_ << ',';
    place(subsegment.to);
    out_ << ']';
    close(subsegment.is_edge ? "subsegment" : "unresolved", index);
    out_ << ",\"marker\":" << subsegment.marker << "}}";
  }

  // Values follow the vertices.
  void write_vertex(std::size_t index) {
    open("Point");
    place(static_cast<std::uint32_t>(index));
    close(image_.vertices[index].is_steiner ? "steiner" : "node", index);
    out_ << ",\"marker\":" << image_.vertices[index].marker;
    if (!image_.degrees.empty()) {
      const Point& point = image_.vertices[index].point;
      out_ << ",\"x\":" << static_cast<double>(point.x) / unit
           << ",\"y\":" << static_cast<double>(point.y) / unit;
    }
    for (; value_ < image_.values.size() && image_.values[value_].vertex == index; ++value_) {
      const ImageValue& value = image_.values[value_];
      out_ << ',';
      write_text(image_.value_names[value.name]);
      out_ << ':';
      value.nano ? write_nano(out_, *value.nano) : void(out_ << "null");
    }
    out_ << "}}";
  }

  TextSink& out_;
  const MeshImage& image_;
  const char* separator_ = "";
  std::size_t value_ = 0;  // the next
};

void append_scalars(std::string& text, const char* name, const std::string& values) {
  text += std::string("SCALARS ") + name + " int 1\nLOOKUP_TABLE default\n" + values;
}

}  // namespace

void write_geojson(TextSink& out, const MeshImage& image) { GeoJson(out, image).write(); }

std::string geojson_text(const MeshImage& image) { return text_of(write_geojson, image); }

std::string vtk_text(const MeshImage& image) {
  const std::size_t triangles = image.triangles.size();
  const std::size_t lines = image.subsegments.size();
  const std::size_t points = image.vertices.size();
  const std::size_t cells = triangles + lines + points;
  std::string text = "# vtk DataFile Version 3.0\netcm mesh\nASCII\nDATASET UNSTRUCTURED_GRID\n";
  text += "POINTS " + std::to_string(points) + " double\n";
  for (const ImageVertex& vertex : image.vertices) {
    TextSink(text) << static_cast<double>(vertex.point.x) / unit;
    text += ' ';
    TextSink(text) << static_cast<double>(vertex.point.y) / unit;
    text += " 0\n";
  }
  std::string types;
  std::string kinds;
  std::string markers;
  const auto add_cell = [&](const char* type, int kind, int marker) {
    types += type;
    kinds += std::to_string(kind) + "\n";
    markers += std::to_string(marker) + "\n";
  };
  text += "CELLS " + std::to_string(cells) + " " +
          std::to_string(4 * triangles + 3 * lines + 2 * points) + "\n";
  for (const auto& corner : image.triangles) {
    text += "3 " + std::to_string(corner[0]) + " " + std::to_string(corner[1]) + " " +
            std::to_string(corner[2]) + "\n";
    add_cell("5\n", 0, 0);
  }
  for (const ImageSubsegment& subsegment : image.subsegments) {
    text += "2 " + std::to_string(subsegment.from) + " " + std::to_string(subsegment.to) + "\n";
    add_cell("3\n", 1, subsegment.marker);
  }
  for (std::size_t i = 0; i < points; ++i) {
    text += "1 " + std::to_string(i) + "\n";
    add_cell("1\n", image.vertices[i].is_steiner ? 3 : 2, image.vertices[i].marker);
  }
  text += "CELL_TYPES " + std::to_string(cells) + "\n" + types;
  text += "CELL_DATA " + std::to_string(cells) + "\n";
  append_scalars(text, "kind", kinds);
  append_scalars(text, "marker", markers);
  return text;
}

}  // namespace etcm::files
