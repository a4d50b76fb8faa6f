#include <array>
#include <cstdio>

#include "etcm/analysis.h"
#include "etcm/storage.h"

int main() {
  static etcm::MeshStorage<8, 0> storage;
  etcm::Mesh mesh;
  if (mesh.open(storage.bytes(), storage.config()) != etcm::Status::ok) return 1;
  for (const etcm::Position position : {etcm::Position{0, 0}, {30, 0}, {30, 40}}) {
    etcm::VertexId id;
    if (mesh.join(position, id) != etcm::Status::ok) return 1;
  }
  std::array<etcm::ConnectivityScratch, 9> scratch;
  etcm::Connectivity found;
  if (etcm::connectivity(mesh, 30, scratch, found) != etcm::Status::ok) return 1;
  std::printf("%u parts, one at %u\n", static_cast<unsigned>(found.parts),
              static_cast<unsigned>(etcm::range_for(found.least)));
}
