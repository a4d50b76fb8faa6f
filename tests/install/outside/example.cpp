#include <cstdio>

#include "etcm/mesh.h"
#include "etcm/storage.h"

int main() {
  static etcm::MeshStorage<64, 8> storage;  // all the memory there will ever be
  etcm::Mesh mesh;
  if (mesh.open(storage.bytes(), storage.config()) != etcm::Status::ok) return 1;

  // Two sensors on either side of a river bank, and the bank itself from node 0 to node 1.
  etcm::VertexId node[4];
  const etcm::Position position[4] = {{0, 0}, {1000, 0}, {480, 90}, {520, -60}};
  for (int i = 0; i < 4; ++i) {
    if (mesh.join(position[i], node[i]) != etcm::Status::ok) return 1;
  }
  etcm::FeatureId bank;
  const etcm::Status status = mesh.add_feature({node[0], node[1]}, bank);
  std::printf("%s: %u triangles, %u Steiner vertices\n", etcm::to_string(status),
              static_cast<unsigned>(mesh.finite_triangle_count()),
              static_cast<unsigned>(mesh.steiner_count()));
  return status == etcm::Status::ok ? 0 : 1;
}
