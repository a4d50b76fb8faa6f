#include "posix/mesh_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "etcm/files/exchange.h"
#include "etcm/files/file_set.h"
#include "etcm/files/mesh_image.h"
#include "etcm/files/mesh_text.h"
#include "etcm/files/picture.h"
#include "posix/file_descriptor.h"

namespace etcm::port {

// What the thread uses, and keeps should it hang.
struct MeshFolder::Writing {
  Writing(const std::string& where, const std::string& base, std::string title,
          std::uint32_t vertices_max)
      : folder(where),
        lock_path(std::filesystem::path(where) / ("." + title + ".lock")),
        words{.title = std::move(title)} {
    room.reserve(vertices_max);
    files.add(base + ".node", [this](files::TextSink& out) { files::write_node(out, *image); });
    files.add(base + ".ele", [this](files::TextSink& out) { files::write_ele(out, *image); });
    files.add(base + ".svg",
              [this](files::TextSink& out) { files::write_svg(out, *image, words, {}, room); });
  }

  void add_values(const std::string& base) {
    if (std::exchange(has_values, true)) return;
    files.add(base + ".geojson",
              [this](files::TextSink& out) { files::write_geojson(out, *image); });
  }

  void run() {
    action = "cannot be written";
    if (image != nullptr && is_made) {
      failure = files.try_commit();
      // It may have gone, and can be made again.
      if (failure.error != ENOENT) return;
    }
    make_folder();
    if (is_made && image != nullptr) failure = files.try_commit();
  }

  void make_folder() {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    is_made = !error;
    if (error) {
      action = "cannot make the folder";
      failure = {&folder, error.value()};
      return;
    }
    const bool can_write = ::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0;
    failure = can_write ? files::FileSet::Failure{} : files::FileSet::Failure{&folder, errno};
    is_made = lock();
    if (!is_made) return;
    if (!std::exchange(is_clean, true)) files.remove_leftovers();
  }

  // Anew where the folder was. On a disk that knows no locks all goes on without.
  bool lock() {
    locked = FileDescriptor(
        ::open(lock_path.c_str(), O_RDONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644));
    if (!locked.is_open() || ::flock(locked.get(), LOCK_EX | LOCK_NB) == 0 ||
        errno != EWOULDBLOCK) {
      return true;
    }
    action = "another program writes files of this name there, so cannot lock it";
    failure = {&lock_path, EWOULDBLOCK};
    return false;
  }

  const std::string folder;
  const std::string lock_path;
  FileDescriptor locked;
  bool is_made = false;   // as far as is known
  bool is_clean = false;  // of what a crash left
  bool has_values = false;
  std::shared_ptr<const files::MeshImage> image;  // null: check only
  files::PictureText words;
  files::PictureRoom room;
  files::FileSet files;
  const char* action = nullptr;  // that failed
  files::FileSet::Failure failure;
};

MeshFolder::MeshFolder(const std::string& folder, const std::string& name,
                       std::uint32_t vertices_max, bool has_values)
    : base_(std::filesystem::path(folder) / name),
      writing_(std::make_shared<Writing>(folder, base_, name, vertices_max)),
      worker_("etcm-files", [writing = writing_] { writing->run(); }),
      has_values_(has_values) {
  if (has_values) writing_->add_values(base_);
}

void MeshFolder::start_check() {
  writing_->image.reset();
  is_result_due_ = true;
  worker_.start();
}

void MeshFolder::start_write(std::shared_ptr<const files::MeshImage> image) {
  if (has_values_) writing_->add_values(base_);
  writing_->image = std::move(image);
  is_result_due_ = true;
  worker_.start();
}

bool MeshFolder::take_result(DiskResult& result) {
  if (!is_result_due_ || worker_.is_busy()) return false;
  is_result_due_ = false;
  const files::FileSet::Failure& failure = writing_->failure;
  result = {.ok = failure.path == nullptr, .why = {}};
  if (!result.ok) {
    result.why = words_.describe(*failure.path, writing_->action, failure.error, "files");
  }
  return true;
}

}  // namespace etcm::port
