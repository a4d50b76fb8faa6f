// The files that `mesh` and `replay` leave: BASE.node, .ele, .edge, .poly and .svg.
#pragma once

#include <span>
#include <string>

#include "command.h"
#include "etcm/files/mesh_image.h"

namespace etcm::cli {

class OutputOptions {
 public:
  void add_to(CLI::App& command);

  const std::string& base() const { return base_; }
  Exterior exterior() const { return domain_.exterior(); }
  // Throws UsageError where an output would replace one of the graph's own files.
  void refuse_overwriting(const files::ConstraintGraph& graph) const;
  // Throws OutputError. Says so on the standard error where the domain came out empty.
  void write(const Mesh& mesh, const files::MeshImage& image) const;

 private:
  std::string base_;
  DomainOption domain_;
  std::string unit_ = "units";
};

// Throws UsageError where what is written to `path`, by that option, would replace an input. An
// empty name is no input.
void refuse_replacing(const std::string& option, const std::string& path,
                      std::span<const std::string> inputs);

// The last part of a path: what a picture is titled with.
std::string title_of(const std::string& base);

}  // namespace etcm::cli
