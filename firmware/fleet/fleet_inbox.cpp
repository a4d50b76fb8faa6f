// What comes from the broker. Nothing that is not sound gets past here.
#include <algorithm>
#include <utility>

#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_state.h"
#include "firmware/fleet/fleet_topics.h"
#include "firmware/fleet/record_codec.h"

namespace etcm::firmware {

void FleetMember::State::take(const port::BrokerMessage& message, port::Instant now) {
  const auto topic = parse_topic(message.topic, settings.site);
  if (!topic) return;
  if (topic->kind == TopicKind::site) {
    take_site(message.payload, now);
  } else if (topic->gateway == settings.gateway) {
    take_own(*topic, message.payload, now);
  } else {
    take_peer(*topic, message, now);
  }
}

Peer* FleetMember::State::peer_of(std::string_view name, port::Instant now) {
  const auto at = peers.find(name);
  if (at != peers.end()) return &at->second;
  if (peers.size() + 1 >= settings.members_max) {
    // One of whom nothing sound is known makes room: never one whose records are being offered, as
    // their owners come here too.
    const auto spare = std::find_if(peers.begin(), peers.end(),
                                    [&](const auto& each) { return is_stranger(each.second); });
    if (spare == peers.end()) {
      if (!std::exchange(has_said_full, true)) {
        log.write(port::Level::warning, "the fleet has more than " +
                                            std::to_string(settings.members_max) +
                                            " gateways: the rest are not heard");
      }
      return nullptr;
    }
    peers.erase(spare);
  }
  Peer& peer = peers[std::string(name)];
  peer.name = name;
  peer.since = peer.heard_at = now;
  peer.have_pause = settings.period / 4;
  peer.has_news = true;
  return &peer;
}

void FleetMember::State::reject(std::string_view name, const std::string& tail,
                                const std::string& wrong, port::Instant now) {
  ++rejected_count;
  Peer* const peer = peer_of(name, now);
  if (peer == nullptr) return;
  peer->rejected_at = now;
  if (!peer->quarantine.empty()) return;
  peer->quarantine = tail + ": " + wrong;
  peer->has_news = true;
  log.write(port::Level::warning, "gateway " + std::string(name) +
                                      " of the fleet says what is not sound (" + peer->quarantine +
                                      "): only what was sound before counts");
}

// What was not sound is there no more.
void FleetMember::State::release(Peer& peer) {
  peer.quarantine.clear();
  peer.has_news = true;
}

bool FleetMember::State::is_stranger(const Peer& peer) const {
  return !peer.header && !peer.is_owner && peer.set.size() == 0;
}

void FleetMember::State::take_peer(const FleetTopic& topic, const port::BrokerMessage& message,
                                   port::Instant now) {
  const std::string_view payload = message.payload;
  if (topic.kind == TopicKind::have && topic.other == settings.gateway) {
    take_have(payload, now);
    return;
  }
  const bool concerns = topic.kind == TopicKind::node || topic.kind == TopicKind::set ||
                        topic.kind == TopicKind::header || topic.kind == TopicKind::clashes;
  if (!concerns) return;
  if (payload.empty() && peers.find(topic.gateway) == peers.end()) return;
  Peer* const peer = peer_of(topic.gateway, now);
  if (peer == nullptr) return;
  const bool is_of_set = topic.kind == TopicKind::node || topic.kind == TopicKind::set;
  if (is_of_set) peer->set_changed_at = now;
  std::string wrong;
  bool is_sound = false;
  if (topic.kind == TopicKind::clashes) {
    std::vector<ToldClash> told;
    is_sound = decode_clashes(payload, told, wrong);
    take_clashes(*peer, std::move(told));
  } else if (topic.kind == TopicKind::node) {
    is_sound = take_peer_node(*peer, topic.serial, payload, wrong, now);
  } else if (topic.kind == TopicKind::set) {
    is_sound = take_peer_set(*peer, payload, wrong);
  } else {
    is_sound = take_peer_header(*peer, message, wrong, now);
  }
  const std::string tail = topic_tail(topic.kind, topic.serial);
  if (!is_sound) reject(topic.gateway, tail, wrong, now);
  if (payload.empty() && peer->quarantine.starts_with(tail + ": ")) release(*peer);
  check_complete(*peer, now);
}

bool FleetMember::State::take_peer_node(Peer& peer, Serial serial, std::string_view payload,
                                        std::string& wrong, port::Instant now) {
  if (payload.empty()) {
    peer.set.erase(serial);
    return true;
  }
  auto record = decode_record(payload, serial, wrong);
  if (!record) {
    peer.set.erase(serial);
    return false;
  }
  // Nodes and as many tombstones.
  if (peer.set.size() >= 2 * std::size_t{settings.nodes_max} && peer.set.find(serial) == nullptr) {
    note_lack_of_room(serial, peer.name, now);
    return true;
  }
  const auto shared = std::make_shared<const FleetRecord>(std::move(*record));
  peer.set.put(shared);
  // What comes first of a member may be any part of what it knows.
  if (peer.is_believed) offer(shared, peer.name, now);
  return true;
}

bool FleetMember::State::take_peer_set(Peer& peer, std::string_view payload, std::string& wrong) {
  if (payload.empty()) {
    peer.set.set_summary(std::nullopt);
    return true;
  }
  const auto summary = decode_set(payload, wrong);
  peer.set.set_summary(summary);
  peer.is_doubted = false;
  return summary.has_value();
}

// That a member was there once, and no more, is known of it: the next header must come soon.
port::Instant FleetMember::State::heard_before(port::Instant now) const {
  return now - settings.silent_after + settings.period * 5 / 4;
}

bool FleetMember::State::take_peer_header(Peer& peer, const port::BrokerMessage& message,
                                          std::string& wrong, port::Instant now) {
  const std::string_view payload = message.payload;
  if (payload.empty()) {
    peer.header.reset();
    set_peer_state(peer, PeerState::unknown, now);
    if (is_settled) forget_dismissed();
    return true;
  }
  const auto taken = decode_header(payload, wrong);
  peer.has_sound_header = taken.has_value();
  if (!taken) return false;
  if (peer.header) {
    const FleetHeader& known = *peer.header;
    if (!taken->is_online) {
      // The will of a connection before this one may come late.
      const bool is_of_old =
          taken->run.instance != known.run.instance && taken->run.epoch <= known.run.epoch;
      if (is_of_old && known.is_online) return true;
    } else if (taken->run == known.run && taken->beat <= known.beat) {
      return true;  // it came twice
    }
  }
  peer.header = taken;
  peer.heard_at = message.retained ? heard_before(now) : now;
  peer.is_back = peer.is_back || (!message.retained && taken->is_online);
  peer.is_proven = peer.is_proven || peer.is_back;
  peer.is_doubted = false;
  set_peer_state(peer, taken->is_online ? PeerState::online : PeerState::offline, now);
  return true;
}

void FleetMember::State::check_complete(Peer& peer, port::Instant now) {
  const bool is_complete = peer.set.is_complete();
  if (is_complete && (!peer.is_believed || peer.is_hidden)) {
    peer.is_believed = true;
    peer.is_hidden = false;
    peer.set.for_each([&](const RecordPointer& record) { offer(record, peer.name, now); });
  }
  if (is_complete && peer.has_sound_header && !peer.quarantine.empty()) {
    release(peer);
    log.write(port::Level::info, "gateway " + peer.name + " of the fleet is sound again");
  }
  if (peer.told_complete != is_complete) {
    peer.told_complete = is_complete;
    peer.has_news = true;
  }
}

// An owner that is not there must be known too: its nodes are to leave one day.
bool FleetMember::State::know_owner(const std::string& name, port::Instant now) {
  if (name == settings.gateway) return true;
  Peer* const peer = peer_of(name, now);
  if (peer != nullptr) peer->is_owner = true;
  return peer != nullptr;
}

void FleetMember::State::offer(RecordPointer record, std::string_view from, port::Instant now) {
  const Serial serial = record->node.serial;
  // It would hide what others say of the node.
  if (is_strange(*record) || !know_owner(record->owner, now)) return;
  switch (merged.offer(std::move(record), now)) {
    case MergedSet::Offered::older:
    case MergedSet::Offered::same:
      break;
    case MergedSet::Offered::newer:
      has_news_to_save = true;
      break;
    case MergedSet::Offered::no_room:
      note_lack_of_room(serial, from, now);
      return;
  }
  reconcile(serial, now);
}

// Nobody else is to blame for it. Who told of the node tells of it again, after report_max at the
// latest.
void FleetMember::State::note_lack_of_room(Serial serial, std::string_view from,
                                           port::Instant now) {
  room_lacks_until = now + settings.report_max + settings.period;
  if (std::exchange(lacks_room, true)) return;
  log.write(port::Level::error, "fleet: there is no room for node " + std::to_string(serial.value) +
                                    " of gateway " + std::string(from) +
                                    " and others; raise vertices_max in [mesh] of this gateway, "
                                    "and start it again");
}

// 0: there is nothing. Of topics that are compared with what should be there.
void FleetMember::State::note_on_broker(OutKey key, std::uint64_t hash) {
  const bool is_compared = key.kind == TopicKind::node || key.kind == TopicKind::neighbours ||
                           key.kind == TopicKind::set || key.kind == TopicKind::alarms ||
                           key.kind == TopicKind::clashes;
  if (!is_compared) return;
  compare_at = std::min(compare_at, stepped_at);
  if (hash == 0) {
    on_broker.erase(key);
  } else if (on_broker.size() < 8 * std::size_t{settings.nodes_max} || on_broker.contains(key)) {
    on_broker[key] = hash;
  }
}

void FleetMember::State::take_own(const FleetTopic& topic, std::string_view payload,
                                  port::Instant now) {
  if (topic.kind == TopicKind::header) {
    take_own_header(payload, now);
    return;
  }
  std::string wrong;
  if (topic.kind == TopicKind::conflict) {
    const auto run = decode_conflict(payload, wrong);
    if (run && run->instance != settings.instance) take_conflict(*run, now);
    return;
  }
  note_on_broker({.kind = topic.kind, .serial = topic.serial}, payload_hash(payload));
  if (topic.kind == TopicKind::set) {
    const auto set = decode_set(payload, wrong);
    if (set) take_epoch(set->run);
    return;
  }
  if (topic.kind != TopicKind::node || payload.empty()) return;
  // Of an earlier run whose memory was lost, or of a twin.
  auto record = decode_record(payload, topic.serial, wrong);
  if (!record) return;
  note_version(*record, now);
  offer(std::make_shared<const FleetRecord>(std::move(*record)), settings.gateway, now);
}

// Another run of this name comes before this one. Its will may be older than its set.
void FleetMember::State::take_epoch(const FleetRun& run) {
  note_arrival(run);
  const bool is_behind = run.instance != settings.instance && run.epoch >= header.run.epoch &&
                         run.epoch < fleet_number_max;
  if (!is_behind) return;
  header.run.epoch = run.epoch + 1;
  has_news_to_save = true;
  set_will();
}

// What the broker has of a node has been seen, though this run may not have sent it.
void FleetMember::State::note_version(const FleetRecord& there, port::Instant now) {
  const auto at = held.find(there.node.serial);
  if (at == held.end()) return;
  HeldRecord& mine = at->second;
  const bool is_same_version = owns(there) && owns(*mine.record) &&
                               there.incarnation == mine.record->incarnation &&
                               there.sequence == mine.record->sequence;
  if (!is_same_version) return;
  mine.is_sent = true;
  if (compare(there, *mine.record) == 0) return;
  FleetRecord next = *mine.record;
  raise_version(next, there);
  auto shared = std::make_shared<const FleetRecord>(std::move(next));
  merged.amend(shared, now);
  has_news_to_save = true;
  hold(std::move(shared), now, now);
}

void FleetMember::State::take_own_header(std::string_view payload, port::Instant now) {
  std::string wrong;
  const auto taken = decode_header(payload, wrong);
  const bool is_mine = taken && taken->run.instance == settings.instance && taken->is_online;
  if (is_mine) return;
  // The will of an earlier connection, an earlier run or somebody else has replaced it.
  mark_header();
  if (!taken) return;
  take_epoch(taken->run);
  const bool is_other = taken->run.instance != settings.instance;
  if (is_other && taken->is_online) return take_other_header(*taken, now);
  if (is_other) return note_end(taken->run, now);
  // Whoever was told that this one has gone is told that it has not.
  next_conflict = now;
}

}  // namespace etcm::firmware
