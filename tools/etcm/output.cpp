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
  for (const char* extension : {".node", ".poly"}) {
    for (const std::string& input : {graph.node_file, graph.poly_file}) {
      std::error_code error;
      if (!input.empty() && std::filesystem::equivalent(base_ + extension, input, error)) {
        throw UsageError("-o " + base_ + ": would replace the input " + input +
                         "; give the mesh another name");
      }
    }
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

std::string title_of(const std::string& base) {
  return std::filesystem::path(base).filename().string();
}

}  // namespace etcm::cli
