#include "posix/mesh_folder.h"

#include <filesystem>
#include <limits>
#include <utility>

#include "etcm/files/file_set.h"
#include "etcm/files/mesh_image.h"
#include "etcm/files/mesh_text.h"
#include "etcm/files/picture.h"

namespace etcm::port {

// What the thread uses, and keeps should it hang.
struct MeshFolder::Writing {
  Writing(const std::string& base, std::string title, const MeshConfig& config)
      : imager(config), words{.title = std::move(title)} {
    room.reserve(config.vertices_max);
    files.add(base + ".node", [this](files::TextSink& out) { files::write_node(out, *image); });
    files.add(base + ".ele", [this](files::TextSink& out) { files::write_ele(out, *image); });
    files.add(base + ".svg",
              [this](files::TextSink& out) { files::write_svg(out, *image, words, {}, room); });
  }

  files::Imager imager;
  files::MeshImage* image = nullptr;  // of the imager
  files::PictureText words;
  files::PictureRoom room;
  files::FileSet files;
  files::FileSet::Failure failure;
};

MeshFolder::MeshFolder(const std::string& folder, const std::string& name, const MeshConfig& config)
    : base_(std::filesystem::path(folder) / name),
      writing_(std::make_shared<Writing>(base_, name, config)),
      worker_("etcm-files",
              [writing = writing_] { writing->failure = writing->files.try_commit(); }) {
  std::filesystem::create_directories(folder);
  writing_->files.remove_leftovers();
}

void MeshFolder::start_write(const Mesh& mesh, std::span<const std::uint32_t> serials) {
  files::MeshImage& image = writing_->imager.make(mesh, Exterior::automatic, {});
  // The image has the nodes in the order of their ids, and then the Steiner vertices.
  image.attribute_count = 1;
  for (std::uint32_t id = 1; id < mesh.vertex_id_end(); ++id) {
    const bool is_node = mesh.kind(VertexId{static_cast<IdValue>(id)}) == VertexKind::node;
    if (!is_node) continue;
    // An anchor has no serial. Neither text is too long for a string without memory of its own.
    const bool has_serial = serials[id] != std::numeric_limits<std::uint32_t>::max();
    image.attributes.push_back(has_serial ? std::to_string(serials[id]) : "-1");
  }
  image.attributes.resize(image.vertices.size(), "-1");
  writing_->image = &image;
  is_result_due_ = true;
  worker_.start();
}

bool MeshFolder::take_result(DiskResult& result) {
  if (!is_result_due_ || worker_.is_busy()) return false;
  is_result_due_ = false;
  const files::FileSet::Failure& failure = writing_->failure;
  result = {.ok = failure.path == nullptr, .why = {}};
  if (!result.ok) {
    result.why = words_.describe(*failure.path, "cannot be written", failure.error, "files");
  }
  return true;
}

}  // namespace etcm::port
