// What the gateway hears of the others, and who is there.
#include <algorithm>
#include <utility>

#include "firmware/fleet/fleet_state.h"

namespace etcm::firmware {

const char* to_string(PeerState state) {
  switch (state) {
    case PeerState::unknown:
      return "unknown";
    case PeerState::online:
      return "online";
    case PeerState::offline:
      return "offline";
    case PeerState::silent:
      return "silent";
  }
  return "unknown";
}

bool FleetMember::State::is_stale_now(const FleetRecord& record) const {
  if (owns(record)) {
    const auto here = local.find(record.node.serial);
    return here == local.end() || !here->second.is_heard;
  }
  const auto owner = peers.find(record.owner);
  return !record.is_heard || owner == peers.end() || owner->second.state != PeerState::online;
}

void FleetMember::State::tell_node(Serial serial, MergedNode& node, port::Instant now) {
  using Told = MergedNode::Told;
  const FleetRecord& record = *node.record;
  const Told before = node.told;
  node.told = record.has_left() ? Told::nothing : owns(record) ? Told::own : Told::foreign;
  if (node.told == Told::foreign) {
    const bool is_stale = is_stale_now(record);
    const bool is_same = before == Told::foreign && node.told_stale == is_stale &&
                         compare(*node.told_record, record) == 0;
    node.told_stale = is_stale;
    node.told_record = node.record;
    if (!is_same) listener.on_node(record, is_stale, now);
    return;
  }
  node.told_record = nullptr;
  if (node.told == Told::own) {
    if (before == Told::foreign) listener.on_node_gone(serial, LeftReason::none, now);
    return;
  }
  const bool is_news = before == Told::foreign || (before == Told::own && !owns(record));
  if (is_news) listener.on_node_gone(serial, record.left, now);
}

void FleetMember::State::set_peer_state(Peer& peer, PeerState state, port::Instant now) {
  if (peer.state == state) return;
  peer.state = state;
  peer.since = now;
  peer.has_news = true;
  if (state == PeerState::online && dismissed.erase(peer.name) > 0) has_news_to_save = true;
  std::vector<Serial> nodes;
  for (const auto& [serial, node] : merged.nodes()) {
    if (node.record->owner == peer.name) nodes.push_back(serial);
  }
  for (const Serial serial : nodes) reconcile(serial, now);
  if (state != PeerState::online) offer_what_is_held_for(peer.name, now);
}

void FleetMember::State::watch_peers(port::Instant now) {
  for (auto& [name, peer] : peers) {
    const bool is_silent =
        peer.state == PeerState::online && now - peer.heard_at >= settings.silent_after;
    if (is_silent) set_peer_state(peer, PeerState::silent, now);
    // Whoever can write to the broker can invent a name, and nobody would ever take it back.
    const bool is_over = !peer.quarantine.empty() && is_stranger(peer) &&
                         now - peer.rejected_at >= settings.leave_after;
    if (is_over) release(peer);
  }
}

PeerReport FleetMember::State::report(const Peer& peer) const {
  PeerReport report{.name = peer.name,
                    .state = peer.state,
                    .since = peer.since,
                    .quarantine = peer.quarantine,
                    .is_complete = peer.set.is_complete(),
                    .is_proven = peer.is_proven,
                    .is_back = peer.is_back};
  if (peer.header) {
    report.merged_count = peer.header->merged_count;
    report.merged_hash = peer.header->merged_hash;
    report.generation = peer.header->generation;
    report.mesh_hash = peer.header->mesh_hash;
    report.mesh_nodes = peer.header->mesh_nodes;
    report.site = peer.header->site;
    report.version = peer.header->version;
    report.has_name_conflict = peer.header->has_conflict && peer.state == PeerState::online;
  }
  return report;
}

std::vector<PeerReport> FleetMember::State::reports() const {
  std::map<std::string_view, std::uint32_t> counts;
  for (const auto& [serial, node] : merged.nodes()) {
    if (!node.record->has_left()) ++counts[node.record->owner];
  }
  std::vector<PeerReport> reports;
  reports.reserve(peers.size());
  for (const auto& [name, peer] : peers) {
    if (!is_listed(peer, counts[name])) continue;
    reports.push_back(report(peer));
    reports.back().node_count = counts[name];
  }
  return reports;
}

bool FleetMember::State::is_listed(const Peer& peer, std::uint32_t node_count) const {
  if (peer.state == PeerState::online || node_count > 0 || !peer.quarantine.empty()) return true;
  return peer.header && !dismissed.contains(peer.name);
}

bool FleetMember::dismiss(std::string_view gateway) {
  State& state = *state_;
  const auto peer = state.peers.find(gateway);
  if (peer == state.peers.end() || peer->second.state == PeerState::online) return false;
  const MergedSet::Nodes& nodes = state.merged.nodes();
  const bool has_nodes = std::any_of(nodes.begin(), nodes.end(), [&](const auto& entry) {
    return !entry.second.record->has_left() && entry.second.record->owner == gateway;
  });
  if (has_nodes || state.dismissed.size() >= state.settings.members_max) return false;
  if (state.dismissed.emplace(gateway).second) state.has_news_to_save = true;
  return true;
}

// Somebody has emptied its topics: there is nobody to be left out.
void FleetMember::State::forget_dismissed() {
  const auto forgotten = std::erase_if(dismissed, [&](const std::string& name) {
    const auto peer = peers.find(name);
    return peer == peers.end() || !peer->second.header;
  });
  if (forgotten > 0) has_news_to_save = true;
}

// Nodes are not counted for that: with many, somebody is always about to be complete.
void FleetMember::State::tell_peers(port::Instant now) {
  for (auto& [name, peer] : peers) {
    if (std::exchange(peer.has_news, false)) listener.on_peer(report(peer), now);
  }
}

namespace {

// An empty mesh has the hash 0 too: without the count it is that of who does not tell.
bool tells_mesh(const FleetHeader& header) {
  return header.mesh_hash != 0 || header.mesh_nodes.has_value();
}

}  // namespace

FleetAgreement FleetMember::State::agreement() const {
  FleetAgreement agreement;
  for (const auto& [name, peer] : peers) {
    if (peer.state != PeerState::online || !peer.header) continue;
    ++agreement.online;
    const FleetHeader& theirs = *peer.header;
    const bool is_comparable =
        tells_mesh(theirs) && tells_mesh(header) && !theirs.is_alone && !header.is_alone;
    const bool has_same_mesh = !is_comparable || theirs.mesh_hash == header.mesh_hash;
    if (theirs.merged_count == merged.count() && theirs.merged_hash == merged.hash() &&
        has_same_mesh && theirs.site == site.version) {
      ++agreement.agreeing;
    } else {
      agreement.differing.push_back(name);
    }
  }
  return agreement;
}

// What time alone brings.
void FleetMember::State::tick(port::Instant now) {
  is_blocked = false;
  watch_peers(now);
  judge_twins(now);
  remove_unheard(now);
  find_clashes(now);
  forget_unsound_site(now);
  if (merged.count() < settings.nodes_max && now >= room_lacks_until) lacks_room = false;
  if (!is_connected || !is_settled || is_read_only) return;
  mark_periodic(now);
  if (now >= compare_at) compare_with_broker(now);
  mend_incomplete(now);
  mend_site(now);
  bury_nodes_of_the_gone(now);
  doubt_the_absent(now);
  keep_covered(now);
  drop_needless(now);
  forget_tombstones(now);
}

}  // namespace etcm::firmware
