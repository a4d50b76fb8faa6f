// The bytes of a mesh from C: the same as from C++.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <span>

#include "etcm/etcm.h"

namespace {

ETCM_STORAGE(storage_of_c, 40, 4);
ETCM_STORAGE(copy_of_c, 40, 4);

TEST(CBytes, AreAMeshAgainWhereverTheyAre) {
  etcm_mesh_t mesh{};
  etcm_config_t config{};
  config.vertices_max = 40;
  config.features_max = 4;
  ASSERT_EQ(etcm_open(&mesh, storage_of_c, sizeof storage_of_c, &config), ETCM_OK);
  const std::array<etcm_position_t, 3> nodes{{{0, 0}, {90, 0}, {40, 70}}};
  const etcm_feature_ends_t feature{1, 2};
  ASSERT_EQ(etcm_build(&mesh, nodes.data(), nodes.size(), &feature, 1, ETCM_UNLIMITED), ETCM_OK);
  etcm_seal(&mesh);
  std::memcpy(copy_of_c, storage_of_c, sizeof copy_of_c);

  etcm_reader_t reader{};
  ASSERT_EQ(etcm_reader_attach(&reader, copy_of_c, sizeof copy_of_c), ETCM_OK);
  EXPECT_EQ(etcm_hash(etcm_reader_mesh(&reader)), etcm_hash(&mesh));
  etcm_mesh_t copy{};
  ASSERT_EQ(etcm_attach(&copy, copy_of_c, sizeof copy_of_c, nullptr), ETCM_OK);
  etcm_vertex_t node = ETCM_NONE;
  ASSERT_EQ(etcm_join(&copy, {50, 20}, ETCM_UNLIMITED, &node), ETCM_OK);
  EXPECT_EQ(etcm_attach(&copy, copy_of_c, sizeof copy_of_c, nullptr), ETCM_DAMAGED);
  ASSERT_EQ(etcm_attach_copy(&copy, copy_of_c, sizeof copy_of_c, nullptr), ETCM_OK);
  ASSERT_EQ(etcm_reader_attach_copy(&reader, copy_of_c, sizeof copy_of_c), ETCM_OK);
  EXPECT_EQ(etcm_node_count(etcm_reader_mesh(&reader)), 4u);
  const etcm_split_policy_t policy{etcm_split_paper, nullptr};
  etcm_seal(&copy);
  ASSERT_EQ(etcm_attach(&copy, copy_of_c, sizeof copy_of_c, &policy), ETCM_OK);
  const etcm_split_policy_t no_function{nullptr, nullptr};
  EXPECT_EQ(etcm_attach(&copy, copy_of_c, sizeof copy_of_c, &no_function), ETCM_BAD_CONFIG);
  EXPECT_EQ(etcm_attach_copy(&copy, copy_of_c, sizeof copy_of_c, &no_function), ETCM_BAD_CONFIG);

  static unsigned char saved_bytes[ETCM_SAVED_BYTES(40, 4)];
  const std::span saved(saved_bytes);
  ASSERT_EQ(saved.size(), etcm_saved_bytes_most(40, 4));
  ASSERT_LE(etcm_saved_bytes(&copy), saved.size());
  ASSERT_EQ(etcm_save(&copy, saved.data(), saved.size()), ETCM_OK);
  EXPECT_EQ(etcm_load(&mesh, saved.data(), saved.size(), ETCM_UNLIMITED), ETCM_MESH_NOT_EMPTY);
  etcm_clear(&mesh);
  ASSERT_EQ(etcm_load(&mesh, saved.data(), saved.size(), ETCM_UNLIMITED), ETCM_OK);
  EXPECT_EQ(etcm_hash(&mesh), etcm_hash(&copy));
}

}  // namespace
