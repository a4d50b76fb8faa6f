// The bytes of a command to an edge node of Sparkplug, as its specification has them.
#pragma once

#include <string>

namespace etcm::test {

// Field 2 of a payload is a metric; of that 1 is its name, 4 its datatype (11: a truth), 14 its
// value. Names and metrics are short enough for lengths of one byte.
inline std::string rebirth_command(bool value = true,
                                   const std::string& name = "Node Control/Rebirth") {
  const std::string metric = "\x0a" + std::string(1, static_cast<char>(name.size())) + name +
                             "\x20\x0b\x70" + (value ? '\x01' : '\0');
  return "\x08\x01\x12" + std::string(1, static_cast<char>(metric.size())) + metric;
}

}  // namespace etcm::test
