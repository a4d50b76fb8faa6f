#include "etcm/files/exchange.h"

#include "etcm/files/decimal.h"

namespace etcm::files {

namespace {

constexpr double unit = static_cast<double>(subunits_per_unit);

class GeoJson {
 public:
  explicit GeoJson(const MeshImage& image) : image_(image) {}

  std::string make() {
    text_ =
        "{\"type\":\"FeatureCollection\",\n\"coordinates\":\"planar grid units, not longitude and "
        "latitude";
    if (!image_.unit_note.empty()) text_ += "; " + image_.unit_note;
    text_ += "\",\n\"features\":[";
    for (std::size_t i = 0; i < image_.triangles.size(); ++i) add_triangle(i);
    for (std::size_t i = 0; i < image_.subsegments.size(); ++i) add_subsegment(i);
    for (std::size_t i = 0; i < image_.vertices.size(); ++i) add_vertex(i);
    text_ += "\n]}\n";
    return std::move(text_);
  }

 private:
  void open(const char* geometry) {
    text_ += separator_;
    separator_ = ",";
    text_ += "\n{\"type\":\"Feature\",\"geometry\":{\"type\":\"";
    text_ += geometry;
    text_ += "\",\"coordinates\":";
  }

  void close(const char* kind, std::size_t index) {
    text_ += "},\"properties\":{\"kind\":\"";
    text_ += kind;
    text_ += "\",\"id\":" + std::to_string(static_cast<std::int64_t>(index) + image_.index_base);
  }

  void place(std::uint32_t vertex) {
    const Point& point = image_.vertices[vertex].point;
    text_ += '[';
    TextSink(text_) << static_cast<double>(point.x) / unit;
    text_ += ',';
    TextSink(text_) << static_cast<double>(point.y) / unit;
    text_ += ']';
  }

  void add_triangle(std::size_t index) {
    open("Polygon");
    text_ += "[[";
    for (const std::uint32_t corner : image_.triangles[index]) {
      place(corner);
      text_ += ',';
    }
    place(image_.triangles[index][0]);
    text_ += "]]";
    close("triangle", index);
    text_ += "}}";
  }

  void add_subsegment(std::size_t index) {
    const ImageSubsegment& subsegment = image_.subsegments[index];
    open("LineString");
    text_ += '[';
    place(subsegment.from);
    text_ += ',';
    place(subsegment.to);
    text_ += ']';
    close(subsegment.is_edge ? "subsegment" : "unresolved", index);
    text_ += ",\"marker\":" + std::to_string(subsegment.marker) + "}}";
  }

  void add_vertex(std::size_t index) {
    open("Point");
    place(static_cast<std::uint32_t>(index));
    close(image_.vertices[index].is_steiner ? "steiner" : "node", index);
    text_ += ",\"marker\":" + std::to_string(image_.vertices[index].marker) + "}}";
  }

  const MeshImage& image_;
  std::string text_;
  const char* separator_ = "";
};

void append_scalars(std::string& text, const char* name, const std::string& values) {
  text += std::string("SCALARS ") + name + " int 1\nLOOKUP_TABLE default\n" + values;
}

}  // namespace

std::string geojson_text(const MeshImage& image) { return GeoJson(image).make(); }

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
