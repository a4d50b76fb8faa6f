#include "firmware/fleet/fleet_hash.h"

#include <string>

namespace etcm::firmware {

std::uint64_t record_hash(const FleetRecord& record) {
  std::string text = std::to_string(record.node.serial.value) + ' ' + record.owner + ' ' +
                     std::to_string(record.incarnation) + ' ' + std::to_string(record.sequence) +
                     ' ';
  text += record.has_left() ? to_string(record.left) : record.is_heard ? "heard" : "silent";
  if (record.node.position) {
    text += ' ' + std::to_string(record.node.position->x) + ' ' +
            std::to_string(record.node.position->y);
  }
  return fnv_hash(text);
}

std::uint64_t place_hash(Serial serial, Position position) {
  const auto part = [](std::int32_t value) {
    return std::uint64_t{static_cast<std::uint32_t>(value)};
  };
  return mix_bits(mix_bits(serial.value) ^ (part(position.x) << 32 | part(position.y)));
}

std::uint64_t rendezvous_weight(std::string_view key, std::string_view member) {
  return mix_bits(fnv_hash(member, fnv_hash("\n", fnv_hash(key))));
}

}  // namespace etcm::firmware
