// Who speaks for a node. Each member that hears it asks itself; a greater version says so to all.
#include <algorithm>
#include <utility>

#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_state.h"
#include "firmware/fleet/json_text.h"

namespace etcm::firmware {

bool FleetMember::State::owns(const FleetRecord& record) const {
  return record.owner == settings.gateway && !is_read_only;
}

// It came late, or from another program of this name: this member knows by now what it speaks for.
bool FleetMember::State::is_strange(const FleetRecord& record) const {
  return is_settled && owns(record) && !record.has_left() && !local.contains(record.node.serial);
}

// Whether that member may be expected to speak for its nodes.
bool FleetMember::State::is_available(const std::string& name, port::Instant now) const {
  const auto at = peers.find(name);
  if (at == peers.end()) return false;
  const Peer& peer = at->second;
  // At the start nobody has been heard of yet.
  const bool may_come =
      peer.state == PeerState::unknown && now - peer.since < settings.silent_after;
  return peer.state == PeerState::online || may_come;
}

// REQUIRES: the node is heard here, and the record is another's or a tombstone.
bool FleetMember::State::may_claim(const LocalNode& here, const MergedNode& known,
                                   port::Instant now) const {
  const FleetRecord& record = *known.record;
  if (record.has_left()) return true;
  if (!record.is_heard || !is_available(record.owner, now)) return true;
  // Before it is known what the broker has, the record may be an old one.
  if (is_connected && !is_settled) return false;
  if (here.has_arrived) return true;
  // Both hear it. One of them is preferred, the same to all, so that this comes to an end; it must
  // have heard the node since the other said so, for otherwise it may just have lost it.
  const std::string key = hex_text(record.node.serial.value, 8);
  return here.heard_at > known.received_at &&
         rendezvous_weight(key, settings.gateway) > rendezvous_weight(key, record.owner);
}

// Greater than that one, by as little as the epoch of this member allows.
void FleetMember::State::raise_version(FleetRecord& record, const FleetRecord& above) const {
  if (header.run.epoch > above.incarnation) {
    record.incarnation = header.run.epoch;
    record.sequence = 1;
    return;
  }
  const bool is_spent = above.sequence >= fleet_number_max;
  record.incarnation = std::min(fleet_number_max, above.incarnation + (is_spent ? 1 : 0));
  record.sequence = is_spent ? 1 : above.sequence + 1;
}

void FleetMember::State::hold(RecordPointer record, port::Instant due, port::Instant now) {
  const Serial serial = record->node.serial;
  held[serial] = {.record = std::move(record), .is_sent = false, .held_since = now};
  out.mark({.kind = TopicKind::node, .serial = serial}, due);
}

void FleetMember::State::claim(LocalNode& here, const MergedNode* known, port::Instant now) {
  FleetRecord record{.node = here.node,
                     .owner = settings.gateway,
                     .incarnation = header.run.epoch,
                     .sequence = 1,
                     .is_heard = here.is_heard};
  if (known != nullptr) raise_version(record, *known->record);
  // What it hears no more does not clash any longer.
  std::optional<std::string> lost_by;
  if (known != nullptr && !known->record->is_heard) lost_by = known->record->owner;
  auto shared = std::make_shared<const FleetRecord>(std::move(record));
  if (merged.offer(shared, now) != MergedSet::Offered::newer) return;
  here.has_arrived = false;
  has_news_to_save = true;
  if (lost_by)
    has_clash_news = clashes.erase({shared->node.serial, *lost_by}) > 0 || has_clash_news;
  hold(std::move(shared), now, now);
}

// REQUIRES: the record is this member's, of a node that is there.
void FleetMember::State::update_own(LocalNode& here, const MergedNode& known, port::Instant now) {
  here.has_arrived = false;
  const FleetRecord& record = *known.record;
  const auto mine = held.find(record.node.serial);
  const bool is_held = mine != held.end() && compare(*mine->second.record, record) == 0;
  const bool is_same = has_same_content(record.node, here.node) && record.is_heard == here.is_heard;
  if (is_same) {
    if (is_held) return;
    hold(known.record, now, now);
    // By an earlier run, or by this one before it gave the node up.
    held[record.node.serial].is_sent = true;
    return;
  }
  FleetRecord next{.node = here.node,
                   .owner = settings.gateway,
                   .incarnation = record.incarnation,
                   .sequence = record.sequence,
                   .is_heard = here.is_heard};
  // A version that nobody has seen may still say something else.
  if (!is_held || mine->second.is_sent) raise_version(next, record);
  const OutKey key{.kind = TopicKind::node, .serial = next.node.serial};
  const Outgoing::Slot* const slot = out.find(key);
  const bool may_wait =
      is_held && record.is_heard == here.is_heard && slot != nullptr && slot->was_sent;
  const port::Instant due = may_wait ? std::max(now, slot->sent_at + settings.report_min) : now;
  auto shared = std::make_shared<const FleetRecord>(std::move(next));
  merged.amend(shared, now);
  has_news_to_save = true;
  hold(std::move(shared), due, now);
}

// Another one speaks for the node, or it has left: nothing is said of it here.
void FleetMember::State::yield(Serial serial, port::Instant now) {
  if (held.erase(serial) > 0) out.mark({.kind = TopicKind::node, .serial = serial}, now);
  if (neighbours.erase(serial) > 0) {
    out.mark({.kind = TopicKind::neighbours, .serial = serial}, now);
  }
}

// What an earlier run has said, and this one knows nothing of: it may be heard again.
void FleetMember::State::adopt_own(port::Instant now) {
  for (const auto& [serial, node] : merged.nodes()) {
    const FleetRecord& record = *node.record;
    if (!owns(record) || record.has_left() || local.contains(serial)) continue;
    if (local.size() >= settings.nodes_max) return;
    local[serial] = {.node = record.node, .heard_at = now};
  }
}

// It is not there, and nobody needs to be told so.
void FleetMember::State::forget(Serial serial, port::Instant now) {
  const auto at = merged.nodes().find(serial);
  if (at == merged.nodes().end()) return;
  const bool was_foreign = at->second.told == MergedNode::Told::foreign;
  merged.forget(at);
  has_news_to_save = true;
  if (was_foreign) listener.on_node_gone(serial, LeftReason::removed, now);
}

// After what is known of a node, or heard of it, has changed.
void FleetMember::State::reconcile(Serial serial, port::Instant now) {
  MergedNode* known = merged.find(serial);
  const auto heard = local.find(serial);
  if (known != nullptr && is_strange(*known->record)) {
    forget(serial, now);
    return;
  }
  if (!is_read_only) {
    if (heard != local.end()) {
      LocalNode& here = heard->second;
      if (known == nullptr) {
        if (here.is_heard) claim(here, nullptr, now);
      } else if (owns(*known->record) && !known->record->has_left()) {
        update_own(here, *known, now);
      } else if (here.is_heard && may_claim(here, *known, now)) {
        claim(here, known, now);
      } else {
        here.has_arrived = false;
      }
    }
    known = merged.find(serial);
    const auto mine = held.find(serial);
    const bool is_surpassed =
        mine != held.end() && known != nullptr && compare(*mine->second.record, *known->record) < 0;
    if (is_surpassed) yield(serial, now);
  }
  if (known != nullptr) tell_node(serial, *known, now);
}

bool FleetMember::hear(const FleetNode& node, port::Instant now) {
  State& state = *state_;
  if (!is_sound(node)) return false;
  const auto at = state.local.find(node.serial);
  if (at == state.local.end()) {
    const bool is_full = state.local.size() >= state.settings.nodes_max ||
                         (state.merged.count() >= state.settings.nodes_max &&
                          state.merged.find(node.serial) == nullptr);
    if (is_full) {
      state.note_lack_of_room(node.serial, state.settings.gateway, now);
      return false;
    }
    state.local[node.serial] = {
        .node = node, .is_heard = true, .has_arrived = true, .was_heard = true, .heard_at = now};
  } else {
    LocalNode& known = at->second;
    if (!known.is_heard) known.has_arrived = true;
    known.node = node;
    known.is_heard = known.was_heard = true;
    known.heard_at = now;
  }
  state.reconcile(node.serial, now);
  state.watch_place(state.local[node.serial], now);
  return true;
}

void FleetMember::lose(Serial serial, port::Instant now) {
  const auto at = state_->local.find(serial);
  if (at == state_->local.end() || !at->second.is_heard) return;
  at->second.is_heard = at->second.has_arrived = false;
  state_->reconcile(serial, now);
}

void FleetMember::lose_others(port::Duration silence, port::Instant now) {
  std::vector<Serial> lost;
  for (const auto& [serial, here] : state_->local) {
    if (!here.is_heard || now - here.heard_at < silence) continue;
    const MergedNode* const known = state_->merged.find(serial);
    if (known == nullptr || !state_->owns(*known->record)) lost.push_back(serial);
  }
  for (const Serial serial : lost) lose(serial, now);
}

void FleetMember::State::remove(Serial serial, LeftReason reason, port::Instant now) {
  if (local.erase(serial) == 0) return;
  MergedNode* const known = merged.find(serial);
  if (known == nullptr || !owns(*known->record) || known->record->has_left()) return;
  FleetRecord tombstone = *known->record;
  tombstone.is_heard = false;
  tombstone.left = reason;
  raise_version(tombstone, *known->record);
  auto shared = std::make_shared<const FleetRecord>(std::move(tombstone));
  yield(serial, now);
  merged.amend(shared, now);
  has_news_to_save = true;
  hold(std::move(shared), now, now);
  tell_node(serial, *known, now);
}

// What was taken over from an earlier run, and that the gateway itself may know nothing of.
void FleetMember::State::remove_unheard(port::Instant now) {
  std::vector<Serial> unheard;
  for (const auto& [serial, node] : local) {
    const bool is_over = !node.was_heard && now - node.heard_at >= settings.leave_after;
    if (is_over) unheard.push_back(serial);
  }
  for (const Serial serial : unheard) remove(serial, LeftReason::silent, now);
}

void FleetMember::remove(Serial serial, LeftReason reason, port::Instant now) {
  state_->remove(serial, reason, now);
}

}  // namespace etcm::firmware
