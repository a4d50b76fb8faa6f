// What goes to the broker, and whether the broker still has what it was given.
#include <algorithm>
#include <utility>

#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_state.h"
#include "firmware/fleet/fleet_topics.h"
#include "firmware/fleet/json_text.h"
#include "firmware/fleet/record_codec.h"
#include "firmware/fleet/site_codec.h"

namespace etcm::firmware {

namespace {

constexpr OutKey header_key{.kind = TopicKind::header};
constexpr OutKey set_key{.kind = TopicKind::set};
constexpr OutKey alarms_key{.kind = TopicKind::alarms};
constexpr OutKey told_clashes_key{.kind = TopicKind::clashes};
// A header goes out at the most so many times a period.
constexpr int headers_a_period = 5;

std::string encode_neighbours(Serial serial, std::span<const Serial> neighbours,
                              std::uint32_t generation) {
  JsonText json;
  json.object().key("serial").number(serial.value).key("generation").number(generation);
  json.key("neighbours").array();
  for (const Serial each : neighbours) json.number(each.value);
  return json.end().end().take();
}

}  // namespace

bool FleetMember::State::wants(OutKey key) const {
  if (key.kind == TopicKind::node) return held.contains(key.serial);
  if (key.kind == TopicKind::neighbours) return neighbours.contains(key.serial);
  if (key.kind == TopicKind::clashes) return !told_clashes.empty();
  return key.kind == TopicKind::set || key.kind == TopicKind::alarms;
}

// When nothing has come of what the broker had kept for a while; never where that is behind.
port::Instant FleetMember::State::settles_at() const {
  if (!is_connected || is_settled) return port::never;
  constexpr int most = 20;
  return std::min(kept_came_at + settings.settle, since + most * settings.settle);
}

// What the broker had kept has come, or nothing does: now it is known what to say.
void FleetMember::State::settle(port::Instant now) {
  is_settled = has_arrived = true;
  adopt_own(now);
  // Now nodes may be claimed.
  std::vector<Serial> serials;
  for (const auto& [serial, node] : merged.nodes()) serials.push_back(serial);
  for (const auto& [serial, node] : local) serials.push_back(serial);
  for (const Serial serial : serials) reconcile(serial, now);
  compare_with_broker(now);
  out.mark(header_key, now);
  settle_site(now);
  forget_dismissed();
}

// Sends again what the broker has not or has otherwise, and takes back what nobody wants.
void FleetMember::State::compare_with_broker(port::Instant now) {
  compare_at = port::never;
  if (is_read_only) return;
  // What is under way, or has just been, comes back late: then this is done once more.
  const auto is_quiet = [&](const Outgoing::Slot* slot) {
    return slot == nullptr ||
           (slot->in_flight == 0 && !slot->is_refused &&
            (!slot->was_sent || now - slot->sent_at >= settings.settle || slot->sent_at < since));
  };
  const auto compare_one = [&](OutKey key) {
    const Outgoing::Slot* const slot = out.find(key);
    if (!is_quiet(slot)) {
      if (!slot->is_refused) compare_at = now + settings.settle;
      return;
    }
    const auto there = on_broker.find(key);
    const std::uint64_t theirs = there == on_broker.end() ? 0 : there->second;
    const std::uint64_t ours = slot == nullptr || !wants(key) ? 0 : slot->hash;
    if (theirs != ours || (wants(key) && ours == 0)) out.mark(key, now);
  };
  std::vector<OutKey> keys{set_key, alarms_key};
  if (wants(told_clashes_key)) keys.push_back(told_clashes_key);
  for (const auto& [key, hash] : on_broker) keys.push_back(key);
  for (const auto& [serial, record] : held) {
    keys.push_back({.kind = TopicKind::node, .serial = serial});
  }
  for (const auto& [serial, list] : neighbours) {
    keys.push_back({.kind = TopicKind::neighbours, .serial = serial});
  }
  for (const OutKey key : keys) {
    compare_one(key);
  }
}

void FleetMember::State::mark_header() {
  const Outgoing::Slot* const slot = out.find(header_key);
  const bool has_been = slot != nullptr && slot->was_sent;
  out.mark(header_key,
           has_been ? slot->sent_at + settings.period / headers_a_period : port::Instant{});
}

// What is due by time alone.
void FleetMember::State::mark_periodic(port::Instant now) {
  std::vector<OutKey> aged;
  for (const auto& [key, slot] : out.slots()) {
    const bool is_aged = slot.was_sent && now - slot.sent_at >= settings.report_max;
    if (is_aged && key.kind != TopicKind::site) aged.push_back(key);
  }
  for (const OutKey key : aged) out.mark(key, now);
  // Versions may change all the time, with readings: when none does there is something to compare.
  if (std::exchange(seen_records, merged.record_hash()) != merged.record_hash()) same_since = now;
  if (seen_records != told_records && now - same_since >= settings.period / 4) mark_header();
  // The set too: two brokers with a bridge may have given each other an older one with its nodes,
  // which looks complete.
  for (const OutKey key : {header_key, set_key}) {
    const Outgoing::Slot* const slot = out.find(key);
    if (slot != nullptr && slot->was_sent) out.mark(key, slot->sent_at + settings.period);
  }
}

void FleetMember::State::set_will() {
  FleetHeader will = header;
  will.is_online = false;
  const std::string topic =
      topic_text(settings.site, {.kind = TopicKind::header, .gateway = settings.gateway});
  const std::string payload = encode_header(will);
  broker.set_last_will({.topic = topic, .payload = payload, .retained = true});
}

void FleetMember::State::send(port::Instant now) {
  if (is_connected && (is_read_only || asks_for_other)) send_conflict(now);
  if (!is_connected || !is_settled || is_blocked || is_read_only) return;
  if (merged.hash() != told_merged_hash || merged.count() != told_merged_count) mark_header();
  const std::uint64_t sent = out.sent_count();
  const bool took_all = out.pump(
      now, broker, [&](OutKey key) { return encode(key, now); },
      [&](OutKey key) {
        return topic_text(settings.site,
                          {.kind = key.kind, .gateway = settings.gateway, .serial = key.serial});
      });
  is_blocked = !took_all;
  if (out.sent_count() != sent) compare_at = std::min(compare_at, now + settings.settle);
}

// So that the twin that goes on knows that this one is there: it tells nothing else. Or to ask
// whether there is one: it answers by a header.
void FleetMember::State::send_conflict(port::Instant now) {
  if (now < next_conflict) return;
  const std::string topic =
      topic_text(settings.site, {.kind = TopicKind::conflict, .gateway = settings.gateway});
  const std::string payload = encode_conflict(header.run);
  if (broker.publish({.topic = topic, .payload = payload, .at_most_once = true}, other_token)) {
    next_conflict = now + settings.period;
    asks_for_other = false;
  }
}

OutMessage FleetMember::State::encode_node(Serial serial, port::Instant now) {
  const auto at = held.find(serial);
  if (at == held.end()) return {};
  HeldRecord& mine = at->second;
  mine.is_sent = true;
  // However sound it is, others must hear of it once in a while.
  if (mine.record->owner == settings.gateway && !mine.record->has_left()) {
    const auto heard = local.find(serial);
    if (heard != local.end()) {
      FleetRecord record = *mine.record;
      record.node.heard_at = heard->second.node.heard_at;
      const auto passed = (now - heard->second.heard_at) / std::chrono::seconds(1);
      record.node.age_s = heard->second.node.age_s + static_cast<std::uint32_t>(passed);
      return {.payload = encode_record(record), .record_hash = record_hash(record)};
    }
  }
  return {.payload = encode_record(*mine.record), .record_hash = record_hash(*mine.record)};
}

OutMessage FleetMember::State::encode(OutKey key, port::Instant now) {
  switch (key.kind) {
    case TopicKind::node:
      return encode_node(key.serial, now);
    case TopicKind::neighbours: {
      const auto at = neighbours.find(key.serial);
      if (at == neighbours.end()) return {};
      return {.payload = encode_neighbours(key.serial, at->second.serials, at->second.generation)};
    }
    case TopicKind::set:
      return {.payload = encode_set(
                  {.run = header.run, .count = out.node_count(), .hash = out.node_hash()})};
    case TopicKind::alarms:
      return {.payload = alarms};
    case TopicKind::clashes:
      return {.payload = encode_clashes(told_clashes)};
    case TopicKind::site:
      return {.payload = site.held ? encode_site(*site.held) : std::string()};
    case TopicKind::header:
      ++header.beat;
      header.is_online = true;
      header.other_instance = other_instance(now);
      header.has_conflict = has_conflict;
      header.merged_count = told_merged_count = merged.count();
      header.merged_hash = told_merged_hash = merged.hash();
      header.merged_records = told_records = merged.record_hash();
      header.site = site.version;
      header.refused_site = site.refused ? site.refused->version() : SiteVersion{};
      return {.payload = encode_header(header)};
    case TopicKind::conflict:
    case TopicKind::have:
      break;
  }
  return {};
}

void FleetMember::set_neighbours(Serial serial, std::uint32_t generation,
                                 std::span<const Serial> neighbours) {
  State& state = *state_;
  const MergedNode* const known = state.merged.find(serial);
  const bool is_own = known != nullptr && state.owns(*known->record) && !known->record->has_left();
  const OutKey key{.kind = TopicKind::neighbours, .serial = serial};
  if (!is_own || neighbours.empty()) {
    if (state.neighbours.erase(serial) > 0) state.out.mark(key, port::Instant{});
    return;
  }
  State::Neighbours& told = state.neighbours[serial];
  const bool is_same =
      std::equal(told.serials.begin(), told.serials.end(), neighbours.begin(), neighbours.end());
  if (is_same) return;
  told = {.serials = {neighbours.begin(), neighbours.end()}, .generation = generation};
  state.out.mark(key, port::Instant{});
}

void FleetMember::set_alarms(std::string message) {
  if (message == state_->alarms) return;
  state_->alarms = std::move(message);
  state_->out.mark(alarms_key, port::Instant{});
}

void FleetMember::set_mesh(std::uint32_t generation, std::uint64_t mesh_hash,
                           std::uint32_t node_count) {
  FleetHeader& header = state_->header;
  const bool is_same = header.generation == generation && header.mesh_hash == mesh_hash &&
                       header.mesh_nodes == node_count;
  if (is_same) return;
  header.generation = generation;
  header.mesh_hash = mesh_hash;
  header.mesh_nodes = node_count;
  state_->mark_header();
}

}  // namespace etcm::firmware
