// The settings as an operator writes them: a file, in the words of the guide.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "device.h"
#include "etcm/port/clock.h"

namespace etcm::simulation {

using port::Duration;

// The first unit that nodes without one may be given.
inline constexpr std::uint8_t first_assigned = 101;

enum class LinkKind : std::uint8_t { serial, serial_over_tcp, converter };

struct BusText {
  LinkKind kind = LinkKind::serial;
  std::uint32_t baud = 19200;
  std::uint32_t outstanding = 1;
  std::uint8_t units = 0;        // from 1 to this one
  std::uint8_t assigned = 0;     // so many behind first_assigned are given to nodes without one
  bool is_shared = false;        // with other programs
  Make first_make = Make::ours;  // of its first unit

  // All that it asks.
  std::uint32_t unit_count() const { return units + (assigned > 0 ? assigned + 1u : 0u); }
};

// What the devices of other makes count in, and where the mesh begins in it.
struct PlaneText {
  std::int32_t units = 1;  // of the mesh, in what the plane counts in: 1, 2 or 4
  std::int32_t origin = 0;

  friend bool operator==(const PlaneText&, const PlaneText&) = default;
};

struct SiteFile {
  Duration interval{};
  Duration absent_interval{};
  Duration stale_after{};
  Duration leave_after{};
  std::uint32_t vertices_max = 0;
  std::uint32_t work_max = 0;
  bool has_broker = false;      // and there another gateway
  bool is_site_shared = false;  // with that one
  bool has_sparkplug = false;   // and there a host
  bool has_write_back = false;  // of its neighbours, to each node
  PlaneText plane;
  std::vector<BusText> buses;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> features;  // serials

  std::string text() const;
  std::uint8_t units(std::size_t bus) const {
    return bus < buses.size() ? buses[bus].units : std::uint8_t{0};
  }
  bool asks(std::size_t bus, std::uint8_t unit) const;
};

inline constexpr const char* sparkplug_group = "plant";
// For an answer, on every bus.
inline constexpr Duration unit_timeout = std::chrono::milliseconds(200);

// The same with a mistake in it, one of many kinds.
inline constexpr std::size_t mistake_count = 9;
std::string with_mistake(const SiteFile& file, std::size_t which);

}  // namespace etcm::simulation
