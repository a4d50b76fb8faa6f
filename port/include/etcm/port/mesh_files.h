// Publishes the mesh as files that other programs read.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "etcm/mesh.h"

namespace etcm::port {

class MeshFiles {
 public:
  // Replaces the published files by those of `mesh`: a reader sees each file of the old mesh or of
  // the new one, never a part. False when that failed, with the reason in `why`; the old files
  // then stay. serials[id] is the serial of the node with that vertex id.
  virtual bool write(const Mesh& mesh, std::span<const std::uint32_t> serials,
                     std::string& why) = 0;

 protected:
  ~MeshFiles() = default;
};

}  // namespace etcm::port
