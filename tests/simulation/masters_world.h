// Masters that read the mesh as registers: who has begun with one image goes on with it, however
// many have been published since.
#pragma once

#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "etcm/port/mesh_server.h"

namespace etcm::simulation {

class MastersWorld final : public port::MeshServer {
 public:
  // As many as may be connected.
  static constexpr std::size_t count_max = 8;

  void publish(std::shared_ptr<const port::RegisterImage> image) override {
    last = std::move(image);
    ++count;
  }
  // One reads the header, and is slow with the rest. False: what the first of them has read from
  // is no longer what it was.
  bool begin_reading() {
    if (last == nullptr) return true;
    reading_.emplace_back(last, last->registers);
    return reading_.size() < count_max || end_reading();
  }

  std::shared_ptr<const port::RegisterImage> last;
  std::uint64_t count = 0;

 private:
  bool end_reading() {
    const auto [image, registers] = std::move(reading_.front());
    reading_.pop_front();
    return image->registers == registers;
  }

  std::deque<std::pair<std::shared_ptr<const port::RegisterImage>, std::vector<std::uint16_t>>>
      reading_;
};

}  // namespace etcm::simulation
