// One gateway's part in a fleet: it tells the others of its own nodes, learns theirs, and comes to
// know the same set as all of them. README.md has the protocol and why it converges.
//
// It has no input or output of its own: messages go through a port::MessageBroker, time comes with
// each call. Clocks of different members are never compared.
//
// What a gateway does: restore() what was saved; then on each turn hear(), lose() and remove() for
// its own nodes, step(); take into its mesh what for_each_node() visits, its own nodes among them:
// a node that it hears may be another's. When has_news_to_save(), save() goes to the disk with its
// state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/log.h"
#include "etcm/port/message_broker.h"
#include "firmware/fleet/fleet_clashes.h"
#include "firmware/fleet/fleet_listener.h"
#include "firmware/fleet/fleet_record.h"
#include "firmware/fleet/site_document.h"

namespace etcm::firmware {

// Where a broker was away its members come back one after the other: so long after its own
// connection is back a gateway waits for the others.
inline constexpr port::Duration return_time = port::broker_pause_max + std::chrono::seconds(20);

// Of messages whose delivery the member does not follow, such as those that others send through its
// broker.
inline constexpr std::uint32_t other_token = 0;

struct FleetSettings {
  std::string site;     // is_fleet_name()
  std::string gateway;  // the same; no two of a site have one
  // Different for each run of a program on any machine, such as a hash of machine and boot id and
  // process; of two gateways with one name that began together the greater goes on.
  std::uint64_t instance = 0;
  std::string version{};  // of the program, for a person; at most fleet_version_max long
  bool is_alone = false;  // its mesh is to have its own nodes alone
  // A member is heard of at least so often; after a fault all agree within two of them.
  port::Duration period = std::chrono::seconds(30);
  // A member of which nothing is heard for so long is not there. At least three periods.
  port::Duration silent_after = std::chrono::seconds(100);
  // A member that has not been online for so long: its nodes leave.
  port::Duration leave_after = std::chrono::hours(1);
  // Nor does it leave sooner than so long after a broker that was away is back.
  port::Duration return_time{};
  // A node is told of no sooner than this after the last time, and no later than that.
  port::Duration report_min = std::chrono::seconds(10);
  port::Duration report_max = std::chrono::minutes(10);
  // What the broker has kept comes within this after connecting, as a rule.
  port::Duration settle = std::chrono::seconds(3);
  // Places of one serial that are farther apart than that, in units of the mesh, are of two nodes
  // where they stay so for that long: a member that no longer hears a node says so within it.
  std::int64_t apart_min = 10;
  port::Duration apart_after = std::chrono::seconds(10);
  // Of the site; there is no room for more, and it is said so.
  std::uint32_t nodes_max = 10000;
  std::uint32_t members_max = 32;
};

// Who knows the same nodes and has the same mesh of them; of who is to be alone in its mesh, the
// nodes count.
struct FleetAgreement {
  std::uint32_t online = 1;              // members, this one among them
  std::uint32_t agreeing = 1;            // of them, with this one, itself among them
  std::vector<std::string> differing{};  // the others, by name
  bool is_whole() const { return online == agreeing; }
};

// Where this member stands.
struct FleetStatus {
  bool is_connected = false;
  bool is_settled = false;  // what the broker had kept is known
  port::Instant since{};    // it is connected, or apart
  bool has_name_conflict = false;
  bool is_read_only = false;
  std::uint32_t epoch = 0;
  std::uint32_t node_count = 0;     // that are there, of all members
  std::uint32_t own_count = 0;      // of them this one's
  std::uint32_t stale_count = 0;    // of them
  std::uint32_t waiting_count = 0;  // messages that are to be sent, or not delivered yet
  std::uint64_t merged_hash = 0;    // of the serials and places of all nodes that are there
  bool is_refused = false;          // the broker did not take its last header
  bool is_header_taken = false;     // it took one since it is connected
  bool has_told_all = false;        // and since then it had sent all that was due, once
  // Messages that others send through its broker, and that were refused, ever.
  std::uint64_t other_refused_count = 0;
  bool lacks_room = false;           // for nodes of the site, beyond nodes_max
  std::uint64_t rejected_count = 0;  // messages that were not sound, ever
  std::uint64_t sent_count = 0;      // messages, ever
  SiteVersion site{};
  bool is_site_known = false;    // the broker has had it, or there is none
  std::string site_trouble{};    // what is wrong with the newest; empty: nothing
  bool is_site_refused = false;  // by the broker, which does not let this member tell it
};

class FleetMember final : public port::BrokerListener {
 public:
  // All must outlive it. It becomes the listener of the broker, subscribes and sets the last will;
  // the broker should not have connected yet. REQUIRES: sound settings.
  FleetMember(const FleetSettings& settings, port::MessageBroker& broker, FleetListener& listener,
              port::Log& log, port::Instant now);
  ~FleetMember();
  FleetMember(const FleetMember&) = delete;
  FleetMember& operator=(const FleetMember&) = delete;

  // Goes on with what an earlier run has saved: its epoch is followed by the next, and all that it
  // knew is known, as stale. Before anything else, or not at all. Returns what is wrong with it, as
  // in "it is cut off": then nothing is taken. O(n log n).
  std::string restore(std::span<const std::byte> saved, port::Instant now);
  // The fleet's site in what was saved; none where there is none that is sound.
  static std::optional<SiteDocument> saved_site(std::span<const std::byte> saved);
  // What restore() wants. At most save_bytes_max(settings).
  std::vector<std::byte> save() const;
  // Whether something to be saved has changed since this was asked last.
  bool take_news_to_save();

  // A node answered. False, and nothing is done, where the node is not is_sound() or there is no
  // room for it.
  bool hear(const FleetNode& node, port::Instant now);
  // It does not answer any more: it becomes stale, and whoever hears it may take it.
  void lose(Serial serial, port::Instant now);
  // The same of all that others own and this gateway has not heard for so long: the gateway itself
  // has no silence of them to tell of. O(n).
  void lose_others(port::Duration silence, port::Instant now);
  // It has left this gateway. Where another one owns it by now, it has not left the site.
  // REQUIRES: a reason.
  void remove(Serial serial, LeftReason reason, port::Instant now);

  // What this gateway's mesh says of a node that it owns; told to those who read along. None: it
  // is in no mesh.
  void set_neighbours(Serial serial, std::uint32_t generation, std::span<const Serial> neighbours);
  // For those who read along, as schema/alarms.json has them: other members do not. REQUIRES:
  // within broker_message_bytes_max with its topic.
  void set_alarms(std::string message);
  // As in the settings, where the plane is another one now.
  void set_apart_min(std::int64_t units);
  // Of the mesh of the nodes that for_each_node() visits.
  void set_mesh(std::uint32_t generation, std::uint64_t mesh_hash, std::uint32_t node_count);

  // The site as this gateway's own file has it; number and gateway are set here. It becomes that of
  // the fleet where it `is_changed`, just now, by somebody; where there is none; and where the one
  // there is came from this gateway. Else the other's holds. After restore().
  void set_site(SiteDocument own, bool is_changed, port::Instant now);
  // It has none; that of the fleet holds. What was set before is the fleet's where the broker has
  // had it, and else is never told. After restore().
  void clear_site(port::Instant now);
  // One that the listener refused may be good now.
  void retry_site(port::Instant now);
  // That holds; null: none.
  const SiteDocument* site() const;
  SiteVersion site_version() const;

  void step(port::Instant now);
  port::Instant next_deadline() const;

  // All nodes that are there, by serial: visit(record, is_stale).
  template <class Visit>
  void for_each_node(Visit visit) const;
  // The same of one; null: it is not there.
  const FleetRecord* find(Serial serial) const;
  bool is_stale(const FleetRecord& record) const;
  // This gateway speaks for the node.
  bool is_own(const FleetRecord& record) const;

  // By name. One that has been dismissed is left out until it is online again, and so is one of
  // which nothing sound is known.
  std::vector<PeerReport> peers() const;
  // That member will not come back. Done, and kept over restarts, only where it is not online and
  // none of its nodes is there. False: it is not done.
  bool dismiss(std::string_view gateway);
  FleetAgreement agreement() const;
  FleetStatus status() const;

  // Serials that this gateway and another one hear in two places, by serial; at most twice
  // clashes_max.
  std::vector<FleetClash> clashes() const;
  // Whether there are others than when this was asked last.
  bool take_clash_news();
  // The serial is heard here no more, for its node has another one now. Nothing where it is in
  // none.
  void end_clash(Serial serial, port::Instant now);

  // port::BrokerListener
  void on_connected(port::Instant now) override;
  void on_disconnected(std::string_view reason, port::Instant now) override;
  void on_message(const port::BrokerMessage& message, port::Instant now) override;
  void on_delivered(std::uint32_t token, port::Instant now) override;
  void on_refused(std::uint32_t token, std::string_view reason, port::Instant now) override;

 private:
  struct State;
  const FleetRecord* next_node(Serial after) const;
  std::unique_ptr<State> state_;
};

// What save() returns is no more.
std::size_t save_bytes_max(const FleetSettings& settings);

template <class Visit>
void FleetMember::for_each_node(Visit visit) const {
  for (const FleetRecord* at = next_node(Serial::none()); at != nullptr;
       at = next_node(at->node.serial)) {
    visit(*at, is_stale(*at));
  }
}

}  // namespace etcm::firmware
