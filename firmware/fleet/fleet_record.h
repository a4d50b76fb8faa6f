// What the members of a fleet tell each other of one node, and which of two such records counts.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/types.h"
#include "firmware/protocol/serial.h"

namespace etcm::firmware {

// Of a site or a gateway: 1 to 32 letters, digits, '-', '_' and '.'. They stand in topics and in
// the log as they are.
bool is_fleet_name(std::string_view name);
inline constexpr std::size_t fleet_name_max = 32;

// Incarnations, sequences and epochs are at most this.
inline constexpr std::uint32_t fleet_number_max = 0x7fffffff;

inline constexpr std::size_t fleet_readings_max = 16;
inline constexpr std::size_t fleet_text_max = 32;  // of each text of a node, in bytes
inline constexpr std::size_t node_name_max = 64;   // but of its name

struct FleetReading {
  std::string name;
  std::string unit;
  std::optional<std::int64_t> nano;  // in 10^-9 of the unit; none: it was not valid
  friend bool operator==(const FleetReading&, const FleetReading&) = default;
};

struct FleetNode {
  Serial serial;
  std::string name{};                // what people call it; empty: nothing
  std::optional<Position> position;  // in the plane that all members share; none: not known
  // In degrees, as JSON has numbers; empty where the site has none. For those who read along:
  // members go by `position`.
  std::string longitude{};
  std::string latitude{};
  std::uint16_t status = 0;  // bits of node_status
  std::vector<FleetReading> readings{};
  // Its last answer: the time of day (ISO 8601, UTC), empty where that is not known, and how long
  // ago. For those who read along: nothing is decided by them.
  std::string heard_at{};
  std::uint32_t age_s = 0;
};

// Whether texts and lists keep to the bounds above and all is what it should be.
bool is_sound(const FleetNode& node);
// The same but for when it was heard.
bool has_same_content(const FleetNode& a, const FleetNode& b);

enum class LeftReason : std::uint8_t {
  none,     // it has not left
  asked,    // the node asked for it
  silent,   // its gateway has not heard it for long
  removed,  // by an operator
  gateway_gone,
};
const char* to_string(LeftReason reason);

// One state of a node. Its owner is the gateway that made it: for a node that is there the one that
// speaks for it, for one that has left the one that says so.
struct FleetRecord {
  FleetNode node;
  std::string owner;
  std::uint32_t incarnation = 0;
  std::uint32_t sequence = 0;
  bool is_heard = false;  // the node answers its owner
  LeftReason left = LeftReason::none;

  bool has_left() const { return left != LeftReason::none; }
};

// The greater one counts: by incarnation, sequence, owner. A total order of what decides: records
// that are equal in it differ at most in what is for those who read along.
std::strong_ordering compare(const FleetRecord& a, const FleetRecord& b);

}  // namespace etcm::firmware
