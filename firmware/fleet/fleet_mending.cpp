// What the broker has otherwise than its owner believes, such as one that a bridge has given what
// another one had kept: the owner cannot see that, but whoever sees that its set is not complete
// says what there is of it.
#include <algorithm>
#include <utility>

#include "firmware/fleet/fleet_state.h"
#include "firmware/fleet/fleet_topics.h"

namespace etcm::firmware {

void FleetMember::State::mend_incomplete(port::Instant now) {
  for (auto& [name, peer] : peers) {
    if (peer.set.is_complete() || peer.state != PeerState::online) {
      peer.incomplete_since = port::never;
      peer.have_pause = settings.period / 4;
      continue;
    }
    if (peer.incomplete_since == port::never) peer.incomplete_since = now;
    // It says more at the moment, and may be about to be complete; but some never fall silent.
    const bool is_quiet = now - peer.set_changed_at >= settings.period / 4;
    const bool is_long = now - peer.incomplete_since >= settings.period;
    if (now - peer.incomplete_since < peer.have_pause || (!is_quiet && !is_long)) continue;
    if (!say_what_is_here(peer)) return;
    if (peer.have_next != Serial{0}) continue;
    peer.incomplete_since = now;
    // A message a period at the most: what is wrong may be over at any time.
    const auto messages = static_cast<int>(1 + peer.set.size() / have_items_max);
    peer.have_pause = std::min(2 * peer.have_pause, messages * settings.period);
  }
}

// Members whose headers tell of an older document are told of this one again, though the broker
// has it as seen from here. One that has read it and refused it has it too; and whose it is says it
// again: others may not be allowed to.
void FleetMember::State::mend_site(port::Instant now) {
  const bool is_known = site.held && site.version.number > 0;
  const auto is_here = [](const Peer& peer) {
    return peer.state == PeerState::online && peer.header;
  };
  const auto has_read_it = [&](const Peer& peer) {
    return std::max(peer.header->site, peer.header->refused_site) >= site.version;
  };
  const bool is_any_behind = std::any_of(peers.begin(), peers.end(), [&](const auto& entry) {
    return is_here(entry.second) && !has_read_it(entry.second);
  });
  const auto owner = is_known ? peers.find(site.held->gateway) : peers.end();
  const bool is_with_owner = is_known && !is_site_of_here() && owner != peers.end() &&
                             is_here(owner->second) && has_read_it(owner->second);
  if (!is_known || !is_any_behind || is_with_owner) {
    site.behind_since = port::never;
    site.mend_pause = settings.period / 2;
    return;
  }
  if (site.behind_since == port::never) site.behind_since = now;
  if (now - site.behind_since < site.mend_pause) return;
  site.behind_since = now;
  site.mend_pause = std::min(2 * site.mend_pause, settings.report_max);
  mark_site(now);
}

// The next part of it. False: the broker takes nothing now.
bool FleetMember::State::say_what_is_here(Peer& peer) {
  FleetHave have{.first = peer.have_next, .last = Serial{Serial::none_value - 1}};
  peer.set.for_each([&](const RecordPointer& record) {
    if (record->node.serial < have.first || have.items.size() > have_items_max) return;
    have.items.push_back({.serial = record->node.serial,
                          .incarnation = record->incarnation,
                          .sequence = record->sequence});
  });
  Serial next{0};
  if (have.items.size() > have_items_max) {
    next = have.items.back().serial;
    have.items.pop_back();
    have.last = Serial{next.value - 1};
  }
  const std::string topic = topic_text(
      settings.site, {.kind = TopicKind::have, .gateway = settings.gateway, .other = peer.name});
  const std::string payload = encode_have(have);
  if (!broker.publish({.topic = topic, .payload = payload, .at_most_once = true}, other_token)) {
    return false;
  }
  peer.have_next = next;
  return true;
}

// Another member does not have this one's set as it should be.
void FleetMember::State::take_have(std::string_view payload, port::Instant now) {
  std::string wrong;
  const auto have = decode_have(payload, wrong);
  if (!have) {
    ++rejected_count;
    return;
  }
  if (!is_settled || is_read_only) return;
  for (const FleetHave::Item& item : have->items) mend(item.serial, &item, now);
  std::vector<Serial> missing;
  for (auto at = held.lower_bound(have->first); at != held.end() && at->first <= have->last; ++at) {
    const bool is_there =
        std::any_of(have->items.begin(), have->items.end(),
                    [&](const FleetHave::Item& item) { return item.serial == at->first; });
    if (!is_there) missing.push_back(at->first);
  }
  for (const Serial serial : missing) mend(serial, nullptr, now);
  const Outgoing::Slot* const set = out.find({.kind = TopicKind::set});
  if (set != nullptr && now - set->sent_at >= settings.settle) {
    out.mark({.kind = TopicKind::set}, now);
  }
}

// `item`: what the other one has; null: nothing.
void FleetMember::State::mend(Serial serial, const FleetHave::Item* item, port::Instant now) {
  const OutKey key{.kind = TopicKind::node, .serial = serial};
  const Outgoing::Slot* const slot = out.find(key);
  // What is under way, or has just been, is there by now.
  const bool is_quiet =
      slot == nullptr || (slot->in_flight == 0 && now - slot->sent_at >= settings.settle);
  const auto mine = held.find(serial);
  const bool is_right = mine != held.end() && item != nullptr &&
                        mine->second.record->incarnation == item->incarnation &&
                        mine->second.record->sequence == item->sequence;
  if (is_quiet && !is_right) out.mark(key, now);
}

}  // namespace etcm::firmware
