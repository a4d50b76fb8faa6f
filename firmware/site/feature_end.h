// What a feature ends at.
#pragma once

#include <cstdint>
#include <string>

#include "etcm/types.h"
#include "firmware/protocol/serial.h"

namespace etcm::firmware {

// Where a segment of a feature ends: at a node, known by its serial, or at an anchor, a fixed point
// of the site known by its place.
struct FeatureEnd {
  constexpr FeatureEnd() = default;
  constexpr FeatureEnd(Serial node) : serial(node) {}  // NOLINT: a serial is an end
  static constexpr FeatureEnd anchor(Position position) {
    FeatureEnd end;
    end.is_anchor = true;
    end.position = position;
    return end;
  }

  // Different for different ends; nodes come before anchors.
  constexpr std::uint64_t key() const {
    if (!is_anchor) return serial.value;
    const auto part = [](std::int32_t value) { return static_cast<std::uint32_t>(value); };
    return std::uint64_t{1} << 63 | std::uint64_t{part(position.x) & 0x7fffffffu} << 32 |
           part(position.y);
  }
  friend constexpr bool operator==(const FeatureEnd& a, const FeatureEnd& b) {
    return a.key() == b.key();
  }

  bool is_anchor = false;
  Serial serial;      // of a node
  Position position;  // of an anchor
};

// "1001" or "(100, 200)".
std::string to_string(const FeatureEnd& end);

}  // namespace etcm::firmware
