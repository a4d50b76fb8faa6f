// The policies of C programs as policies of the library.
#pragma once

#include "etcm/c/policy.h"
#include "etcm/config.h"

namespace etcm::c {

// Makes the configuration ask that policy, which must outlive the mesh.
void set_policy(MeshConfig& config, const etcm_split_policy_t& policy) noexcept;

// The one that set_policy() has set; null where there was none.
const etcm_split_policy_t* policy_of(const MeshConfig& config) noexcept;

}  // namespace etcm::c
