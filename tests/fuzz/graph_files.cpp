// Triangle's files: a graph is read, meshed and written in each format; or the four files of a mesh
// are read and shown. The first byte says which: 'n' a .node, 'p' a .poly and its .node, 'm' a
// mesh.
#include <algorithm>
#include <string>

#include "etcm/audit.h"
#include "etcm/files/error.h"
#include "etcm/files/exchange.h"
#include "etcm/files/grid.h"
#include "etcm/files/mesh_text.h"
#include "etcm/files/picture.h"
#include "inputs/owned_mesh.h"
#include "text_parts.h"

namespace etcm::fuzz {
namespace {

void show(const files::MeshImage& image) {
  require(!files::svg_text(image, {}).empty(), "no picture");
  require(!files::geojson_text(image).empty(), "no GeoJSON");
  require(!files::vtk_text(image).empty(), "no VTK");
  static_cast<void>(files::quality_of(image));
  static_cast<void>(files::outline_edges(image));
}

// The files tell Steiner vertices by the lowest marker alone (mesh_text.h): without one a node that
// has a negative marker is taken for one.
bool tells_nodes_apart(const files::MeshImage& image) {
  return image.steiner_count() != 0 ||
         std::none_of(image.vertices.begin(), image.vertices.end(),
                      [](const files::ImageVertex& vertex) { return vertex.marker < 0; });
}

// What is written reads back.
void write_and_read(const files::MeshImage& image) {
  scratch().write("again.node", files::text_of(files::write_node, image));
  scratch().write("again.ele", files::text_of(files::write_ele, image));
  scratch().write("again.edge", files::text_of(files::write_edge, image));
  scratch().write("again.poly", files::text_of(files::write_poly, image));
  const files::MeshImage again = files::read_mesh(scratch().path("again"));
  require(again.vertices == image.vertices && again.triangles == image.triangles &&
              again.edges == image.edges && again.subsegments.size() == image.subsegments.size(),
          "what was written reads as another mesh");
}

void mesh(const files::ConstraintGraph& graph, const files::Placement& placement) {
  const files::GridGraph grid = files::place_on_grid(graph, placement);
  if (grid.nodes.size() > 300 || grid.features.size() > 100) return;
  inputs::OwnedMesh owned(inputs::config_for({"", grid.nodes, grid.features}, 300));
  require(owned.opened() == Status::ok, "open()");
  const Status status = owned->build(grid.nodes, grid.features, Work{1'000'000});
  if (owned->node_count() == 0) {
    if (status == Status::ok || status == Status::work_limit) return;
    require(!files::describe_refusal(graph, grid, owned->error_detail()).empty(), "no reason");
    return;
  }
  files::MeshImage image = files::image_of(*owned, Exterior::automatic, grid.holes);
  files::carry_through(graph, placement, image);
  show(image);
  if (status == Status::ok && tells_nodes_apart(image)) write_and_read(image);
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  const std::uint8_t kind = input.byte(), placed = input.byte();
  std::string_view text = text_of(input.rest());
  const std::string name = kind == 'n' ? "a.node" : "a.poly";
  try {
    const std::string path = scratch().write(name, take_part(text));
    if (kind != 'n') scratch().write("a.node", take_part(text));
    if (kind != 'm') {
      const files::ConstraintGraph graph = files::read_graph(path);
      files::Placement placement{.scale = {}, .round = placed % 2 == 1};
      if (placed % 4 >= 2) placement.scale = files::Decimal::parse("0.25");
      return mesh(graph, placement);
    }
    scratch().write("a.ele", take_part(text));
    scratch().write("a.edge", take_part(text));
    show(files::read_mesh(scratch().path("a")));
  } catch (const files::InputError& error) {
    const std::string_view what = error.what();
    require(!what.empty() && what.find('\n') == what.npos, "a mistake is not one line");
  }
}

}  // namespace etcm::fuzz
