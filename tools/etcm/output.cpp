#include "output.h"

#include <filesystem>
#include <iostream>

#include "etcm/files/file_set.h"
#include "etcm/files/mesh_text.h"
#include "etcm/files/picture.h"

namespace etcm::cli {

void OutputOptions::add_to(CLI::App& command) {
  command
      .add_option("-o,--output", base_, "Write OUT.node, OUT.ele, OUT.edge, OUT.poly and OUT.svg")
      ->required()
      ->type_name("OUT");
  domain_.add_to(command);
  command.add_option("--unit", unit_, "What the scale bar of the picture counts")
      ->capture_default_str();
}

void OutputOptions::refuse_overwriting(const files::ConstraintGraph& graph) const {
  if (base_.empty() || base_.back() == '/' || std::filesystem::is_directory(base_)) {
    throw UsageError("-o " + base_ +
                     ": names a folder; add a name for the mesh, as in folder/mesh");
  }
  const std::string inputs[] = {graph.node_file, graph.poly_file};
  for (const char* extension : {".node", ".ele", ".edge", ".poly", ".svg"}) {
    refuse_replacing("-o", base_ + extension, inputs);
  }
}

void OutputOptions::write(const Mesh& mesh, const files::MeshImage& image) const {
  files::FileSet files;
  files::add_mesh_files(image, base_, files);
  files.add(base_ + ".svg", files::svg_text(image, {title_of(base_), unit_}));
  files.commit();
  if (image.triangles.empty() && mesh.finite_triangle_count() > 0) {
    std::cerr
        << "etcm: " << base_
        << ": no triangle is inside the domain; close the features around it, move the holes, "
           "or use --domain hull"
        << std::endl;
  }
}

void refuse_replacing(const std::string& option, const std::string& path,
                      std::span<const std::string> inputs) {
  for (const std::string& input : inputs) {
    std::error_code none;
    if (input.empty() || !std::filesystem::equivalent(path, input, none)) continue;
    throw UsageError(option + " " + path + ": would replace the input " + input +
                     "; give another name");
  }
}

std::string title_of(const std::string& base) {
  return std::filesystem::path(base).filename().string();
}

}  // namespace etcm::cli
