// etcm interpolate IN --readings FILE --at X,Y
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "etcm/analysis.h"
#include "etcm/files/error.h"
#include "mesher.h"
#include "node_readings.h"
#include "report.h"

namespace etcm::cli {

namespace {

constexpr std::size_t rows_max = 1'000'000;

struct InterpolateOptions {
  std::string input;
  std::string readings;
  std::size_t attribute = 1;
  std::vector<std::string> places;
  std::int64_t feature = 0;
  std::string distance;
  std::string every;
  const CLI::Option* has_attribute = nullptr;
  const CLI::Option* has_feature = nullptr;
  PlacementOptions placement;
  DomainOption domain;
};

// The mesh with its readings, and what is said where one of them is missing.
class ReadingMap {
 public:
  ReadingMap(const files::ConstraintGraph& graph, const NodeReadings& readings, const Mesh& mesh)
      : graph_(graph),
        readings_(readings),
        mesh_(mesh),
        values_(mesh.vertex_id_end()),
        missing_(mesh.vertex_id_end()) {
    for (std::size_t node = 0; node < readings.values.size(); ++node) {
      const IdValue id = inputs::vertex_of(node).value;
      values_[id] = readings.values[node];
      if (!readings.is_known[node]) missing_[id] = shown;
    }
  }

  // In 2^-28 of 10^-digits. `where` names the place. Throws InputError outside the hull, and where
  // a node that the reading takes has none.
  std::int64_t value_at(const Point& place, const std::string& where) const {
    require_known(place, where);
    return interpolated(values_, place, where);
  }

 private:
  std::int64_t interpolated(const std::vector<std::int32_t>& values, const Point& place,
                            const std::string& where) const {
    Interpolated out;
    // The buffer has vertex_id_end() elements, so nothing can fail.
    static_cast<void>(interpolate(mesh_, place, values, out));
    if (out.type == LocateType::outside) {
      throw files::InputError(graph_.node_file, 0, where + " is outside the hull of the nodes");
    }
    return out.value;
  }

  void require_known(const Point& place, const std::string& where) const {
    if (interpolated(missing_, place, where) == 0) return;
    std::vector<std::int32_t> one(missing_.size());
    for (std::size_t node = 0; node < readings_.is_known.size(); ++node) {
      if (readings_.is_known[node]) continue;
      std::fill(one.begin(), one.end(), 0);
      one[inputs::vertex_of(node).value] = shown;
      if (interpolated(one, place, where) == 0) continue;
      throw files::InputError(readings_.source, 0,
                              "node " + std::to_string(graph_.node_number(node)) +
                                  " has no reading, and that at " + where + " takes it");
    }
  }

  // Who has a weight at a place shows there where all others are 0.
  static constexpr std::int32_t shown = std::int32_t{1} << 30;

  const files::ConstraintGraph& graph_;
  const NodeReadings& readings_;
  const Mesh& mesh_;
  std::vector<std::int32_t> values_;   // by vertex id
  std::vector<std::int32_t> missing_;  // the same: shown where there is no reading
};

double length_between(const Point& a, const Point& b) {
  return std::hypot(static_cast<double>(b.x - a.x), static_cast<double>(b.y - a.y)) /
         static_cast<double>(subunits_per_unit);
}

// A feature from its first end on: distances in units of the mesh.
class FeatureLine {
 public:
  FeatureLine(const Mesh& mesh, FeatureId feature) {
    std::vector<VertexId> chain(mesh.chain(feature, {}));
    static_cast<void>(mesh.chain(feature, chain));
    for (const VertexId vertex : chain) points_.push_back(mesh.point(vertex));
    for (const Point& point : points_) distances_.push_back(length_between(points_[0], point));
  }

  double length() const { return distances_.back(); }

  // Between two vertices of the mesh the reading is linear, so it is taken from both: a place
  // between them, rounded to the grid, could be outside the hull. REQUIRES: 0 <= distance <=
  // length().
  std::int64_t value_at(double distance, const ReadingMap& map, const std::string& where) const {
    const std::size_t after = index_after(distance);
    const double share = share_between(distance, after);
    // An end that has no share may be without a reading.
    if (share <= 0) return map.value_at(points_[after - 1], where);
    if (share >= 1) return map.value_at(points_[after], where);
    const auto from = static_cast<double>(map.value_at(points_[after - 1], where));
    const auto to = static_cast<double>(map.value_at(points_[after], where));
    return std::llround(from + share * (to - from));
  }

 private:
  std::size_t index_after(double distance) const {
    const auto after = std::upper_bound(distances_.begin(), distances_.end(), distance);
    return std::clamp<std::size_t>(static_cast<std::size_t>(after - distances_.begin()), 1,
                                   distances_.size() - 1);
  }
  double share_between(double distance, std::size_t after) const {
    return (distance - distances_[after - 1]) / (distances_[after] - distances_[after - 1]);
  }

  std::vector<Point> points_;
  std::vector<double> distances_;
};

double parse_distance(const std::string& option, const std::string& text, bool may_be_zero) {
  const auto value = files::Decimal::parse(text);
  const double distance = value ? value->to_double() : 0;
  if (!value || value->is_negative() || (!may_be_zero && !(distance > 0)) ||
      !std::isfinite(distance)) {
    throw UsageError(option + " " + text + ": must be a decimal number " +
                     (may_be_zero ? "from 0 on" : "above 0"));
  }
  return distance;
}

std::size_t feature_index(const files::ConstraintGraph& graph, std::int64_t number) {
  const std::int64_t index = number - graph.feature_base;
  if (index >= 0 && index < static_cast<std::int64_t>(graph.features.size())) {
    return static_cast<std::size_t>(index);
  }
  throw UsageError("--feature " + std::to_string(number) + ": does not exist; " +
                   (graph.features.empty()
                        ? "the graph has no features"
                        : "features run from " + std::to_string(graph.feature_base) + " to " +
                              std::to_string(graph.feature_number(graph.features.size() - 1))));
}

// Readings along a feature; distances in units of the input, which `scale` makes units of the mesh.
std::string tell_along(const InterpolateOptions& options, const files::ConstraintGraph& graph,
                       const Mesh& mesh, const ReadingMap& map, int digits, double scale) {
  const std::size_t index = feature_index(graph, options.feature);
  const FeatureLine line(mesh, FeatureId{static_cast<IdValue>(index)});
  const std::string name = files::feature_name(graph, index);
  const double length = line.length() / scale;
  const auto text_at = [&](double distance) {
    const double on_mesh = std::min(distance * scale, line.length());
    return reading_text(line.value_at(on_mesh, map, json_number(distance) + " of " + name), digits);
  };
  if (!options.distance.empty()) {
    const double distance = parse_distance("--distance", options.distance, true);
    // The length is a square root, so the end is met up to its rounding.
    if (distance > length * (1 + 1e-12)) {
      throw UsageError("--distance " + options.distance + ": is beyond the end of " + name +
                       ", which is " + json_number(length) + " long");
    }
    return text_at(distance) + "\n";
  }
  const double every = parse_distance("--every", options.every, false);
  if (length / every >= static_cast<double>(rows_max)) {
    throw UsageError("--every " + options.every + ": makes more than a million rows of " + name +
                     ", which is " + json_number(length) + " long");
  }
  std::string text = "distance,reading\n";
  const files::Decimal step = *files::Decimal::parse(options.every);
  for (std::int64_t row = 0;; ++row) {
    const files::Decimal distance = step * files::Decimal::of(row);
    if (distance.to_double() >= length) break;
    text += distance.to_string() + "," + text_at(distance.to_double()) + "\n";
  }
  return text + json_number(length) + "," + text_at(length) + "\n";
}

// Whether a place is in the domain, its boundary included.
class DomainMap {
 public:
  DomainMap(const Mesh& mesh, Exterior exterior, std::span<const Point> holes)
      : mesh_(mesh), region_(mesh.triangle_count()) {
    std::vector<TriangleId> waiting(region_.size());
    static_cast<void>(label_domain(mesh, exterior, holes, region_, waiting));
  }

  bool contains(const Point& place) const {
    const Location at = locate(mesh_, place);
    // At a vertex there is a node or a feature.
    if (at.type == LocateType::on_vertex) return true;
    if (at.type == LocateType::outside) return false;
    if (at.triangle.is_none()) return true;
    if (region_[at.triangle.value] == Region::inside) return true;
    if (at.type != LocateType::on_edge) return false;
    const auto side = static_cast<std::size_t>(at.side);
    const Triangle triangle = mesh_.triangle(at.triangle);
    return triangle.constrained[side] || region_[triangle.neighbour[side].value] == Region::inside;
  }

 private:
  const Mesh& mesh_;
  std::vector<Region> region_;
};

void check_usage(const InterpolateOptions& options) {
  const bool has_feature = options.has_feature->count() > 0;
  const int ways = (options.places.empty() ? 0 : 1) + (options.distance.empty() ? 0 : 1) +
                   (options.every.empty() ? 0 : 1);
  if (ways != 1 || has_feature == !options.places.empty()) {
    throw UsageError("interpolate: give --at, or --feature with either --distance or --every");
  }
  if (!options.readings.empty() && options.has_attribute->count() > 0) {
    throw UsageError("interpolate: give --readings or --attribute, not both");
  }
}

int run_interpolate(const InterpolateOptions& options) {
  check_usage(options);
  const files::Placement placement = options.placement.placement();
  const files::ConstraintGraph graph = files::read_graph(options.input);
  const NodeReadings readings = options.readings.empty()
                                    ? attribute_readings(graph, options.attribute)
                                    : read_node_readings(options.readings, graph);
  const files::GridGraph grid = files::place_on_grid(graph, placement);
  const Meshed meshed = build_mesh(graph, grid, {});
  const Mesh& mesh = **meshed.mesh;
  if (meshed.status != Status::ok) {
    std::cerr << "etcm: " << options.input << ": "
              << describe_shortfall(graph, mesh.error_detail(), mesh.unresolved()) << std::endl;
    return exit_unresolved;
  }
  const ReadingMap map(graph, readings, mesh);
  std::string text;
  if (options.places.empty()) {
    const double scale = placement.scale ? placement.scale->to_double() : 1;
    text = tell_along(options, graph, mesh, map, readings.digits, scale);
  } else {
    const DomainMap domain(mesh, options.domain.exterior(), grid.holes);
    for (const std::string& given : options.places) {
      const Point place = place_at(given, placement);
      if (!domain.contains(place)) {
        throw UsageError("--at " + given + ": is outside the domain of " + options.input);
      }
      text += reading_text(map.value_at(place, given), readings.digits) + "\n";
    }
  }
  print(text);
  return exit_ok;
}

}  // namespace

void add_interpolate_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<InterpolateOptions>();
  CLI::App& command = *program.add_subcommand(
      "interpolate", "The reading between the nodes: at a place, or along a feature");
  command.add_option("IN", options->input, "Constraint graph: Triangle's .poly, or a .node")
      ->required();
  command
      .add_option("--readings", options->readings,
                  "CSV of node numbers and readings; without it they are attributes of the nodes")
      ->type_name("FILE");
  options->has_attribute =
      command.add_option("--attribute", options->attribute, "Which attribute of the nodes, from 1")
          ->capture_default_str();
  command.add_option("--at", options->places, "Where, in coordinates of the input")
      ->type_name("X,Y")
      ->allow_extra_args(false);
  options->has_feature =
      command.add_option("--feature", options->feature, "Along the feature of this number");
  command
      .add_option("--distance", options->distance, "At this distance from the feature's first end")
      ->type_name("D");
  command
      .add_option("--every", options->every, "A table of the whole feature, a row each distance")
      ->type_name("D");
  options->placement.add_to(command);
  options->domain.add_to(command);
  command.callback([options, &run] { run = [options] { return run_interpolate(*options); }; });
}

}  // namespace etcm::cli
