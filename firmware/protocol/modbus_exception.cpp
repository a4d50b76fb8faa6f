#include "firmware/protocol/modbus_exception.h"

namespace etcm::firmware {

namespace {

// Of a unit of `units` without a profile, that does not have our registers.
constexpr const char* no_node =
    "take it out of 'units' if it is no position node, or give it a [[bus.device]] with its "
    "profile";

struct Row {
  std::uint8_t code;
  ExceptionText text;
  bool is_about_registers;  // which a node has
};

constexpr Row rows[] = {
    {1,
     {"it does not know that function",
      "write 'function' of its profile as its manual says, 3 for holding and 4 for input "
      "registers"},
     true},
    {2,
     {"it does not have all of these registers",
      "correct 'register', 'counts_from' and 'function' in its profile, or a smaller 'gap_max' "
      "(etcm-bus probe shows which registers it refuses)"},
     true},
    {3,
     {"it does not give so many registers at once",
      "set 'block_max' of its profile to what its manual allows, or to 16"},
     true},
    {4,
     {"it has failed in reading them",
      "look at the device itself: what it shows, its sensor, its supply; switch it off and on"},
     false},
    {5,
     {"it takes longer, and is to be asked again later",
      "raise 'interval' of [poll], and give it a 'pause' in its profile"},
     false},
    {6,
     {"it is busy with something else",
      "raise 'interval' of [poll], give it a 'pause' in its profile, and see whether another "
      "master "
      "asks it too"},
     false},
    {10,
     {"the converter has no way to it",
      "look at the settings of the converter: which units are on which of its lines"},
     false},
    {11,
     {"nobody is there, says the converter",
      "look at its supply, its cable and its address, and at the speed of the converter's line"},
     false},
};

}  // namespace

ExceptionText explain_exception(std::uint8_t code, bool is_node) {
  for (const Row& row : rows) {
    if (row.code != code) continue;
    return {row.text.meaning, is_node && row.is_about_registers ? no_node : row.text.cure};
  }
  return {"none that the rules for reading know", "see what its manual says of that number"};
}

}  // namespace etcm::firmware
