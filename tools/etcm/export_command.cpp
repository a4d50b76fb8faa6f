// etcm export OUT --geojson|--vtk|--svg FILE
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "command.h"
#include "etcm/files/exchange.h"
#include "etcm/files/file_set.h"
#include "etcm/files/mesh_text.h"
#include "etcm/files/picture.h"
#include "output.h"

namespace etcm::cli {

namespace {

struct ExportOptions {
  std::string base;
  std::string geojson;
  std::string vtk;
  std::string svg;
  std::string unit = "units";
};

int run_export(const ExportOptions& options) {
  if (options.geojson.empty() && options.vtk.empty() && options.svg.empty()) {
    throw UsageError("export: give --geojson, --vtk or --svg with a file name (- is stdout)");
  }
  const std::string inputs[] = {options.base + ".node", options.base + ".ele",
                                options.base + ".edge", options.base + ".poly"};
  std::set<std::string> outputs;
  for (const auto& [option, path] :
       {std::pair{"--geojson", options.geojson}, {"--vtk", options.vtk}, {"--svg", options.svg}}) {
    refuse_replacing(option, path, inputs);
    if (!path.empty() && !outputs.insert(path).second) {
      throw UsageError(std::string(option) + " " + path +
                       ": another format goes there too; give each a file of its own");
    }
  }
  const files::MeshImage image = files::read_mesh(options.base);
  files::FileSet files;
  if (!options.geojson.empty()) files.add(options.geojson, files::geojson_text(image));
  if (!options.vtk.empty()) files.add(options.vtk, files::vtk_text(image));
  if (!options.svg.empty()) {
    files.add(options.svg, files::svg_text(image, {title_of(options.base), options.unit}));
  }
  files.commit();
  return exit_ok;
}

}  // namespace

void add_export_command(CLI::App& program, Run& run) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App& command = *program.add_subcommand("export", "Write a mesh in another format");
  command.add_option("OUT", options->base, "The mesh, as -o of mesh named it")->required();
  command.add_option("--geojson", options->geojson, "GeoJSON in planar coordinates; - is stdout");
  command.add_option("--vtk", options->vtk, "Legacy VTK, for ParaView; - is stdout");
  command.add_option("--svg", options->svg, "Picture; - is stdout");
  command.add_option("--unit", options->unit, "What the scale bar of the picture counts")
      ->capture_default_str();
  command.callback([options, &run] { run = [options] { return run_export(*options); }; });
}

}  // namespace etcm::cli
