// Register images that are used again once no client looks at them.
//
// There are never more than the server holds and one: the published one, and at most one that each
// client is pinned to. In one thread.
#pragma once

#include <cstddef>
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

  // Lists may be of other lengths from now on. `snapshot` is the one that was encoded last; mesh
  // and readings are encoded with their new lengths from the next time on.
  void set_capacity(const MeshRegisterCapacity& capacity, const Snapshot& snapshot);

  // Mesh and readings as registers. The readings are of this generation.
  std::shared_ptr<const port::RegisterImage> encode(const Snapshot& snapshot,
                                                    const ReadingSnapshot& readings);
  // Other readings beside the mesh that was encoded last: less work than all of it.
  std::shared_ptr<const port::RegisterImage> encode(const ReadingSnapshot& readings);

 private:
  // The number of one that nobody looks at.
  std::size_t free_image();

  MeshRegisterCapacity capacity_;
  std::vector<std::shared_ptr<port::RegisterImage>> images_;
  std::size_t newest_ = 0;
};

}  // namespace etcm::firmware
