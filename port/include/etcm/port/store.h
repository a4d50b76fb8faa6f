// Keeps one piece of state over a restart and over a power failure.
#pragma once

#include <cstddef>
#include <span>

namespace etcm::port {

class Store {
 public:
  // Replaces what is kept: after a crash at any moment, load() gives the old bytes or the new ones.
  // False when that failed; the old bytes then stay.
  virtual bool save(std::span<const std::byte> bytes) = 0;

  // Copies what is kept into `out`, as much as fits, and returns how much there is; 0 for nothing.
  virtual std::size_t load(std::span<std::byte> out) = 0;

 protected:
  ~Store() = default;
};

}  // namespace etcm::port
