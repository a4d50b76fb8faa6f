// MeshFiles in a folder: NAME.node, NAME.ele and NAME.svg.
#pragma once

#include <string>

#include "etcm/port/mesh_files.h"

namespace etcm::port {

class MeshFolder final : public MeshFiles {
 public:
  // Makes the folder where there is none; throws std::filesystem::filesystem_error where it cannot.
  MeshFolder(const std::string& folder, const std::string& name);

  bool write(const Mesh& mesh, std::span<const std::uint32_t> serials, std::string& why) override;

  // The path without its extension.
  const std::string& base() const { return base_; }

 private:
  std::string base_;
  std::string title_;
};

}  // namespace etcm::port
