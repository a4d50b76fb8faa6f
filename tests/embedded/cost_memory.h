// The memory that a caller gives, as a line for cost.py.
#pragma once

#include <cstdint>

namespace etcm::test {

// What the mesh takes for so many nodes and a tenth as many features, and what some calls ask for
// besides, enough for whatever the mesh comes to hold.
void put_memory(std::uint32_t nodes) noexcept;

}  // namespace etcm::test
