// One serial number that two gateways hear at the same time, in two places: two nodes have it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/types.h"
#include "firmware/protocol/serial.h"

namespace etcm::firmware {

inline constexpr std::size_t clashes_max = 64;  // that are told of at a time

// As a gateway sees it.
struct FleetClash {
  Serial serial;
  std::string gateway;  // the other one
  std::string of{};     // the one, where both are others; empty: this gateway
  Position here;        // where each hears it
  Position there;
  bool is_owner = false;  // the one speaks for the serial: its node is the one in the mesh
  port::Instant since{};
};

// What a member tells of a node that it hears and another one speaks for.
struct ToldClash {
  Serial serial;
  std::string owner;
  Position position;
  friend bool operator==(const ToldClash&, const ToldClash&) = default;
};

// As JSON: schema/clashes.json. What is not sound is false, and what is wrong with it; an empty
// payload is none.
std::string encode_clashes(const std::vector<ToldClash>& clashes);
bool decode_clashes(std::string_view payload, std::vector<ToldClash>& clashes, std::string& wrong);

// The smallest box about some places.
class PlaceBox {
 public:
  void add(Position place);
  void add(const PlaceBox& other);
  std::uint32_t count() const { return count_; }
  // Whether the place is farther from it than `apart_min` and the box is large: beyond all that one
  // node that moves, or that measures its place with an error, can have told meanwhile.
  bool is_far_from(Position place, std::int64_t apart_min) const;

 private:
  std::int64_t x_min_ = 0, x_max_ = 0, y_min_ = 0, y_max_ = 0;
  std::uint32_t count_ = 0;  // of places
};

// Where this gateway hears a node that another one speaks for.
struct HeardApart {
  PlaceBox before{};  // while the record before was the last one
  PlaceBox since{};
  port::Instant record_at{};
  std::uint32_t count = 0;  // of answers in a row that were far from where the owner hears it
  port::Instant apart_since{};
  port::Instant apart_at{};  // last
  Position place{};
  bool is_clash = false;
};

}  // namespace etcm::firmware
