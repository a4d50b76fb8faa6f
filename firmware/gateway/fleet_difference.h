// Why another gateway has another mesh, in words and with the cure, from what the two say of
// themselves.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "etcm/port/clock.h"
#include "firmware/fleet/fleet_listener.h"

namespace etcm::firmware {

// What this gateway says of itself.
struct OwnStand {
  bool is_shared = true;  // its mesh is to have the nodes of all
  std::uint32_t known_count = 0;
  std::uint64_t known_hash = 0;
  std::uint64_t mesh_hash = 0;
  std::uint32_t mesh_nodes = 0;
  SiteVersion site{};
  std::string_view site_trouble{};  // why it does not go by another one, or empty
  bool is_site_refused = false;     // by the broker: the others cannot have it
  std::string_view version{};
  std::string_view lack{};  // of room, with the cure; or empty
};

// Of which of it the two say something else, from what tells most to what tells least.
struct FleetDifference {
  enum class Kind : std::uint8_t { node_counts, sites, mesh_nodes, places, meshes };
  Kind kind = Kind::meshes;
  std::array<std::uint64_t, 2> own{};
  std::array<std::uint64_t, 2> theirs{};
  friend bool operator==(const FleetDifference&, const FleetDifference&) = default;
};

// REQUIRES of both: the other one is online, and the two do not agree.
FleetDifference difference_between(const PeerReport& peer, const OwnStand& own);
// Further: all of its set is here.
std::string difference_of(const PeerReport& peer, const OwnStand& own);

// Tells a difference that stays from one that is there because something has just changed, and
// the news of it are on their way.
class LastingDifferences {
 public:
  explicit LastingDifferences(port::Duration patience) : patience_(patience) {}

  // The two do not agree now. True: they have said the same of it for so long.
  bool last(const PeerReport& peer, const OwnStand& own, port::Instant now);
  // They agree, or nobody can tell.
  void end(const std::string& gateway) { since_.erase(gateway); }
  void end_all() { since_.clear(); }

 private:
  struct Since {
    FleetDifference difference;
    port::Instant at;
  };
  port::Duration patience_;
  std::map<std::string, Since> since_{};  // by gateway
};

}  // namespace etcm::firmware
