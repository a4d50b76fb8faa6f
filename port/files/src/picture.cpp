#include "etcm/files/picture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>
#include <utility>
#include <vector>

#include "etcm/files/decimal.h"
#include "etcm/files/outline.h"

namespace etcm::files {

namespace {

// Pixels.
constexpr double page_width = 1200;
constexpr double margin = 48;
constexpr double header_height = 104;
constexpr double footer_height = 84;
constexpr double map_width_max = page_width - 2 * margin;
constexpr double map_height_max = 1100;
constexpr double map_height_min = 120;

constexpr const char* ink = "#1c2733";
constexpr const char* soft_ink = "#5d6b7a";
constexpr const char* domain_fill = "#e6eff7";
constexpr const char* edge_colour = "#8fa9c2";
constexpr const char* feature_colour = "#16324f";
constexpr const char* node_colour = "#1f6fb2";
constexpr const char* steiner_colour = "#d9480f";
constexpr const char* unseen_fill = "#f6c9bd";
constexpr const char* hole_colour = "#b3261e";
constexpr const char* relay_colour = "#6d3fc0";
constexpr const char* unresolved_colour = "#c2185b";

// Thin spaces between groups of three digits.
std::string grouped(std::size_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, "\xE2\x80\xAF");
  return text;
}

std::string counted(std::size_t number, const char* one, const char* many) {
  return grouped(number) + " " + (number == 1 ? one : many);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        // A file name may hold any bytes; a picture may not.
        out += c >= ' ' && c <= '~' ? c : '?';
    }
  }
  return out;
}

// A length in pixels with two decimals at most, the same text everywhere.
std::string px(double value) {
  const long long hundredths = std::llround(value * 100);
  std::string text = hundredths < 0 ? "-" : "";
  text += std::to_string(std::llabs(hundredths) / 100);
  const long long rest = std::llabs(hundredths) % 100;
  if (rest == 0) return text;
  text += rest < 10 ? ".0" : ".";
  text += rest % 10 == 0 ? std::to_string(rest / 10) : std::to_string(rest);
  return text;
}

// A place on the page in hundredths of a pixel, in which all paths of the map are drawn.
struct Spot {
  long long x = 0;
  long long y = 0;
};

// Where a handful of vertices stands so far off that the rest would shrink to a corner, the picture
// leaves them out (and says so): less than 1 % of all, beyond a gap of a third of the extent.
std::pair<std::int64_t, std::int64_t> extent_without_outliers(std::vector<std::int64_t> values) {
  if (values.empty()) return {0, 0};
  std::sort(values.begin(), values.end());
  const std::size_t few = values.size() / 100;
  std::size_t first = 0;
  std::size_t last = values.size() - 1;
  const std::int64_t gap = (values[last] - values[first]) / 3;
  for (std::size_t i = 0; i < few; ++i) {
    if (values[i + 1] - values[i] > gap) first = i + 1;
    const std::size_t j = values.size() - 1 - i;
    if (values[j] - values[j - 1] > gap) last = j - 1;
  }
  return {values[first], values[last]};
}

class Map {
 public:
  explicit Map(const MeshImage& image) {
    std::vector<std::int64_t> xs;
    std::vector<std::int64_t> ys;
    for (const ImageVertex& vertex : image.vertices) {
      xs.push_back(vertex.point.x);
      ys.push_back(vertex.point.y);
    }
    std::tie(low_.x, high_.x) = extent_without_outliers(std::move(xs));
    std::tie(low_.y, high_.y) = extent_without_outliers(std::move(ys));
    for (const ImageVertex& vertex : image.vertices) outside_count_ += !shows(vertex.point);
    const double width = static_cast<double>(high_.x - low_.x);
    const double height = static_cast<double>(high_.y - low_.y);
    if (width > 0 || height > 0) {
      px_per_subunit_ = std::min(width > 0 ? map_width_max / width : map_height_max / height,
                                 height > 0 ? map_height_max / height : map_width_max / width);
    }
    height_px_ = std::max(map_height_min, height * px_per_subunit_);
    left_ = (page_width - width * px_per_subunit_) / 2;
    bottom_ = header_height + (height_px_ + height * px_per_subunit_) / 2;
  }

  double height_px() const { return height_px_; }
  // Vertices that the frame leaves out.
  std::size_t outside_count() const { return outside_count_; }
  double page_height() const { return header_height + height_px_ + footer_height; }
  double px_per_unit() const { return px_per_subunit_ * static_cast<double>(subunits_per_unit); }

  Spot spot(const Point& point) const {
    const double x = left_ + static_cast<double>(point.x - low_.x) * px_per_subunit_;
    const double y = bottom_ - static_cast<double>(point.y - low_.y) * px_per_subunit_;
    return {std::llround(x * 100), std::llround(y * 100)};
  }

  bool shows(const Point& point) const {
    return low_.x <= point.x && point.x <= high_.x && low_.y <= point.y && point.y <= high_.y;
  }

 private:
  std::size_t outside_count_ = 0;
  Point low_;
  Point high_;
  double px_per_subunit_ = 0;
  double height_px_ = map_height_min;
  double left_ = page_width / 2;
  double bottom_ = header_height;
};

// SVG path data in relative moves, which are short.
class PathData {
 public:
  void move_to(Spot to) {
    text_ += started_ ? "m" : "M";
    append(to);
    command_ = 'm';
  }
  void line_to(Spot to) {
    if (command_ != 'l') text_ += 'l';
    command_ = 'l';
    append(to);
  }
  void close() {
    text_ += 'z';
    command_ = 'z';
    at_ = first_;
  }
  void dot(Spot to) {
    move_to(to);
    // Not 0: some renderers draw no caps on a line without length.
    text_ += "h1";
    at_.x += 1;
  }
  bool empty() const { return text_.empty(); }
  const std::string& text() const { return text_; }

 private:
  void append(Spot to) {
    const long long dx = to.x - at_.x;
    const long long dy = to.y - at_.y;
    if (!text_.empty() && text_.back() >= '0' && text_.back() <= '9' && dx >= 0) text_ += ' ';
    text_ += std::to_string(dx);
    if (dy >= 0) text_ += ' ';
    text_ += std::to_string(dy);
    if (command_ != 'l') first_ = to;
    at_ = to;
    started_ = true;
  }

  std::string text_;
  Spot at_;
  Spot first_;
  bool started_ = false;
  char command_ = ' ';
};

// Widths that suit the density of the mesh.
struct Strokes {
  double edge;
  double feature;
  double node;     // diameter
  double steiner;  // side
};

class Picture {
 public:
  Picture(const MeshImage& image, const PictureText& words, const PictureMarks& marks)
      : image_(image), words_(words), marks_(marks), map_(image) {
    spots_.reserve(image.vertices.size());
    for (const ImageVertex& vertex : image.vertices) spots_.push_back(map_.spot(vertex.point));
    strokes_ = choose_strokes();
  }

  std::string make() {
    open_page();
    add_title();
    if (map_.outside_count() > 0) {
      text_ += "<clipPath id=\"map\"><rect x=\"0\" y=\"" + px(header_height - 10) + "\" width=\"" +
               px(page_width) + "\" height=\"" + px(map_.height_px() + 20) + "\"/></clipPath>\n";
    }
    text_ += map_.outside_count() > 0 ? "<g clip-path=\"url(#map)\">\n" : "<g>\n";
    text_ +=
        "<g transform=\"scale(.01)\" fill=\"none\" stroke-linejoin=\"round\" "
        "stroke-linecap=\"round\">\n";
    add_domain();
    add_edges();
    add_features();
    add_vertices();
    add_marks();
    text_ += "</g>\n</g>\n";
    add_legend();
    add_scale_bar();
    text_ += "</svg>\n";
    return std::move(text_);
  }

 private:
  // Symbols are to stay apart: they follow a low quantile of what the mesh has for edge lengths.
  Strokes choose_strokes() const {
    std::vector<double> lengths;
    lengths.reserve(image_.edges.size());
    for (const ImageEdge& edge : image_.edges) {
      lengths.push_back(std::hypot(static_cast<double>(spots_[edge.from].x - spots_[edge.to].x),
                                   static_cast<double>(spots_[edge.from].y - spots_[edge.to].y)) /
                        100);
    }
    double spacing = 100;
    if (!lengths.empty()) {
      const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() * 2 / 5);
      std::nth_element(lengths.begin(), middle, lengths.end());
      spacing = *middle;
    }
    // A few Steiner vertices among thousands of nodes are still to be found.
    const double visible = std::clamp(40 / std::sqrt(image_.steiner_count() + 1.0), 1.8, 4.5);
    return {.edge = std::clamp(spacing * 0.02, 0.35, 1.1),
            .feature = std::clamp(spacing * 0.06, 0.7, 3.2),
            .node = std::clamp(spacing * 0.14, 0.9, 10.0),
            .steiner = std::clamp(spacing * 0.17, visible, 9.0)};
  }

  void open_page() {
    const std::string height = px(map_.page_height());
    text_ += "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + px(page_width) + " " +
             height + "\" width=\"" + px(page_width) + "\" height=\"" + height +
             "\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n";
    text_ += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  }

  void add_text(double x, double y, double size, const char* colour, const std::string& text,
                const char* more = "") {
    text_ += "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" font-size=\"" + px(size) +
             "\" fill=\"" + colour + "\"" + more + ">" + text + "</text>\n";
  }

  void add_title() {
    text_ += "<title>" + escaped(words_.title) + "</title>\n";
    add_text(margin, 46, 26, ink, escaped(words_.title), " font-weight=\"bold\"");
    const std::string separator = " \xC2\xB7 ";
    std::string counts = counted(image_.node_count, "node", "nodes") + separator +
                         counted(image_.feature_count, "feature", "features") + separator +
                         counted(image_.steiner_count(), "Steiner vertex", "Steiner vertices") +
                         separator + counted(image_.triangles.size(), "triangle", "triangles");
    if (image_.unresolved_count() > 0) {
      counts += separator + grouped(image_.unresolved_count()) + " unresolved";
    }
    if (map_.outside_count() > 0) {
      counts +=
          separator + counted(map_.outside_count(), "vertex", "vertices") + " far off, not shown";
    }
    add_text(margin, 73, 16, soft_ink, counts);
  }

  void add_path(const PathData& path, const std::string& attributes) {
    if (path.empty()) return;
    text_ += "<path " + attributes + " d=\"" + path.text() + "\"/>\n";
  }

  static std::string stroke(const char* colour, double width) {
    return std::string("stroke=\"") + colour + "\" stroke-width=\"" + px(width * 100) + "\"";
  }

  void add_domain() {
    PathData path;
    for (const auto& loop : outline_loops(image_)) {
      path.move_to(spots_[loop.front()]);
      for (std::size_t i = 1; i < loop.size(); ++i) path.line_to(spots_[loop[i]]);
      path.close();
    }
    const bool has_unseen = marks_.sensing_range > 0 && !path.empty();
    add_path(path, std::string("fill=\"") + (has_unseen ? unseen_fill : domain_fill) +
                       "\" fill-rule=\"evenodd\"");
    if (!has_unseen) return;
    text_ += "<clipPath id=\"domain\">";
    add_path(path, "clip-rule=\"evenodd\"");
    text_ +=
        "</clipPath>\n<g clip-path=\"url(#domain)\" fill=\"" + std::string(domain_fill) + "\">\n";
    const std::string radius =
        std::to_string(std::llround(marks_.sensing_range * map_.px_per_unit() * 100));
    for (const Point& sensor : marks_.sensors) {
      const Spot spot = map_.spot(sensor);
      text_ += "<circle cx=\"" + std::to_string(spot.x) + "\" cy=\"" + std::to_string(spot.y) +
               "\" r=\"" + radius + "\"/>\n";
    }
    text_ += "</g>\n";
  }

  // Relays are rings, holes crosses; both as large as is readable.
  void add_marks() {
    const double size = std::max(strokes_.node, 5.0) * 100;
    const auto reach = std::llround(size * 0.7);
    PathData rings;
    for (const Point& relay : marks_.relays) {
      if (map_.shows(relay)) rings.dot(map_.spot(relay));
    }
    add_path(rings, stroke(relay_colour, size / 100 * 1.3));
    add_path(rings, stroke("#fff", size / 100 * 0.7));
    PathData crosses;
    for (const Point& hole : marks_.holes) {
      if (!map_.shows(hole)) continue;
      const Spot spot = map_.spot(hole);
      crosses.move_to({spot.x - reach, spot.y - reach});
      crosses.line_to({spot.x + reach, spot.y + reach});
      crosses.move_to({spot.x - reach, spot.y + reach});
      crosses.line_to({spot.x + reach, spot.y - reach});
    }
    add_path(crosses, stroke(hole_colour, size / 100 * 0.35));
  }

  void add_edges() {
    PathData path;
    std::uint32_t at = static_cast<std::uint32_t>(-1);
    for (const ImageEdge& edge : image_.edges) {
      if (edge.is_constrained) continue;
      if (edge.from != at) path.move_to(spots_[edge.from]);
      path.line_to(spots_[edge.to]);
      at = edge.to;
    }
    add_path(path, stroke(edge_colour, strokes_.edge));
  }

  void add_features() {
    PathData done;
    PathData missing;
    std::uint32_t at = static_cast<std::uint32_t>(-1);
    for (const ImageSubsegment& piece : image_.subsegments) {
      if (!piece.is_edge) {
        missing.move_to(spots_[piece.from]);
        missing.line_to(spots_[piece.to]);
        continue;
      }
      if (piece.from != at) done.move_to(spots_[piece.from]);
      done.line_to(spots_[piece.to]);
      at = piece.to;
    }
    add_path(done, stroke(feature_colour, strokes_.feature));
    const std::string dash = px(strokes_.feature * 300);
    add_path(missing, stroke(unresolved_colour, strokes_.feature) + " stroke-dasharray=\"" + dash +
                          " " + dash + "\"");
  }

  void add_vertices() {
    PathData nodes;
    PathData steiner;
    for (std::size_t i = 0; i < spots_.size(); ++i) {
      if (!map_.shows(image_.vertices[i].point)) continue;
      (image_.vertices[i].is_steiner ? steiner : nodes).dot(spots_[i]);
    }
    // A white rim keeps symbols apart from bold features under them.
    const double rim = std::min(1.5, strokes_.node * 0.35);
    if (strokes_.node > 2) add_path(nodes, stroke("#fff", strokes_.node + rim));
    add_path(nodes, stroke(node_colour, strokes_.node));
    const std::string square = " stroke-linecap=\"square\"";
    if (strokes_.steiner > 2) add_path(steiner, stroke("#fff", strokes_.steiner + rim) + square);
    add_path(steiner, stroke(steiner_colour, strokes_.steiner) + square);
  }

  double footer_y() const { return header_height + map_.height_px() + 52; }

  void add_legend() {
    double x = margin;
    const double y = footer_y();
    const auto label = [&](const char* text, double width) {
      add_text(x + 30, y + 5, 14, ink, text);
      x += 30 + width;
    };
    const auto line = [&](const char* colour, double width, const char* more) {
      text_ += "<path d=\"M" + px(x) + " " + px(y) + "h22\" stroke=\"" + colour +
               "\" stroke-width=\"" + px(width) + "\"" + more + "/>\n";
    };
    text_ += "<circle cx=\"" + px(x + 11) + "\" cy=\"" + px(y) + "\" r=\"5\" fill=\"" +
             node_colour + "\"/>\n";
    label("node", 58);
    if (image_.steiner_count() > 0) {
      text_ += "<rect x=\"" + px(x + 6.5) + "\" y=\"" + px(y - 4.5) +
               "\" width=\"9\" height=\"9\" fill=\"" + steiner_colour + "\"/>\n";
      label("Steiner vertex", 120);
    }
    if (!image_.subsegments.empty()) {
      line(feature_colour, 3, "");
      label("feature", 74);
    }
    if (image_.unresolved_count() > 0) {
      line(unresolved_colour, 3, " stroke-dasharray=\"5 4\"");
      label("unresolved", 98);
    }
    line(edge_colour, 1.2, "");
    label("mesh edge", 104);
    if (!image_.triangles.empty()) {
      text_ += "<rect x=\"" + px(x) + "\" y=\"" + px(y - 8) +
               "\" width=\"22\" height=\"16\" fill=\"" + domain_fill + "\" stroke=\"" +
               edge_colour + "\" stroke-width=\".5\"/>\n";
      label(marks_.sensing_range > 0 ? "seen" : "domain", 70);
    }
    if (!marks_.relays.empty()) {
      text_ += "<circle cx=\"" + px(x + 11) + "\" cy=\"" + px(y) +
               "\" r=\"4.5\" fill=\"#fff\" stroke=\"" + relay_colour + "\" stroke-width=\"2\"/>\n";
      label("relay", 58);
    }
    if (!marks_.holes.empty()) {
      text_ += "<path d=\"M" + px(x + 6) + " " + px(y - 5) + "l10 10m0-10l-10 10\" stroke=\"" +
               hole_colour + "\" stroke-width=\"2.4\"/>\n";
      label("hole", 54);
    }
  }

  void add_scale_bar() {
    if (map_.px_per_unit() <= 0) return;
    // The greatest 1, 2 or 5 times a power of ten that takes at most 240 pixels.
    const double most = 240 / map_.px_per_unit();
    const double power = std::pow(10, std::floor(std::log10(most)));
    const double length = most >= 5 * power ? 5 * power : most >= 2 * power ? 2 * power : power;
    const double right = page_width - margin;
    const double left = right - length * map_.px_per_unit();
    const double y = footer_y() + 4;
    text_ += "<path d=\"M" + px(left) + " " + px(y - 7) + "v7H" + px(right) +
             "v-7\" fill=\"none\" stroke=\"" + ink + "\" stroke-width=\"1.5\"/>\n";
    std::string label;
    if (length >= 1) {
      label = grouped(static_cast<std::size_t>(std::llround(length)));
    } else {
      append_double(label, length);
    }
    add_text((left + right) / 2, y - 8, 13, ink, label + " " + escaped(words_.unit),
             " text-anchor=\"middle\"");
  }

  const MeshImage& image_;
  const PictureText& words_;
  const PictureMarks& marks_;
  Map map_;
  std::vector<Spot> spots_;
  Strokes strokes_{};
  std::string text_;
};

}  // namespace

std::string svg_text(const MeshImage& image, const PictureText& words, const PictureMarks& marks) {
  return Picture(image, words, marks).make();
}

}  // namespace etcm::files
