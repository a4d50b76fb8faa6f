// How figures are written in tables.
#pragma once

#include <cstddef>
#include <string>

namespace etcm::compare {

// With so many digits after the point.
std::string decimal(double value, int digits);

// "part of whole", or "all".
std::string share(std::size_t part, std::size_t whole);

}  // namespace etcm::compare
