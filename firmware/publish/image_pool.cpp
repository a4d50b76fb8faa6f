#include "firmware/publish/image_pool.h"

#include <algorithm>

namespace etcm::firmware {

ImagePool::ImagePool(const MeshRegisterCapacity& capacity, std::size_t ready,
                     std::size_t images_max)
    : capacity_(capacity) {
  images_.reserve(images_max);
  for (std::size_t i = 0; i < ready; ++i) {
    images_.push_back(std::make_shared<port::RegisterImage>());
    encode_mesh(Snapshot{}, capacity, *images_.back());
  }
}

void ImagePool::set_capacity(const MeshRegisterCapacity& capacity, const Snapshot& snapshot) {
  if (capacity == capacity_) return;
  capacity_ = capacity;
  // What is encoded beside this mesh needs an image that has room for it.
  newest_ = free_image();
  encode_mesh(snapshot, capacity_, *images_[newest_]);
}

std::size_t ImagePool::free_image() {
  auto free = std::find_if(images_.begin(), images_.end(),
                           [](const auto& image) { return image.use_count() == 1; });
  if (free == images_.end()) {
    images_.push_back(std::make_shared<port::RegisterImage>());
    free = images_.end() - 1;
  }
  return static_cast<std::size_t>(free - images_.begin());
}

std::shared_ptr<const port::RegisterImage> ImagePool::encode(const Snapshot& snapshot,
                                                             const ReadingSnapshot& readings) {
  newest_ = free_image();
  encode_mesh(snapshot, capacity_, *images_[newest_]);
  encode_readings(readings, capacity_, *images_[newest_]);
  return images_[newest_];
}

std::shared_ptr<const port::RegisterImage> ImagePool::encode(const ReadingSnapshot& readings) {
  const std::size_t free = free_image();
  if (free != newest_) *images_[free] = *images_[newest_];
  newest_ = free;
  encode_readings(readings, capacity_, *images_[newest_]);
  return images_[newest_];
}

}  // namespace etcm::firmware
