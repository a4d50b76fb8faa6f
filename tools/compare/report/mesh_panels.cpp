#include "compare/report/mesh_panels.h"

#include <cstdio>
#include <utility>
#include <vector>

#include "compare/systems/system.h"
#include "etcm/files/picture.h"
#include "inputs/owned_mesh.h"

namespace etcm::compare {
namespace {

constexpr int columns = 3;
constexpr double scale = 0.42;

// Features that are no edges yet, as the picture shows what is unresolved.
files::MeshImage delaunay_with_features(const inputs::Graph& graph) {
  inputs::OwnedMesh mesh(inputs::config_for(graph, 0));
  // What is wrong with a graph, the systems say; here is nothing then but an empty panel.
  if (mesh->build(graph.nodes, {}) != Status::ok) return {};
  files::MeshImage image = files::image_of(*mesh, Exterior::hull, {});
  image.feature_count = static_cast<std::uint32_t>(graph.features.size());
  for (std::uint32_t i = 0; i < image.feature_count; ++i) {
    const auto from = static_cast<std::uint32_t>(inputs::node_index_of(graph.features[i].from));
    const auto to = static_cast<std::uint32_t>(inputs::node_index_of(graph.features[i].to));
    const bool is_edge =
        find_edge(image, std::min(from, to), std::max(from, to)) < image.edges.size();
    image.subsegments.push_back({.from = from, .to = to, .feature = i, .is_edge = is_edge});
  }
  return image;
}

struct Size {
  double width = 0;
  double height = 0;
};

Size size_of(const std::string& svg) {
  Size size;
  const std::size_t at = svg.find("viewBox=\"0 0 ");
  if (at != std::string::npos) {
    std::sscanf(svg.c_str() + at, "viewBox=\"0 0 %lf %lf\"", &size.width, &size.height);
  }
  return size;
}

}  // namespace

std::string mesh_panels(const inputs::Graph& graph) {
  const auto draw = [](const files::MeshImage& image, std::string title) {
    return files::svg_text(image, {.title = std::move(title), .are_features_dashed = true});
  };
  std::vector<std::string> panels{
      draw(delaunay_with_features(graph), "Delaunay, before the features")};
  for (const System& system : all_systems()) {
    panels.push_back(draw(system.run(graph, Depth::whole).image, std::string(system.label)));
  }
  Size cell;
  for (const std::string& panel : panels) {
    const Size size = size_of(panel);
    cell.width = std::max(cell.width, size.width * scale);
    cell.height = std::max(cell.height, size.height * scale);
  }
  const auto place = [&](std::size_t i) {
    return std::to_string(cell.width * static_cast<double>(i % columns)) + " " +
           std::to_string(cell.height * static_cast<double>(i / columns));
  };
  const std::string width = std::to_string(cell.width * columns);
  const std::string height =
      std::to_string(cell.height * static_cast<double>((panels.size() + columns - 1) / columns));
  std::string page = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + width + " " +
                     height + "\" width=\"" + width + "\" height=\"" + height + "\">\n";
  for (std::size_t i = 0; i < panels.size(); ++i) {
    page += "<g transform=\"translate(" + place(i) + ") scale(" + std::to_string(scale) + ")\">\n" +
            panels[i] + "</g>\n";
  }
  return page + "</svg>\n";
}

}  // namespace etcm::compare
