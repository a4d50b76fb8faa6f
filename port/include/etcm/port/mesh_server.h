// Serves the mesh to Modbus masters as a read-only image of registers.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace etcm::port {

// Registers in one flat row that no 16-bit address bounds: register r of unit u is element
// (u - 1) * registers_per_unit + r. Element 0 is the first register of the header. Never changed
// once it is published.
struct RegisterImage {
  std::uint32_t registers_per_unit = 0;
  std::vector<std::uint16_t> registers;
};

class MeshServer {
 public:
  // From now on a client that reads the header sees `image`, and so does one that has read none;
  // others go on with the image whose header they read last, while they read on in it.
  virtual void publish(std::shared_ptr<const RegisterImage> image) = 0;

 protected:
  ~MeshServer() = default;
};

}  // namespace etcm::port
