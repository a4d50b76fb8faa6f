// That the broker has all that anybody knows, and that nothing is kept for ever.
//
// What a member counts is on the broker in a complete set, or the member puts it there: so members
// that have read all complete sets know the same.
#include <algorithm>
#include <utility>

#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_state.h"

namespace etcm::firmware {

// How many members that are there come before this one where one of them is to do something.
std::uint32_t FleetMember::State::rank_for(const std::string& key) const {
  const std::uint64_t mine = rendezvous_weight(key, settings.gateway);
  std::uint32_t rank = 0;
  for (const auto& [name, peer] : peers) {
    if (peer.state == PeerState::online && rendezvous_weight(key, name) > mine) ++rank;
  }
  return rank;
}

// Its owner is there and does not say it. One that has died may still have it on the broker in
// trust, where nobody else can take it back.
bool FleetMember::State::is_disowned(const FleetRecord& record) const {
  const auto owner = peers.find(record.owner);
  if (record.has_left() || owner == peers.end()) return false;
  const Peer& peer = owner->second;
  if (peer.state != PeerState::online || !peer.set.is_complete()) return false;
  const RecordPointer said = peer.set.find(record.node.serial);
  return said == nullptr || compare(*said, record) < 0;
}

bool FleetMember::State::is_covered(Serial serial, const FleetRecord& record) const {
  const auto mine = held.find(serial);
  if (mine != held.end() && compare(*mine->second.record, record) >= 0) return true;
  if (is_disowned(record)) return false;
  const auto has = [&](const Peer& peer) {
    if (peer.is_doubted || !peer.set.is_complete()) return false;
    const RecordPointer theirs = peer.set.find(serial);
    return theirs != nullptr && compare(*theirs, record) >= 0;
  };
  const auto owner = peers.find(record.owner);
  if (owner != peers.end() && has(owner->second)) return true;
  return std::any_of(peers.begin(), peers.end(),
                     [&](const auto& entry) { return has(entry.second); });
}

// By who made it, or by who comes before this member among those who hold it in trust.
bool FleetMember::State::is_held_by_better(Serial serial, const FleetRecord& record) const {
  const std::uint64_t mine = rendezvous_weight(record.owner, settings.gateway);
  return std::any_of(peers.begin(), peers.end(), [&](const auto& entry) {
    const auto& [name, peer] = entry;
    if (peer.is_doubted || !peer.set.is_complete()) return false;
    const RecordPointer theirs = peer.set.find(serial);
    return theirs != nullptr && compare(*theirs, record) >= 0 &&
           (name == record.owner || rendezvous_weight(record.owner, name) > mine);
  });
}

// Some set has the node as it was before this record.
bool FleetMember::State::has_older(Serial serial, const FleetRecord& record) const {
  return std::any_of(peers.begin(), peers.end(), [&](const auto& entry) {
    const RecordPointer theirs = entry.second.set.find(serial);
    return theirs != nullptr && !theirs->has_left() && compare(*theirs, record) < 0;
  });
}

bool FleetMember::State::is_anywhere(Serial serial) const {
  return held.contains(serial) || std::any_of(peers.begin(), peers.end(), [&](const auto& entry) {
           return entry.second.set.find(serial) != nullptr;
         });
}

// What a member that is there does not say any more is not so. For one that is not, one of the
// others says what it said.
void FleetMember::State::keep_covered(port::Instant now) {
  // With many members the last of them would wait for longer than all have to agree.
  const port::Duration wait_most = std::max(settings.settle, settings.period / 2);
  std::vector<Serial> withdrawn;
  for (auto& [serial, node] : merged.nodes()) {
    const FleetRecord& record = *node.record;
    const bool is_needed = !record.has_left() || has_older(serial, record);
    if (!is_needed || is_covered(serial, record)) {
      node.uncovered_since = port::never;
      continue;
    }
    if (node.uncovered_since == port::never) node.uncovered_since = now;
    const port::Duration passed = now - node.uncovered_since;
    const auto owner = peers.find(record.owner);
    const bool is_there = owner != peers.end() && owner->second.state == PeerState::online;
    if (owns(record) && !record.has_left()) {
      withdrawn.push_back(serial);
    } else if (is_there && !record.has_left()) {
      if (passed >= settings.period / 2 && owner->second.set.is_complete()) {
        withdrawn.push_back(serial);
      }
    } else if (passed >= std::min(settings.settle * (1 + rank_for(record.owner)), wait_most)) {
      hold(node.record, now, now);
      node.uncovered_since = port::never;
    }
  }
  for (const Serial serial : withdrawn) withdraw(serial, now);
}

// What others say of the node holds then: the gateway is told what comes of both, and not that the
// node left and is there again.
void FleetMember::State::withdraw(Serial serial, port::Instant now) {
  const auto at = merged.nodes().find(serial);
  if (at == merged.nodes().end()) return;
  const bool was_foreign = at->second.told == MergedNode::Told::foreign;
  merged.forget(at);
  has_news_to_save = true;
  offer_what_is_said(serial, now);
  reconcile(serial, now);
  const MergedNode* const known = merged.find(serial);
  if (!was_foreign || (known != nullptr && known->told == MergedNode::Told::foreign)) return;
  listener.on_node_gone(serial, known == nullptr ? LeftReason::removed : known->record->left, now);
}

// A version may have come to say less than it did: then what is forgotten hid what is said now. A
// set that is not complete may be about to take it back: it is asked again when it is.
void FleetMember::State::offer_what_is_said(Serial serial, port::Instant now) {
  std::vector<std::pair<RecordPointer, std::string_view>> said;
  for (auto& [name, peer] : peers) {
    RecordPointer record = peer.set.find(serial);
    if (record == nullptr || !peer.is_believed || is_disowned(*record)) continue;
    if (peer.set.is_complete()) {
      said.emplace_back(std::move(record), name);
    } else {
      peer.is_hidden = true;
    }
  }
  for (auto& [record, name] : said) offer(std::move(record), name, now);
}

// Who might disown it is not there any more. REQUIRES: a peer.
void FleetMember::State::offer_what_is_held_for(const std::string& owner, port::Instant now) {
  std::vector<std::pair<RecordPointer, std::string_view>> held_for_it;
  for (auto& [name, peer] : peers) {
    if (name == owner || !peer.is_believed) continue;
    peer.is_hidden = peer.is_hidden || !peer.set.is_complete();
    if (!peer.set.is_complete()) continue;
    peer.set.for_each([&, from = std::string_view(name)](const RecordPointer& record) {
      if (record->owner == owner) held_for_it.emplace_back(record, from);
    });
  }
  for (auto& [record, name] : held_for_it) offer(std::move(record), name, now);
}

void FleetMember::State::drop_needless(port::Instant now) {
  const auto is_needless = [&](Serial serial, const HeldRecord& each) {
    const FleetRecord& record = *each.record;
    const MergedNode* const known = merged.find(serial);
    if (known != nullptr && compare(*known->record, record) > 0) return true;
    if (record.owner != settings.gateway && is_held_by_better(serial, record)) return true;
    const auto owner = peers.find(record.owner);
    const bool is_back = owner != peers.end() && owner->second.state == PeerState::online &&
                         owner->second.set.is_complete();
    if (is_back && !record.has_left()) return true;
    return record.has_left() && now - each.held_since >= settings.leave_after &&
           !has_older(serial, record);
  };
  std::vector<Serial> needless;
  for (const auto& [serial, each] : held) {
    if (is_needless(serial, each)) needless.push_back(serial);
  }
  for (const Serial serial : needless) yield(serial, now);
}

// Those that no set has any more.
void FleetMember::State::forget_tombstones(port::Instant now) {
  for (auto at = merged.nodes().begin(); at != merged.nodes().end();) {
    MergedNode& node = at->second;
    if (!node.record->has_left() || is_anywhere(at->first)) {
      node.needless_since = port::never;
      ++at;
      continue;
    }
    if (node.needless_since == port::never) node.needless_since = now;
    const bool is_over = now - node.needless_since >= settings.silent_after;
    at = is_over ? merged.forget(at) : std::next(at);
  }
}

// One of those who are there says of the nodes of a member that is gone that they have left.
void FleetMember::State::bury_nodes_of_the_gone(port::Instant now) {
  const auto is_gone = [&](const Peer& peer) {
    const port::Duration patience =
        peer.is_back ? settings.leave_after : std::max(settings.leave_after, settings.return_time);
    return peer.state != PeerState::online && now - std::max(peer.since, since) >= patience &&
           rank_for(peer.name) == 0;
  };
  if (std::none_of(peers.begin(), peers.end(),
                   [&](const auto& entry) { return is_gone(entry.second); })) {
    return;
  }
  for (auto& [serial, node] : merged.nodes()) {
    const FleetRecord& record = *node.record;
    if (record.has_left()) continue;
    const auto owner = peers.find(record.owner);
    if (owner == peers.end() || !is_gone(owner->second)) continue;
    FleetRecord tombstone = record;
    tombstone.owner = settings.gateway;
    tombstone.is_heard = false;
    tombstone.left = LeftReason::gateway_gone;
    raise_version(tombstone, record);
    auto shared = std::make_shared<const FleetRecord>(std::move(tombstone));
    merged.amend(shared, now);
    has_news_to_save = true;
    hold(std::move(shared), now, now);
    tell_node(serial, node, now);
  }
}

// Members differ for long, though nobody has anything to say: then what those who are not there
// have on the broker may be seen from here alone. That the places are the same is not enough: an
// owner that is the wrong one may be here for ever, and another one be waited for to bury a node.
void FleetMember::State::doubt_the_absent(port::Instant now) {
  bool has_same_places = true;
  bool has_same_records = true;
  for (const auto& [name, peer] : peers) {
    if (peer.state != PeerState::online || !peer.header) continue;
    const FleetHeader& theirs = *peer.header;
    has_same_places = has_same_places && theirs.merged_hash == merged.hash();
    has_same_records = has_same_records && (theirs.merged_records == 0 ||
                                            theirs.merged_records == merged.record_hash());
  }
  const bool is_long =
      differing_places.last(has_same_places, merged.hash(), settings.period / 2, now) ||
      differing_records.last(has_same_records, merged.record_hash(), settings.period / 2, now);
  if (!is_long) return;
  differing_places.since = differing_records.since = now;
  for (auto& [name, peer] : peers) {
    if (peer.state != PeerState::online) peer.is_doubted = true;
  }
}

}  // namespace etcm::firmware
