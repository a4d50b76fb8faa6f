// Publishes the mesh as files that other programs read.
//
// Like a store it waits for no disk: take_result() tells later how what was started ended. Nothing
// is done before one of the two is started.
#pragma once

#include <memory>

#include "etcm/port/disk_result.h"

namespace etcm::files {
struct MeshImage;
}

namespace etcm::port {

class MeshFiles {
 public:
  // Starts to see whether files can be written, so that what is in their way shows before there is
  // a mesh; makes the folder where there is none. REQUIRES: nothing is under way.
  virtual void start_check() = 0;

  // Starts to replace the published files by those of this mesh. A reader sees each file of the old
  // mesh or of the new one, never a part; where it fails, the old files stay. REQUIRES: nothing is
  // under way, the mesh is no larger than the adapter was made for, and the image does not change
  // until take_result() has told how it ended.
  virtual void start_write(std::shared_ptr<const files::MeshImage> image) = 0;

  // How the write or the check that has ended went; false when there is nothing to tell. Each is
  // told once.
  virtual bool take_result(DiskResult& result) = 0;

 protected:
  ~MeshFiles() = default;
};

}  // namespace etcm::port
