// Bytes changed a little, as a bad line or a hostile peer might.
#pragma once

#include <cstdint>
#include <random>

#include "peer.h"

namespace etcm::port {

// Changes so many places: a bit, a byte, one byte less or more, or a stretch that comes twice. The
// vector ends where its bytes do, so that a sanitizer sees what is read beyond them.
inline void mutate(Bytes& bytes, std::size_t changes, std::mt19937& chance) {
  const auto place = [&] {
    return bytes.begin() + static_cast<std::ptrdiff_t>(chance() % bytes.size());
  };
  for (; changes > 0 && !bytes.empty(); --changes) {
    switch (chance() % 5) {
      case 0:
        *place() ^= static_cast<std::uint8_t>(1 << chance() % 8);
        break;
      case 1:
        *place() = static_cast<std::uint8_t>(chance());
        break;
      case 2:
        bytes.erase(place());
        break;
      case 3:
        bytes.insert(place(), static_cast<std::uint8_t>(chance()));
        break;
      case 4: {
        const auto from = chance() % bytes.size();
        const auto count = 1 + chance() % std::min<std::size_t>(bytes.size() - from, 20);
        const Bytes stretch(bytes.begin() + static_cast<std::ptrdiff_t>(from),
                            bytes.begin() + static_cast<std::ptrdiff_t>(from + count));
        bytes.insert(place(), stretch.begin(), stretch.end());
        break;
      }
    }
  }
  bytes.shrink_to_fit();
}

// Requests that a server of registers may get, one behind another.
inline Bytes request_stream(std::size_t requests, std::mt19937& chance) {
  Bytes stream;
  for (std::size_t i = 0; i < requests; ++i) {
    const auto low = static_cast<std::uint8_t>(chance());
    const Bytes pdus[] = {{4, 0, low, 0, 10},
                          {3, low, 0, 0, 125},
                          {16, 0, low, 0, 2, 4, 1, 2, 3, 4},
                          {17},
                          {43, 14, 1, 0},
                          {8, 0, 0, low, low},
                          {low, 0, 0}};
    const Bytes frame = frame_of(static_cast<std::uint16_t>(i), static_cast<std::uint8_t>(low % 4),
                                 pdus[chance() % std::size(pdus)]);
    stream.insert(stream.end(), frame.begin(), frame.end());
  }
  return stream;
}

}  // namespace etcm::port
