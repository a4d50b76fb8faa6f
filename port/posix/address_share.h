// How many of the places for connections one address may take.
#pragma once

#include <cstddef>

namespace etcm::port {

// Three quarters, so that one that connects again and again does not keep all others out; of fewer
// than four all.
constexpr std::size_t places_of_one_address(std::size_t places) { return places - places / 4; }

}  // namespace etcm::port
