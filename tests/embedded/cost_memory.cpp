#include "cost_memory.h"

#include "console.h"
#include "etcm/analysis.h"
#include "etcm/handles.h"

namespace etcm::test {

void put_memory(std::uint32_t nodes) noexcept {
  const MeshConfig config = capacity_for(nodes, nodes / 10);
  const std::uint64_t vertices = config.vertices_max, triangles = 2 * vertices;
  put("ram");
  for (const std::uint64_t value :
       {std::uint64_t{nodes}, std::uint64_t{nodes / 10}, vertices,
        std::uint64_t{config.features_max}, std::uint64_t{storage_bytes(config)},
        std::uint64_t{saved_bytes_most(config.vertices_max, config.features_max)},
        std::uint64_t{Handles::words(config) * sizeof(std::uint32_t)},
        triangles * (sizeof(Region) + sizeof(TriangleId)),
        (vertices + 1) * sizeof(ConnectivityScratch)}) {
    put(";");
    put_number(value);
  }
  put("\n");
}

}  // namespace etcm::test
