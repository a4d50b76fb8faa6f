// MeshFiles in a folder: NAME.node, NAME.ele, NAME.svg, and where nodes measure NAME.geojson,
// written by a thread of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "etcm/port/mesh_files.h"
#include "posix/disk_failure.h"
#include "posix/worker.h"

namespace etcm::port {

class MeshFolder final : public MeshFiles {
 public:
  // Touches nothing yet; takes all the memory now that so many vertices need. Where there is no
  // folder, it is made when it is needed. What is done first locks the name (by .NAME.lock, which
  // stays), so that two programs do not overwrite each other's files, and removes the temporary
  // files of an earlier gateway that was killed while it wrote.
  MeshFolder(const std::string& folder, const std::string& name, std::uint32_t vertices_max,
             bool has_values = false);

  // From the next write on NAME.geojson is written too. Takes its memory then.
  void add_values() { has_values_ = true; }

  void start_check() override;
  void start_write(std::shared_ptr<const files::MeshImage> image) override;
  bool take_result(DiskResult& result) override;

  // Waits for a write under way; false when that takes longer than `at_most`. It is then left
  // behind.
  bool wait(Duration at_most) { return worker_.wait(at_most); }

  // The path without its extension.
  const std::string& base() const { return base_; }

 private:
  struct Writing;

  std::string base_;
  std::shared_ptr<Writing> writing_;
  Worker worker_;
  bool has_values_;
  bool is_result_due_ = false;
  DiskFailure words_;
};

}  // namespace etcm::port
