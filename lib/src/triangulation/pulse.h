// The hook of a mesh (etcm/work.h) while a call only reads: who changes has its meter call it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/checksum.h"
#include "triangulation/mesh_state.h"

namespace etcm::internal {

class Pulse {
 public:
  explicit Pulse(const Mesh& mesh) noexcept : hook_(MeshAccess::hook(mesh)) {}
  explicit Pulse(const MeshState& m) noexcept : Pulse(*m.mesh) {}

  // Takes note of what is done next.
  void pass(std::uint32_t units) noexcept {
    if (units < left_) {
      left_ -= units;
    } else {
      beat();
    }
  }

 private:
  void beat() noexcept;

  const KeepAlive& hook_;
  std::uint32_t left_ = KeepAlive::units_between;
};

// Takes them into the sum, as one call of Checksum::add() does.
void sum_up(Checksum& sum, const std::byte* bytes, std::size_t count, Pulse& pulse) noexcept;

}  // namespace etcm::internal
