// What a member of a fleet tells its gateway.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "etcm/port/clock.h"
#include "firmware/fleet/fleet_record.h"
#include "firmware/fleet/site_document.h"

namespace etcm::firmware {

enum class PeerState : std::uint8_t {
  unknown,  // nodes of it are known, and it has not been heard of in this run
  online,
  offline,  // the broker says that its connection ended
  silent,   // it has not been heard of for silent_after
};
const char* to_string(PeerState state);

// Another member, as this one sees it.
struct PeerReport {
  std::string name;
  PeerState state = PeerState::unknown;
  port::Instant since{};  // in this state
  // Empty while all that came from it was sound: "node/000003e9: sequence is no number".
  std::string quarantine{};
  bool is_complete = false;  // all that it says it has published is here
  bool is_proven = false;    // it has spoken in this run: the broker had not just kept it
  bool is_back = false;      // the same, since this gateway is connected
  // It is the owner of so many that are there. Of peers(); on_peer() is told 0.
  std::uint32_t node_count = 0;
  // What it said last of all nodes that it knows, and of its mesh of them.
  std::uint32_t merged_count = 0;
  std::uint64_t merged_hash = 0;
  std::uint32_t generation = 0;
  std::uint64_t mesh_hash = 0;
  std::optional<std::uint32_t> mesh_nodes{};  // none: it has not told
  SiteVersion site{};
  std::string version{};           // of its program; empty: it has not told
  bool has_name_conflict = false;  // another program has its name, and tells nothing
};

class FleetListener {
 public:
  // A node that another member owns is new or has changed. `is_stale`: its owner does not hear it,
  // or is not online. Valid during the call.
  virtual void on_node(const FleetRecord& record, bool is_stale, port::Instant now) = 0;
  // Such a node has left; or, with LeftReason::none, it is this gateway's from now on.
  virtual void on_node_gone(Serial serial, LeftReason reason, port::Instant now) = 0;
  // The state, the quarantine or the completeness of another member has changed.
  virtual void on_peer(const PeerReport& peer, port::Instant now) = 0;
  // Another program uses the name of this gateway. `is_read_only`: it goes on, and this one tells
  // nothing more until the other is gone. Both false: it is over.
  virtual void on_name_conflict(bool is_conflict, bool is_read_only, port::Instant now) = 0;
  // A newer site is on the broker, or was saved. Takes it over and returns an empty text, or says
  // what is wrong with it: then it is not offered again but by FleetMember::retry_site().
  virtual std::string on_site(const SiteDocument& document, port::Instant now) = 0;

 protected:
  ~FleetListener() = default;
};

}  // namespace etcm::firmware
