// What a member is made of. Its methods are in the source that is named above them.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/fleet/fleet_clashes.h"
#include "firmware/fleet/fleet_member.h"
#include "firmware/fleet/header_codec.h"
#include "firmware/fleet/merged_set.h"
#include "firmware/fleet/outgoing.h"
#include "firmware/fleet/remote_set.h"

namespace etcm::firmware {

// Another member.
struct Peer {
  std::string name;
  PeerState state = PeerState::unknown;
  port::Instant since{};     // in this state
  port::Instant heard_at{};  // its last header
  std::optional<FleetHeader> header{};
  RemoteSet set{};
  std::vector<ToldClash> clashes{};
  bool is_believed = false;  // its set was complete once, or it was known before
  bool is_owner = false;     // of nodes that are known
  bool is_hidden = false;    // something hid a part of its set, and was forgotten since
  bool is_doubted = false;   // others may not have its set, though this member has it
  port::Instant set_changed_at{};
  port::Instant incomplete_since = port::never;  // or since it was told what is here of it
  port::Duration have_pause{};                   // until it is told so again
  Serial have_next{0};
  bool has_sound_header = true;
  bool is_proven = false;  // a header came in this run that the broker had not kept
  bool is_back = false;    // in this connection
  std::string quarantine{};
  port::Instant rejected_at{};  // when it said last what is not sound
  bool told_complete = false;
  bool has_news = false;  // the gateway is to be told
};

// A node as this gateway hears it, whoever owns it.
struct LocalNode {
  FleetNode node;
  bool is_heard = false;
  bool has_arrived = false;  // it is heard anew, and nobody knows yet
  bool was_heard = false;    // in this run
  port::Instant heard_at{};  // or known since
};

// What this member has to publish about a node: a record of its own, a tombstone, or in trust the
// record of a member whose own message the broker has lost.
struct HeldRecord {
  std::shared_ptr<const FleetRecord> record;
  bool is_sent = false;  // this version
  port::Instant held_since{};
};

// Another program that goes by the same name, dead or alive.
struct OtherRun {
  FleetRun run;
  std::uint32_t beat = 0;
  port::Instant last_seen_at{};  // online; the origin: its will came after that
  port::Instant alive_until{};   // it was seen to be alive
};

// Since when others have had another hash than this member, whose own is the same since then.
struct Differing {
  port::Instant since = port::never;
  std::uint64_t hash = 0;

  // For so long by now.
  bool last(bool is_same, std::uint64_t mine, port::Duration time, port::Instant now) {
    if (is_same || hash != mine) {
      hash = mine;
      since = now;
    }
    return now - since >= time;
  }
};

struct FleetMember::State {
  using RecordPointer = std::shared_ptr<const FleetRecord>;

  State(const FleetSettings& the_settings, port::MessageBroker& the_broker,
        FleetListener& the_listener, port::Log& the_log)
      : settings(the_settings),
        broker(the_broker),
        listener(the_listener),
        log(the_log),
        merged(the_settings.nodes_max) {}

  // --- fleet_inbox.cpp: what comes in.
  void take(const port::BrokerMessage& message, port::Instant now);
  void take_peer(const FleetTopic& topic, const port::BrokerMessage& message, port::Instant now);
  bool take_peer_node(Peer& peer, Serial serial, std::string_view payload, std::string& wrong,
                      port::Instant now);
  bool take_peer_set(Peer& peer, std::string_view payload, std::string& wrong);
  bool take_peer_header(Peer& peer, const port::BrokerMessage& message, std::string& wrong,
                        port::Instant now);
  port::Instant heard_before(port::Instant now) const;
  void check_complete(Peer& peer, port::Instant now);
  void take_own(const FleetTopic& topic, std::string_view payload, port::Instant now);
  void note_on_broker(OutKey key, std::uint64_t hash);
  void take_own_header(std::string_view payload, port::Instant now);
  void take_epoch(const FleetRun& run);
  void note_version(const FleetRecord& there, port::Instant now);
  void reject(std::string_view name, const std::string& tail, const std::string& wrong,
              port::Instant now);
  void release(Peer& peer);
  // Nothing sound is known of it.
  bool is_stranger(const Peer& peer) const;
  Peer* peer_of(std::string_view name, port::Instant now);
  void offer(RecordPointer record, std::string_view from, port::Instant now);
  void note_lack_of_room(Serial serial, std::string_view from, port::Instant now);
  bool know_owner(const std::string& name, port::Instant now);

  // --- fleet_owning.cpp: who speaks for a node.
  bool owns(const FleetRecord& record) const;
  bool is_strange(const FleetRecord& record) const;
  bool is_available(const std::string& name, port::Instant now) const;
  bool may_claim(const LocalNode& here, const MergedNode& known, port::Instant now) const;
  void reconcile(Serial serial, port::Instant now);
  void claim(LocalNode& here, const MergedNode* known, port::Instant now);
  void update_own(LocalNode& here, const MergedNode& known, port::Instant now);
  void yield(Serial serial, port::Instant now);
  void adopt_own(port::Instant now);
  void forget(Serial serial, port::Instant now);
  void remove(Serial serial, LeftReason reason, port::Instant now);
  void remove_unheard(port::Instant now);
  void hold(RecordPointer record, port::Instant due, port::Instant now);
  void raise_version(FleetRecord& record, const FleetRecord& above) const;

  // --- fleet_clashes.cpp: two nodes with one serial.
  const MergedNode* heard_elsewhere(Serial serial) const;
  void watch_place(const LocalNode& here, port::Instant now);
  void tell_clashes(port::Instant now);
  void take_clashes(Peer& peer, std::vector<ToldClash> told);
  std::optional<Position> place_at(const ToldClash& told) const;
  void note_clash(FleetClash clash, port::Instant now);
  void find_clashes(port::Instant now);

  // --- fleet_steward.cpp: that the broker has all that anybody knows, and nothing for ever.
  void keep_covered(port::Instant now);
  bool is_disowned(const FleetRecord& record) const;
  bool is_covered(Serial serial, const FleetRecord& record) const;
  bool is_held_by_better(Serial serial, const FleetRecord& record) const;
  bool has_older(Serial serial, const FleetRecord& record) const;
  bool is_anywhere(Serial serial) const;
  std::uint32_t rank_for(const std::string& key) const;
  void withdraw(Serial serial, port::Instant now);
  void offer_what_is_said(Serial serial, port::Instant now);
  void offer_what_is_held_for(const std::string& owner, port::Instant now);
  void drop_needless(port::Instant now);
  void forget_tombstones(port::Instant now);
  void bury_nodes_of_the_gone(port::Instant now);
  void doubt_the_absent(port::Instant now);

  // --- fleet_mending.cpp: what the broker of another member has otherwise.
  void mend_incomplete(port::Instant now);
  void mend_site(port::Instant now);
  bool say_what_is_here(Peer& peer);
  void take_have(std::string_view payload, port::Instant now);
  void mend(Serial serial, const FleetHave::Item* item, port::Instant now);

  // --- fleet_site.cpp: which document of the site counts.
  void take_site(std::string_view payload, port::Instant now);
  void consider_site(SiteDocument document, port::Instant now);
  void hold_site(SiteDocument document, bool is_fleets, port::Instant now);
  void drop_site(port::Instant now);
  void note_site_taken();
  void note_site_delivered(std::uint64_t hash);
  void hold_own_site(port::Instant now);
  void settle_site(port::Instant now);
  void tell_site(port::Instant now);
  void mark_site(port::Instant now);
  bool is_site_of_here() const;
  void note_site_refused();
  void forget_unsound_site(port::Instant now);

  // --- fleet_sending.cpp: what goes out, and whether the broker still has it.
  port::Instant settles_at() const;
  void settle(port::Instant now);
  void compare_with_broker(port::Instant now);
  bool wants(OutKey key) const;
  void send(port::Instant now);
  void send_conflict(port::Instant now);
  OutMessage encode(OutKey key, port::Instant now);
  OutMessage encode_node(Serial serial, port::Instant now);
  void mark_header();
  void mark_periodic(port::Instant now);
  void set_will();

  // --- fleet_saving.cpp: what outlives a restart.
  std::vector<std::byte> save() const;
  std::string restore(std::span<const std::byte> saved, port::Instant now);

  // --- fleet_telling.cpp: what the gateway hears of it all.
  void tell_node(Serial serial, MergedNode& node, port::Instant now);
  bool is_stale_now(const FleetRecord& record) const;
  void watch_peers(port::Instant now);
  void set_peer_state(Peer& peer, PeerState state, port::Instant now);
  void tell_peers(port::Instant now);
  void tick(port::Instant now);
  bool is_listed(const Peer& peer, std::uint32_t node_count) const;
  void forget_dismissed();
  PeerReport report(const Peer& peer) const;  // but for the count of nodes
  std::vector<PeerReport> reports() const;
  FleetAgreement agreement() const;

  // --- fleet_twins.cpp: other programs of this name.
  void note_arrival(const FleetRun& run);
  void take_other_header(const FleetHeader& theirs, port::Instant now);
  void take_conflict(const FleetRun& run, port::Instant now);
  void note_alive(OtherRun& other, port::Instant now);
  void note_end(const FleetRun& run, port::Instant now);
  OtherRun& other_run(const FleetRun& run, bool& is_new);
  std::uint64_t other_instance(port::Instant now) const;
  bool outranks(const FleetRun& other) const;
  void judge_twins(port::Instant now);

  FleetSettings settings;
  port::MessageBroker& broker;
  FleetListener& listener;
  port::Log& log;

  bool is_connected = false;
  bool is_settled = false;
  bool is_blocked = false;       // the broker takes no more for now
  port::Instant since{};         // connected, or apart
  port::Instant kept_came_at{};  // the last message that the broker had kept
  port::Instant next_tick{};
  port::Instant stepped_at{};
  port::Instant compare_at = port::never;  // what is on the broker with what should be

  std::map<std::string, Peer, std::less<>> peers{};
  std::set<std::string, std::less<>> dismissed{};  // of the peers, or of an earlier run's
  MergedSet merged;
  std::map<Serial, LocalNode> local{};
  std::map<Serial, HeldRecord> held{};
  Outgoing out{};
  // What is on the broker below this member's own topics, as far as it is known.
  std::map<OutKey, std::uint64_t> on_broker{};
  struct Neighbours {
    std::vector<Serial> serials;
    std::uint32_t generation = 0;
  };
  std::map<Serial, Neighbours> neighbours{};
  std::string alarms{R"({"alarms":[]})"};

  FleetHeader header{};
  std::uint32_t told_merged_count = 0;  // in the header that was sent last
  std::uint64_t told_merged_hash = 0;
  std::uint64_t told_records = 0;
  std::uint64_t seen_records = 0;  // at the last tick
  port::Instant same_since{};      // they are those
  struct Site {
    std::optional<SiteDocument>
        held{};                         // that counts; number 0: it is of here, and nobody knows it
    SiteVersion version{};              // of that
    bool is_fleets = false;             // the broker has had it; else it is of `own` alone
    std::optional<SiteDocument> own{};  // as this gateway's file has it
    std::optional<SiteDocument> refused{};      // the newest that the gateway does not take
    std::optional<SiteVersion> denied{};        // that the broker does not let this gateway tell
    std::optional<SiteDocument> passed_over{};  // the fleet's, while the one held is not
    std::uint32_t dropped_number = 0;           // the greatest that was taken out
    SiteVersion on_broker{};
    port::Instant behind_since = port::never;  // other members are, or since they were told again
    port::Duration mend_pause{};
    bool is_settled = false;  // what the broker had before this run is known
    std::string trouble{};    // with what came last, for a person; or empty
    std::string unsound{};    // what is on the broker, where that is none; or empty
    port::Instant unsound_at{};
  };
  Site site{};

  std::map<Serial, HeardApart> apart{};
  std::vector<ToldClash> told_clashes{};  // by serial
  struct Clash {
    FleetClash clash;
    port::Instant seen_at{};  // last
  };
  std::map<std::pair<Serial, std::string>, Clash> clashes{};
  bool has_clash_news = false;

  std::array<OtherRun, 4> other_runs{};
  bool has_arrived = false;  // it has begun to speak
  bool asks_for_other = false;
  port::Instant next_conflict{};
  bool has_conflict = false;
  bool is_read_only = false;

  Differing differing_places{};
  Differing differing_records{};
  std::uint64_t rejected_count = 0;
  bool has_told_all = false;  // in this session, once
  std::uint64_t other_refused_count = 0;
  bool has_said_full = false;
  bool is_refused = false;           // the header that was sent last
  bool is_header_taken = false;      // one was, in this connection
  bool lacks_room = false;           // for nodes
  port::Instant room_lacks_until{};  // at least
  bool has_news_to_save = true;
};

}  // namespace etcm::firmware
