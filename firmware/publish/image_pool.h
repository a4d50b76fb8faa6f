// Register images that are used again once no client looks at them.
//
// There are never more than the server holds and one: the published one, and at most one that each
// client is pinned to. In one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "etcm/port/mesh_server.h"
#include "firmware/publish/mesh_registers.h"
#include "firmware/publish/snapshot.h"

namespace etcm::firmware {

class ImagePool {
 public:
  // Takes the memory of `ready` images at once, and room to know `images_max`.
  ImagePool(const MeshRegisterCapacity& capacity, std::size_t ready, std::size_t images_max);

  // The snapshot as registers.
  std::shared_ptr<const port::RegisterImage> encode(const Snapshot& snapshot);

 private:
  const MeshRegisterCapacity capacity_;
  std::vector<std::shared_ptr<port::RegisterImage>> images_;
};

}  // namespace etcm::firmware
