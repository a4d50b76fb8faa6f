// etcm analyse IN.poly --radio-range R --sensing-range S
#include <algorithm>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "command.h"
#include "etcm/analysis.h"
#include "etcm/files/file_set.h"
#include "etcm/files/picture.h"
#include "mesher.h"
#include "output.h"
#include "report.h"

namespace etcm::cli {

namespace {

// Lists are cut off here; the counts beside them are not.
constexpr std::size_t list_max = 1000;

struct AnalyseOptions {
  std::string input;
  PlacementOptions placement;
  DomainOption domain;
  std::uint32_t radio_range = 0;
  std::uint32_t sensing_range = 0;
  std::string picture;
  std::string unit = "units";
  bool json = false;
};

struct Radio {
  Connectivity alone;
  Connectivity with_relays;
  std::uint32_t long_links = 0;
  std::uint64_t relay_count = 0;
  std::vector<Relay> relays;
};

struct Sensing {
  std::uint32_t hole_count = 0;
  std::uint32_t gap_count = 0;
  std::size_t unwatched_count = 0;  // of those listed
  std::vector<Hole> holes;
  std::vector<Gap> gaps;
};

template <class Entry, class Count>
void cut(std::vector<Entry>& list, Count count) {
  list.resize(static_cast<std::size_t>(std::min<std::uint64_t>(count, list.size())));
}

Connectivity connectivity_of(const Mesh& mesh, std::uint32_t range) {
  std::vector<ConnectivityScratch> scratch(mesh.vertex_id_end());
  Connectivity result;
  static_cast<void>(connectivity(mesh, range, scratch, result));
  return result;
}

Radio look_at_radio(const Mesh& mesh, const Mesh& nodes, std::uint32_t range) {
  Radio radio;
  radio.alone = connectivity_of(nodes, range);
  radio.with_relays = connectivity_of(mesh, range);
  radio.long_links = links(nodes, range, {});
  radio.relays.resize(list_max);
  radio.relay_count = relays(mesh, nodes, range, radio.relays);
  cut(radio.relays, radio.relay_count);
  return radio;
}

Sensing look_at_sensing(const Mesh& mesh, const Mesh& nodes, std::span<const Region> region,
                        std::uint32_t range) {
  Sensing sensing;
  sensing.holes.resize(list_max);
  sensing.hole_count =
      coverage_holes(nodes, {.mesh = &mesh, .region = region}, range, sensing.holes);
  cut(sensing.holes, sensing.hole_count);
  sensing.gaps.resize(list_max);
  sensing.gap_count = barrier_gaps(mesh, nodes, range, sensing.gaps);
  cut(sensing.gaps, sensing.gap_count);
  sensing.unwatched_count = static_cast<std::size_t>(std::count_if(
      sensing.gaps.begin(), sensing.gaps.end(), [](const Gap& gap) { return !gap.watched; }));
  return sensing;
}

std::uint32_t distance_of(const Hole& hole) {
  return range_for(squared_distance(hole.position, hole.sensor));
}

std::string counted(std::uint64_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string tell(const Radio& radio, std::uint32_t range) {
  std::string text = "radios that reach " + std::to_string(range) + ": " +
                     counted(radio.alone.parts, "network", "separate networks") + "; it takes " +
                     std::to_string(range_for(radio.alone.least)) + " to keep the nodes in one";
  if (radio.with_relays.least != radio.alone.least) {
    text += ", " + std::to_string(range_for(radio.with_relays.least)) +
            " with a relay at each Steiner vertex";
  }
  return text + "\n" +
         counted(radio.long_links, "link between neighbours is", "links between neighbours are") +
         " longer\n" + counted(radio.relay_count, "relay", "relays") +
         " to follow each feature hop by hop\n";
}

std::string tell(const Sensing& sensing, std::uint32_t range) {
  std::string text = "nodes that sense " + std::to_string(range) + ": ";
  if (sensing.hole_count == 0) {
    text += "every place of the domain is seen\n";
  } else {
    const auto worst = std::max_element(
        sensing.holes.begin(), sensing.holes.end(),
        [](const Hole& a, const Hole& b) { return distance_of(a) < distance_of(b); });
    text += counted(sensing.hole_count, "hole", "holes") + ", the widest " +
            std::to_string(distance_of(*worst)) + " from the nearest node, at " +
            std::to_string(worst->position.x / subunits_per_unit) + " " +
            std::to_string(worst->position.y / subunits_per_unit) + "\n";
  }
  text += counted(sensing.gap_count, "gap", "gaps") + " along features";
  if (sensing.gap_count > 0) {
    text += ", " + std::to_string(sensing.unwatched_count) + " not watched from beside either";
  }
  return text + "\n";
}

std::string json_place(const Point& place) {
  const auto units = [](std::int64_t subunits) {
    return json_number(static_cast<double>(subunits) / static_cast<double>(subunits_per_unit));
  };
  return "[" + units(place.x) + "," + units(place.y) + "]";
}

template <class Entry, class Write>
std::string json_list(const std::vector<Entry>& entries, Write write) {
  std::string text = "[";
  for (const Entry& entry : entries) text += (text.size() > 1 ? "," : "") + write(entry);
  return text + "]";
}

std::string json_flag(bool flag) { return flag ? "true" : "false"; }

void add(Members& members, const Radio& radio, const files::ConstraintGraph& graph,
         std::uint32_t range) {
  const auto relay_text = [&](const Relay& relay) {
    return "{\"place\":" + json_place(relay.position) +
           ",\"feature\":" + std::to_string(graph.feature_number(relay.feature.value)) +
           ",\"steiner\":" + json_flag(!relay.vertex.is_none()) + "}";
  };
  members.insert(members.end(),
                 {{"radio_range", std::to_string(range)},
                  {"least_range_alone", std::to_string(range_for(radio.alone.least))},
                  {"least_range_with_relays", std::to_string(range_for(radio.with_relays.least))},
                  {"parts_alone", std::to_string(radio.alone.parts)},
                  {"parts_with_relays", std::to_string(radio.with_relays.parts)},
                  {"long_links", std::to_string(radio.long_links)},
                  {"relays", std::to_string(radio.relay_count)},
                  {"relay_list", json_list(radio.relays, relay_text)}});
}

void add(Members& members, const Sensing& sensing, const files::ConstraintGraph& graph,
         std::uint32_t range) {
  const auto hole_text = [](const Hole& hole) {
    return "{\"place\":" + json_place(hole.position) +
           ",\"distance\":" + std::to_string(distance_of(hole)) +
           ",\"on_boundary\":" + json_flag(hole.on_boundary) + "}";
  };
  const auto gap_text = [&](const Gap& gap) {
    const auto node = [&](VertexId vertex) {
      return std::to_string(graph.node_number(inputs::node_index_of(vertex)));
    };
    return "{\"feature\":" + std::to_string(graph.feature_number(gap.feature.value)) +
           ",\"from\":" + node(gap.from) + ",\"to\":" + node(gap.to) +
           ",\"watched\":" + json_flag(gap.watched) + "}";
  };
  members.insert(members.end(), {{"sensing_range", std::to_string(range)},
                                 {"holes", std::to_string(sensing.hole_count)},
                                 {"gaps", std::to_string(sensing.gap_count)},
                                 {"hole_list", json_list(sensing.holes, hole_text)},
                                 {"gap_list", json_list(sensing.gaps, gap_text)}});
}

files::PictureMarks marks_of(const Mesh& nodes, const Radio& radio, const Sensing& sensing,
                             std::uint32_t sensing_range) {
  files::PictureMarks marks;
  for (const Relay& relay : radio.relays) marks.relays.push_back(relay.position);
  for (const Hole& hole : sensing.holes) marks.holes.push_back(hole.position);
  marks.sensing_range = sensing_range;
  for (IdValue value = 1; sensing_range > 0 && value < nodes.vertex_id_end(); ++value) {
    marks.sensors.push_back(nodes.point(VertexId{value}));
  }
  return marks;
}

int run_analyse(const AnalyseOptions& options) {
  if (options.radio_range == 0 && options.sensing_range == 0) {
    throw UsageError("analyse: give --radio-range, --sensing-range or both");
  }
  if (options.picture == "-" && options.json) {
    throw UsageError(
        "-o -: the picture and --json would be one stream; give the picture a file name");
  }
  const files::Placement placement = options.placement.placement();
  const files::ConstraintGraph graph = files::read_graph(options.input);
  const std::string inputs[] = {graph.node_file, graph.poly_file};
  refuse_replacing("-o", options.picture, inputs);
  const files::GridGraph grid = files::place_on_grid(graph, placement);
  const Meshed meshed = build_mesh(graph, grid, {});
  const Mesh& mesh = **meshed.mesh;
  if (meshed.status != Status::ok) {
    std::cerr << "etcm: " << options.input << ": "
              << describe_shortfall(graph, mesh.error_detail(), mesh.unresolved()) << std::endl;
    return exit_unresolved;
  }
  // The network as it stands: nobody has built anything at a Steiner vertex yet.
  inputs::OwnedMesh nodes(inputs::config_for({"", grid.nodes, {}}, 0));
  static_cast<void>(nodes->build(grid.nodes, {}));

  Radio radio;
  Sensing sensing;
  Members members;
  std::string text;
  if (options.radio_range > 0) {
    radio = look_at_radio(mesh, *nodes, options.radio_range);
    add(members, radio, graph, options.radio_range);
    text += tell(radio, options.radio_range);
  }
  if (options.sensing_range > 0) {
    std::vector<Region> region(mesh.triangle_count());
    std::vector<TriangleId> waiting(region.size());
    static_cast<void>(label_domain(mesh, options.domain.exterior(), grid.holes, region, waiting));
    sensing = look_at_sensing(mesh, *nodes, region, options.sensing_range);
    add(members, sensing, graph, options.sensing_range);
    text += tell(sensing, options.sensing_range);
  }
  if (!options.picture.empty()) {
    files::FileSet files;
    files.add(options.picture,
              files::svg_text(files::image_of(mesh, options.domain.exterior(), grid.holes),
                              {title_of(options.input), options.unit},
                              marks_of(*nodes, radio, sensing, options.sensing_range)));
    files.commit();
  }
  if (options.picture == "-") {
    std::cerr << text << std::flush;
  } else {
    print(options.json ? json_object(members) : text);
  }
  return exit_ok;
}

}  // namespace

void add_analyse_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<AnalyseOptions>();
  CLI::App& command = *program.add_subcommand(
      "analyse", "What the mesh says of the network: relays, coverage holes, least radio range");
  command.add_option("IN", options->input, "Constraint graph: Triangle's .poly, or a .node")
      ->required();
  command.add_option("--radio-range", options->radio_range, "How far a radio reaches")
      ->check(CLI::Range(1u, range_max));
  command.add_option("--sensing-range", options->sensing_range, "How far a node senses")
      ->check(CLI::Range(1u, range_max));
  command
      .add_option("-o,--output", options->picture,
                  "Draw relays, holes and what is seen as SVG; - is stdout, and the sentences go "
                  "to stderr then")
      ->type_name("FILE");
  options->placement.add_to(command);
  options->domain.add_to(command);
  command.add_option("--unit", options->unit, "What the scale bar of the picture counts")
      ->capture_default_str();
  command.add_flag("--json", options->json, "Print one JSON object instead of sentences");
  command.callback([options, &run] { run = [options] { return run_analyse(*options); }; });
}

}  // namespace etcm::cli
