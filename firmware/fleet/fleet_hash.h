// Numbers that all members of a fleet work out alike.
#pragma once

#include <cstdint>
#include <string_view>

#include "etcm/types.h"
#include "firmware/fleet/fleet_record.h"
#include "firmware/protocol/serial.h"

namespace etcm::firmware {

// FNV-1a (Fowler, Noll, Vo) of 64 bits; `begin` is the hash of what comes before.
inline constexpr std::uint64_t fnv_begin = 0xcbf29ce484222325;
constexpr std::uint64_t fnv_hash(std::string_view bytes, std::uint64_t begin = fnv_begin) {
  std::uint64_t hash = begin;
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * std::uint64_t{0x100000001b3};
  }
  return hash;
}

// Spreads all bits over all (the finalizer of Steele, Lea, Flood 2014).
constexpr std::uint64_t mix_bits(std::uint64_t value) {
  value = (value ^ value >> 30) * std::uint64_t{0xbf58476d1ce4e5b9};
  value = (value ^ value >> 27) * std::uint64_t{0x94d049bb133111eb};
  return value ^ value >> 31;
}

// A set's hash is the sum of those of what is in it, so that the order does not matter.
// Of what decides in a record, in the set of a member: of the text "<serial> <owner> <incarnation>
// <sequence> <reason for which it left, or heard, or silent> <x> <y>", without place where it has
// none.
std::uint64_t record_hash(const FleetRecord& record);
// Of a node that is there, in the set that all are to agree on: what the mesh depends on.
std::uint64_t place_hash(Serial serial, Position position);

// Of several members the one that weighs most for a key does what one of them is to do for it
// (rendezvous hashing, Thaler and Ravishankar 1998): all that see the same members name the same
// one, and the coming and going of others changes it seldom.
std::uint64_t rendezvous_weight(std::string_view key, std::string_view member);

}  // namespace etcm::firmware
