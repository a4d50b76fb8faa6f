// The size that etcm.h tells of a mesh is the one that the library takes, in each width of ids.
#include <gtest/gtest.h>

#include "etcm/etcm.h"
#include "etcm/storage.h"

namespace etcm::test {
namespace {

// Two programs; each has its own names of tests.
#if ETCM_ID_BITS == 16
#define ETCM_SUITE CStorage16
#else
#define ETCM_SUITE CStorage32
#endif

static_assert(sizeof(etcm_id_t) == sizeof(IdValue));
// A constant.
ETCM_STORAGE(storage, 200, 20);
static_assert(sizeof storage == storage_bytes(200, 20));
static_assert(ETCM_SAVED_BYTES(200, 20) == saved_bytes_most(200, 20));
static_assert(ETCM_SAVED_BYTES(vertices_limit, features_limit) ==
              saved_bytes_most(vertices_limit, features_limit));

TEST(ETCM_SUITE, IsTheSameConstantForAllCapacities) {
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(storage) % 8, 0u);
  const auto check = [](std::uint32_t vertices, std::uint32_t features) {
    ASSERT_EQ(ETCM_STORAGE_BYTES(vertices, features), storage_bytes(vertices, features))
        << vertices << " vertices, " << features << " features";
  };
  for (std::uint32_t vertices = 1; vertices <= 5000; ++vertices) {
    if (vertices <= vertices_limit) check(vertices, vertices % 97);
  }
  for (std::uint32_t power = 2; power < 29; ++power) {
    for (const std::uint32_t vertices : {(1u << power) - 1, 1u << power, (1u << power) + 1}) {
      if (vertices > vertices_limit) continue;
      check(vertices, 0);
      check(vertices, features_limit);
    }
  }
  check(vertices_limit, features_limit);
}

}  // namespace
}  // namespace etcm::test
