// The gateway as a member of a fleet: its own nodes go to the others, and with share = "site"
// theirs become nodes here.
//
// A node that another gateway hears has a record as any other, with an owner. It is in the mesh
// where that gateway says, stale while it says so, and leaves when it does. Nothing that comes from
// the fleet is ever written to a device: where neighbours are, nodes of others are not taken
// (cross_checks.cpp), nor places of its own nodes that only the broker remembers.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/message_broker.h"
#include "etcm/port/wall_clock.h"
#include "firmware/config/settings.h"
#include "firmware/fleet/fleet_member.h"
#include "firmware/gateway/fleet_difference.h"
#include "firmware/gateway/fleet_report.h"
#include "firmware/gateway/fleet_site.h"
#include "firmware/mesh/kept_mesh.h"
#include "firmware/mesh/node_placement.h"
#include "firmware/publish/neighbour_list.h"
#include "firmware/publish/quarantine.h"
#include "firmware/publish/reading_snapshot.h"
#include "firmware/publish/snapshot.h"
#include "firmware/records/foreign_readings.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

struct FleetPorts {
  port::MessageBroker& broker;
  const port::WallClock* wall_clock = nullptr;  // null: nobody is told the time of day
  port::Log& log;
  port::ProjectionSource* projections = nullptr;  // null: there are none
  std::uint64_t run = 0;  // another for each run of a program, on any machine
  std::string_view version{};
};

class FleetLink final : private FleetListener {
 public:
  // All but the settings must outlive this. REQUIRES: settings->mqtt.
  FleetLink(std::shared_ptr<const Settings> settings, const FleetPorts& ports, KeptMesh& kept,
            NodeTable& nodes, ForeignReadings& readings, NodePlacement& placement,
            port::Instant now);

  // Settings with the site that save() gave in an earlier run; null: their own is as good.
  std::shared_ptr<const Settings> restore_site(std::span<const std::byte> saved) {
    return site_.restored(saved);
  }
  // Goes on with what save() gave in an earlier run; after the node table is restored. An empty
  // one is none. `is_moved`: the site had another plane then.
  void restore(std::span<const std::byte> saved, bool is_moved, port::Instant now);
  std::vector<std::byte> save() const { return member_.save(); }
  bool take_news_to_save() { return member_.take_news_to_save(); }

  // The node has answered here, and its record says so unless it is another gateway's. False: it
  // stays that one's. `readings` are those published last.
  bool hear(NodeRecord& node, const ReadingSnapshot& readings, port::Instant now);
  // The same of a node that another gateway has: it is ours where that one does not hear it.
  bool claim(NodeRecord& node, const NodeReading& reading, port::Instant now);

  // Tells the fleet what has become of the nodes that do not answer. O(n).
  void sweep(port::Instant now);
  // Takes in what has come and sends what is due. `generation` is what the log calls the next one.
  void step(port::Instant now, std::uint32_t generation);
  port::Instant next_deadline() const { return member_.next_deadline(); }

  // There is another generation of the mesh. O(n).
  void take(const Snapshot& snapshot, std::span<const QuarantineEntry> quarantine);

  // Of this gateway, all that are on, as schema/alarms.json has them.
  void tell_alarms(std::string message) { member_.set_alarms(std::move(message)); }

  // As the operator has them.
  void update_settings(std::shared_ptr<const Settings> settings, port::Instant now);
  // The settings with the site that holds, where these are others than before; else null.
  std::shared_ptr<const Settings> take_settings();

  // The gateway is in the list, and not there.
  bool is_gone(std::string_view gateway) const;
  // In so much time at the soonest the nodes of one that is gone leave; none: it is not gone, or
  // has none, or this gateway does not know.
  std::optional<port::Duration> nodes_leave_in(std::string_view gateway, port::Instant now) const;
  // It is left out of the list until it is there again. False: it is there, or hears nodes by what
  // is known.
  bool dismiss_gone(std::string_view gateway, port::Instant now);
  // The same of all that are gone. Returns how many.
  std::uint32_t dismiss_gone(port::Instant now);

  // The names of other gateways, by MemberIndex.
  std::span<const std::string> gateways() const { return gateways_; }
  // Serials that this gateway and another one hear in two places.
  std::vector<FleetClash> clashes() const { return member_.clashes(); }
  // Whether there are others than when this was asked last.
  bool take_clash_news() { return member_.take_clash_news(); }
  // What had this serial here has another one now.
  void end_clash(Serial serial, port::Instant now) { member_.end_clash(serial, now); }
  const FleetReport& report() const { return report_; }
  // What other gateways call their nodes. O(nodes), and takes its memory.
  std::vector<ToldName> told_names() const;
  // Whether there are others than the table of nodes has, since this was asked last.
  bool take_name_news() { return std::exchange(has_name_news_, false); }

 private:
  void on_node(const FleetRecord& record, bool is_stale, port::Instant now) override;
  void on_node_gone(Serial serial, LeftReason reason, port::Instant now) override;
  void on_peer(const PeerReport& peer, port::Instant now) override;
  void on_name_conflict(bool is_conflict, bool is_read_only, port::Instant now) override;
  std::string on_site(const SiteDocument& document, port::Instant now) override;

  bool is_of_twin(const FleetRecord& record) const;
  MemberIndex index_of(const std::string& gateway);
  FleetNode told_of(const NodeRecord& node, const ReadingSnapshot& readings,
                    port::Instant now) const;
  void tell_own(const NodeRecord& node, port::Instant now);
  void adopt(const FleetRecord& record, port::Instant now);
  void take_plane(const Settings& settings);
  void take_readings(const FleetRecord& record, port::Instant taken_at, bool is_stale);
  void place(NodeRecord& node, std::optional<Position> position);
  void make_report(port::Instant now);
  bool is_dismissed(const PeerReport& peer, const char* why);
  void dismiss_long_gone(port::Instant now);
  bool misses_nodes_of(const std::string& gateway) const;
  void note_apart(const FleetStatus& status, port::Instant now);
  bool has_left_with_broker(const PeerReport& peer) const;
  bool may_come_back(const PeerReport& peer, const FleetStatus& status, port::Instant now) const;
  MemberState shown_state(const PeerReport& peer, const FleetStatus& status,
                          port::Instant now) const;
  void tell_presence(const PeerReport& peer, const FleetStatus& status, port::Instant now);
  void tell_twin(const PeerReport& peer);
  void tell_difference(const ReportedMember& row);
  void note_refusal(const FleetStatus& status, port::Instant now);
  ReportedMember peer_row(const PeerReport& peer, const OwnStand& own, const FleetStatus& status,
                          bool agrees, port::Instant now);
  OwnStand own_stand(const FleetStatus& status) const;
  ReportedMember own_row(const FleetStatus& status) const;

  KeptMesh& kept_;
  NodeTable& nodes_;
  ForeignReadings& readings_;
  NodePlacement& placement_;
  port::MessageBroker& broker_;
  const port::WallClock* wall_clock_;
  port::Log& log_;
  std::map<std::string, bool, std::less<>> here_{};  // other gateways, as was told last
  std::set<std::string, std::less<>> doubled_{};     // of these two go by one name
  std::set<std::string, std::less<>> differing_{};   // of these another mesh was told last
  bool has_name_news_ = false;
  const bool is_shared_;
  const bool writes_back_;
  const std::string version_;
  SitePlane plane_;
  bool is_moved_ = false;  // nobody knows in which plane an earlier run has told its places
  port::Duration stale_after_;
  port::Duration leave_after_;
  NeighbourList neighbours_;
  std::vector<std::string> gateways_;
  FleetReport report_;
  port::Instant report_due_{};
  std::optional<port::Instant> connected_at_{};  // of the connection there is
  std::uint32_t short_connections_ = 0;          // in a row
  // Since when there was no connection, before this one and those that ended before all were back.
  std::optional<port::Instant> away_since_{};
  std::uint32_t generation_ = 0;      // the next one
  std::uint32_t own_generation_ = 0;  // published last
  std::uint64_t mesh_hash_ = 0;
  std::uint32_t mesh_nodes_ = 0;
  std::string mesh_lack_;  // why something is not in the mesh for want of room, or empty
  LastingDifferences differences_;
  bool is_full_ = false;  // a node of another gateway found no room
  FleetSite site_;
  FleetMember member_;
};

}  // namespace etcm::firmware
