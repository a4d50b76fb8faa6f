#include "etcm/files/picture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "etcm/files/decimal.h"
#include "etcm/files/outline.h"
#include "picture_map.h"
#include "svg.h"

namespace etcm::files {

namespace {

using Spot = PictureSpot;

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

// Widths that suit the density of the mesh.
struct Strokes {
  double edge;
  double feature;
  double node;     // diameter
  double steiner;  // side
};

class Picture {
 public:
  Picture(TextSink& out, const MeshImage& image, const PictureText& words,
          const PictureMarks& marks, PictureRoom& room)
      : out_(out),
        image_(image),
        words_(words),
        marks_(marks),
        room_(room),
        map_(image, room.coordinates) {
    room_.spots.clear();
    for (const ImageVertex& vertex : image.vertices) room_.spots.push_back(map_.spot(vertex.point));
    room_.outline.find(image);
    strokes_ = choose_strokes();
  }

  void write() {
    open_page();
    add_title();
    const bool is_clipped = map_.outside_count() > 0;
    if (is_clipped) {
      out_ << "<clipPath id=\"map\"><rect x=\"0\" y=\"" << Px{header_height - 10} << "\" width=\""
           << Px{page_width} << "\" height=\"" << Px{map_.height_px() + 20} << "\"/></clipPath>\n";
    }
    out_ << (is_clipped ? "<g clip-path=\"url(#map)\">\n" : "<g>\n")
         << "<g transform=\"scale(.01)\" fill=\"none\" stroke-linejoin=\"round\" "
            "stroke-linecap=\"round\">\n";
    add_domain();
    add_edges();
    add_features();
    add_vertices();
    add_marks();
    out_ << "</g>\n</g>\n";
    add_legend();
    add_scale_bar();
    out_ << "</svg>\n";
  }

 private:
  // Symbols are to stay apart: they follow a low quantile of what the mesh has for edge lengths.
  Strokes choose_strokes() const {
    std::vector<double>& lengths = room_.lengths;
    lengths.clear();
    for (const ImageEdge& edge : image_.edges) {
      const Spot& from = room_.spots[edge.from];
      const Spot& to = room_.spots[edge.to];
      lengths.push_back(
          std::hypot(static_cast<double>(from.x - to.x), static_cast<double>(from.y - to.y)) / 100);
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
    out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << Px{page_width} << ' '
         << Px{map_.page_height()} << "\" width=\"" << Px{page_width} << "\" height=\""
         << Px{map_.page_height()}
         << "\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n"
         << "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  }

  // What stands in it follows, and "</text>\n".
  TextSink& open_text(double x, double y, double size, const char* colour, const char* more = "") {
    return out_ << "<text x=\"" << Px{x} << "\" y=\"" << Px{y} << "\" font-size=\"" << Px{size}
                << "\" fill=\"" << colour << '"' << more << '>';
  }

  void add_title() {
    constexpr const char* separator = " \xC2\xB7 ";
    const Escaped title{image_.name.empty() ? words_.title : image_.name, !image_.name.empty()};
    out_ << "<title>" << title << "</title>\n";
    open_text(margin, 46, 26, ink, " font-weight=\"bold\"") << title << "</text>\n";
    open_text(margin, 73, 16, soft_ink)
        << Counted{image_.node_count, "node", "nodes"} << separator
        << Counted{image_.feature_count, "feature", "features"} << separator
        << Counted{image_.steiner_count(), "Steiner vertex", "Steiner vertices"} << separator
        << Counted{image_.triangles.size(), "triangle", "triangles"};
    if (image_.unresolved_count() > 0) {
      out_ << separator << Grouped{image_.unresolved_count()} << " unresolved";
    }
    if (map_.outside_count() > 0) {
      out_ << separator << Counted{map_.outside_count(), "vertex", "vertices"}
           << " far off, not shown";
    }
    out_ << "</text>\n";
  }

  template <class Style, class Draw>
  void add_path(const Style& style, const Draw& draw) {
    Path<Style> path(out_, style);
    draw(path);
  }
  template <class Draw>
  void add_path(const Stroke& stroke, const Draw& draw) {
    add_path([&] { out_ << stroke; }, draw);
  }

  void add_domain() {
    const Outline& outline = room_.outline;
    const auto draw = [&](auto& path) {
      for (std::size_t i = 0; i < outline.loop_count(); ++i) {
        const auto loop = outline.loop(i);
        path.move_to(room_.spots[loop.front()]);
        for (const std::uint32_t vertex : loop.subspan(1)) path.line_to(room_.spots[vertex]);
        path.close();
      }
    };
    const bool has_unseen = marks_.sensing_range > 0 && outline.loop_count() > 0;
    add_path(
        [&] {
          out_ << "fill=\"" << (has_unseen ? unseen_fill : domain_fill)
               << "\" fill-rule=\"evenodd\"";
        },
        draw);
    if (!has_unseen) return;
    out_ << "<clipPath id=\"domain\">";
    add_path([&] { out_ << "clip-rule=\"evenodd\""; }, draw);
    out_ << "</clipPath>\n<g clip-path=\"url(#domain)\" fill=\"" << domain_fill << "\">\n";
    const auto radius = std::llround(marks_.sensing_range * map_.px_per_unit() * 100);
    for (const Point& sensor : marks_.sensors) {
      const Spot spot = map_.spot(sensor);
      out_ << "<circle cx=\"" << spot.x << "\" cy=\"" << spot.y << "\" r=\"" << radius << "\"/>\n";
    }
    out_ << "</g>\n";
  }

  // Relays are rings, holes crosses; both as large as is readable.
  void add_marks() {
    const double size = std::max(strokes_.node, 5.0) * 100;
    const auto reach = std::llround(size * 0.7);
    const auto draw_rings = [&](auto& path) {
      for (const Point& relay : marks_.relays) {
        if (map_.shows(relay)) path.dot(map_.spot(relay));
      }
    };
    add_path(Stroke{relay_colour, size / 100 * 1.3}, draw_rings);
    add_path(Stroke{"#fff", size / 100 * 0.7}, draw_rings);
    add_path(Stroke{hole_colour, size / 100 * 0.35}, [&](auto& path) {
      for (const Point& hole : marks_.holes) {
        if (!map_.shows(hole)) continue;
        const Spot spot = map_.spot(hole);
        path.move_to({spot.x - reach, spot.y - reach});
        path.line_to({spot.x + reach, spot.y + reach});
        path.move_to({spot.x - reach, spot.y + reach});
        path.line_to({spot.x + reach, spot.y - reach});
      }
    });
  }

  void add_edges() {
    add_path(Stroke{edge_colour, strokes_.edge}, [&](auto& path) {
      std::uint32_t at = static_cast<std::uint32_t>(-1);
      for (const ImageEdge& edge : image_.edges) {
        if (edge.is_constrained) continue;
        if (edge.from != at) path.move_to(room_.spots[edge.from]);
        path.line_to(room_.spots[edge.to]);
        at = edge.to;
      }
    });
  }

  void add_features() {
    const auto draw = [&](bool are_edges, auto& path) {
      std::uint32_t at = static_cast<std::uint32_t>(-1);
      for (const ImageSubsegment& subsegment : image_.subsegments) {
        if (subsegment.is_edge != are_edges) continue;
        if (!are_edges || subsegment.from != at) path.move_to(room_.spots[subsegment.from]);
        path.line_to(room_.spots[subsegment.to]);
        at = subsegment.to;
      }
    };
    const auto style = [&](const char* colour, bool is_dashed) {
      return [this, colour, is_dashed] {
        out_ << Stroke{colour, strokes_.feature};
        const Px dash{strokes_.feature * 300};
        if (is_dashed) out_ << " stroke-dasharray=\"" << dash << ' ' << dash << '"';
      };
    };
    add_path(style(feature_colour, words_.are_features_dashed),
             [&](auto& path) { draw(true, path); });
    add_path(style(unresolved_colour, true), [&](auto& path) { draw(false, path); });
  }

  void add_vertices() {
    const auto draw = [&](bool are_steiner, auto& path) {
      for (std::size_t i = 0; i < image_.vertices.size(); ++i) {
        const ImageVertex& vertex = image_.vertices[i];
        if (vertex.is_steiner == are_steiner && map_.shows(vertex.point)) path.dot(room_.spots[i]);
      }
    };
    const auto draw_nodes = [&](auto& path) { draw(false, path); };
    const auto draw_steiner = [&](auto& path) { draw(true, path); };
    // A white rim keeps symbols apart from bold features under them.
    const double rim = std::min(1.5, strokes_.node * 0.35);
    if (strokes_.node > 2) add_path(Stroke{"#fff", strokes_.node + rim}, draw_nodes);
    add_path(Stroke{node_colour, strokes_.node}, draw_nodes);
    constexpr const char* square = " stroke-linecap=\"square\"";
    if (strokes_.steiner > 2) {
      add_path(Stroke{"#fff", strokes_.steiner + rim, square}, draw_steiner);
    }
    add_path(Stroke{steiner_colour, strokes_.steiner, square}, draw_steiner);
  }

  double footer_y() const { return header_height + map_.height_px() + 52; }

  void add_legend() {
    constexpr const char* dashed = " stroke-dasharray=\"5 4\"";
    double x = margin;
    const double y = footer_y();
    const auto label = [&](const char* text, double width) {
      open_text(x + 30, y + 5, 14, ink) << text << "</text>\n";
      x += 30 + width;
    };
    const auto line = [&](const char* colour, double width, const char* more) {
      out_ << "<path d=\"M" << Px{x} << ' ' << Px{y} << "h22\" stroke=\"" << colour
           << "\" stroke-width=\"" << Px{width} << '"' << more << "/>\n";
    };
    out_ << "<circle cx=\"" << Px{x + 11} << "\" cy=\"" << Px{y} << "\" r=\"5\" fill=\""
         << node_colour << "\"/>\n";
    label("node", 58);
    if (image_.steiner_count() > 0) {
      out_ << "<rect x=\"" << Px{x + 6.5} << "\" y=\"" << Px{y - 4.5}
           << "\" width=\"9\" height=\"9\" fill=\"" << steiner_colour << "\"/>\n";
      label("Steiner vertex", 120);
    }
    if (!image_.subsegments.empty()) {
      line(feature_colour, 3, words_.are_features_dashed ? dashed : "");
      label("feature", 74);
    }
    if (image_.unresolved_count() > 0) {
      line(unresolved_colour, 3, dashed);
      label("unresolved", 98);
    }
    line(edge_colour, 1.2, "");
    label("mesh edge", 104);
    if (!image_.triangles.empty()) {
      out_ << "<rect x=\"" << Px{x} << "\" y=\"" << Px{y - 8}
           << "\" width=\"22\" height=\"16\" fill=\"" << domain_fill << "\" stroke=\""
           << edge_colour << "\" stroke-width=\".5\"/>\n";
      label(marks_.sensing_range > 0 ? "seen" : "domain", 70);
    }
    if (!marks_.relays.empty()) {
      out_ << "<circle cx=\"" << Px{x + 11} << "\" cy=\"" << Px{y}
           << "\" r=\"4.5\" fill=\"#fff\" stroke=\"" << relay_colour << "\" stroke-width=\"2\"/>\n";
      label("relay", 58);
    }
    if (!marks_.holes.empty()) {
      out_ << "<path d=\"M" << Px{x + 6} << ' ' << Px{y - 5} << "l10 10m0-10l-10 10\" stroke=\""
           << hole_colour << "\" stroke-width=\"2.4\"/>\n";
      label("hole", 54);
    }
  }

  void add_scale_bar() {
    if (map_.px_per_unit() <= 0) return;
    const bool is_metric = image_.metres_per_unit > 0;
    const double px = is_metric ? map_.px_per_unit() / image_.metres_per_unit : map_.px_per_unit();
    // The greatest 1, 2 or 5 times a power of ten that takes at most 240 pixels.
    const double most = 240 / px;
    const double power = std::pow(10, std::floor(std::log10(most)));
    const double length = most >= 5 * power ? 5 * power : most >= 2 * power ? 2 * power : power;
    const double right = page_width - margin;
    const double left = right - length * px;
    const double y = footer_y() + 4;
    out_ << "<path d=\"M" << Px{left} << ' ' << Px{y - 7} << "v7H" << Px{right}
         << "v-7\" fill=\"none\" stroke=\"" << ink << "\" stroke-width=\"1.5\"/>\n";
    open_text((left + right) / 2, y - 8, 13, ink, " text-anchor=\"middle\"");
    const bool is_long = is_metric && length >= 1000;
    const double told = is_long ? length / 1000 : length;
    if (told >= 1) {
      out_ << Grouped{static_cast<std::size_t>(std::llround(told))};
    } else {
      out_ << told;
    }
    if (is_metric) {
      out_ << (is_long ? " km" : " m");
    } else {
      out_ << ' ' << Escaped{words_.unit_name};
    }
    out_ << "</text>\n";
  }

  TextSink& out_;
  const MeshImage& image_;
  const PictureText& words_;
  const PictureMarks& marks_;
  PictureRoom& room_;
  PictureMap map_;
  Strokes strokes_{};
};

}  // namespace

void PictureRoom::reserve(std::size_t vertices) {
  coordinates.reserve(vertices);
  spots.reserve(vertices);
  lengths.reserve(3 * vertices);
  outline.reserve(vertices);
}

void write_svg(TextSink& out, const MeshImage& image, const PictureText& words,
               const PictureMarks& marks, PictureRoom& room) {
  Picture(out, image, words, marks, room).write();
}

std::string svg_text(const MeshImage& image, const PictureText& words, const PictureMarks& marks) {
  PictureRoom room;
  return text_of([&](TextSink& out) { write_svg(out, image, words, marks, room); });
}

}  // namespace etcm::files
