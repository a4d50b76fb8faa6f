// A number with its noun, for a person: "1 node", "2 nodes".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace etcm::firmware {

struct Counted {
  std::uint64_t number;
  std::string_view one;
  std::string_view many;
};

template <class Text>
Text& operator<<(Text& text, const Counted& counted) {
  return text << counted.number << " " << (counted.number == 1 ? counted.one : counted.many);
}

inline std::string to_string(const Counted& counted) {
  return std::to_string(counted.number) + " " +
         std::string(counted.number == 1 ? counted.one : counted.many);
}

}  // namespace etcm::firmware
