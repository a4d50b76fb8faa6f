#include "posix/mesh_folder.h"

#include <filesystem>
#include <limits>

#include "etcm/files/error.h"
#include "etcm/files/file_set.h"
#include "etcm/files/mesh_image.h"
#include "etcm/files/mesh_text.h"
#include "etcm/files/picture.h"

namespace etcm::port {

MeshFolder::MeshFolder(const std::string& folder, const std::string& name)
    : base_(std::filesystem::path(folder) / name), title_(name) {
  std::filesystem::create_directories(folder);
}

bool MeshFolder::write(const Mesh& mesh, std::span<const std::uint32_t> serials, std::string& why) {
  try {
    files::MeshImage image = files::image_of(mesh, Exterior::automatic, {});
    // The image has the nodes in the order of their ids, and then the Steiner vertices.
    image.attribute_count = 1;
    for (std::uint32_t id = 1; id < mesh.vertex_id_end(); ++id) {
      const bool is_node = mesh.kind(VertexId{static_cast<IdValue>(id)}) == VertexKind::node;
      if (!is_node) continue;
      // An anchor has no serial.
      const bool has_serial = serials[id] != std::numeric_limits<std::uint32_t>::max();
      image.attributes.push_back(has_serial ? std::to_string(serials[id]) : "-1");
    }
    image.attributes.resize(image.vertices.size(), "-1");

    files::FileSet set;
    set.add(base_ + ".node", files::node_text(image));
    set.add(base_ + ".ele", files::ele_text(image));
    set.add(base_ + ".svg", files::svg_text(image, {.title = title_}));
    set.commit();
    return true;
  } catch (const files::OutputError& error) {
    why = error.what();
    return false;
  }
}

}  // namespace etcm::port
