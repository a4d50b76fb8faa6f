// A stream of MQTT packets of a broker, before libmosquitto sees it: what is let through does not
// depend on how the network cuts it. The first byte says how.
#include <algorithm>

#include "fuzz_target.h"
#include "mqtt/packet_guard.h"

namespace etcm::fuzz {
namespace {

constexpr std::uint32_t packet_bytes_max = 1000;

struct Passed {
  bool is_sound = true;
  std::size_t begun = 0;
  friend bool operator==(const Passed&, const Passed&) = default;
};

Passed pass(std::span<const std::uint8_t> bytes, std::size_t piece) {
  port::PacketGuard guard(packet_bytes_max);
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(piece, bytes.size()))) {
    if (guard.pass(bytes.first(std::min(piece, bytes.size())))) continue;
    require(guard.why()[0] != 0, "no reason");
    return {.is_sound = false};
  }
  return {.is_sound = true, .begun = guard.packets_begun()};
}

}  // namespace

void run(std::span<const std::uint8_t> bytes) {
  Input input(bytes);
  const std::size_t piece = 1u + input.byte();
  const std::span<const std::uint8_t> stream = input.rest();
  require(pass(stream, piece) == pass(stream, stream.size() + 1), "it matters how a stream is cut");
}

}  // namespace etcm::fuzz
