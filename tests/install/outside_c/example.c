#include <stdio.h>

#include "etcm/etcm.h"

int main(void) {
  static ETCM_STORAGE(storage, 64, 8);  // all the memory there will ever be
  static etcm_mesh_t mesh;
  const etcm_config_t config = {.vertices_max = 64, .features_max = 8};
  if (etcm_open(&mesh, storage, sizeof storage, &config) != ETCM_OK) return 1;

  // Two sensors on either side of a river bank, and the bank itself from node 0 to node 1.
  etcm_vertex_t node[4];
  const etcm_position_t position[4] = {{0, 0}, {1000, 0}, {480, 90}, {520, -60}};
  for (int i = 0; i < 4; ++i) {
    if (etcm_join(&mesh, position[i], ETCM_UNLIMITED, &node[i]) != ETCM_OK) return 1;
  }
  etcm_feature_t bank;
  const etcm_status_t status = etcm_add_feature(&mesh, node[0], node[1], ETCM_UNLIMITED, &bank);
  printf("%s: %u triangles, %u Steiner vertices\n", etcm_status_name(status),
         (unsigned)etcm_finite_triangle_count(&mesh), (unsigned)etcm_steiner_count(&mesh));
  return status == ETCM_OK ? 0 : 1;
}
