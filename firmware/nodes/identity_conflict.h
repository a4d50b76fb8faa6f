// What may be wrong with the identity of a node.
#pragma once

#include <cstdint>

namespace etcm::firmware {

enum class IdentityConflict : std::uint8_t {
  none,
  waiting,        // for what comes next: it may be all right
  same_serial,    // this serial answers at another unit too
  same_unit,      // another node answers at this unit too
  swapped_words,  // the serial is a known one, its words swapped
  no_room,        // the node table is full
  other_gateway,  // another gateway hears this serial in another place
};

}  // namespace etcm::firmware
