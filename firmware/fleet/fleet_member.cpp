#include "firmware/fleet/fleet_member.h"

#include <algorithm>
#include <utility>

#include "firmware/fleet/fleet_state.h"
#include "firmware/fleet/fleet_topics.h"

namespace etcm::firmware {

FleetMember::FleetMember(const FleetSettings& settings, port::MessageBroker& broker,
                         FleetListener& listener, port::Log& log, port::Instant now)
    : state_(std::make_unique<State>(settings, broker, listener, log)) {
  state_->since = state_->next_tick = now;
  state_->header.run = {.instance = settings.instance, .epoch = 1};
  state_->header.version = settings.version;
  state_->header.is_alone = settings.is_alone;
  state_->set_will();
  broker.set_listener(this);
  broker.subscribe(member_filters(settings.site, settings.gateway));
}

FleetMember::~FleetMember() { state_->broker.set_listener(nullptr); }

std::string FleetMember::restore(std::span<const std::byte> saved, port::Instant now) {
  return state_->restore(saved, now);
}

std::vector<std::byte> FleetMember::save() const { return state_->save(); }

bool FleetMember::take_news_to_save() { return std::exchange(state_->has_news_to_save, false); }

void FleetMember::step(port::Instant now) {
  State& state = *state_;
  const FleetSettings& settings = state.settings;
  state.stepped_at = now;
  if (now >= state.settles_at()) state.settle(now);
  if (now >= state.next_tick) {
    state.tick(now);
    state.next_tick = now + std::min(settings.period / 8, settings.settle);
  }
  state.send(now);
  if (state.is_header_taken && state.out.next_due() > now) state.has_told_all = true;
  state.tell_peers(now);
}

port::Instant FleetMember::next_deadline() const {
  const State& state = *state_;
  port::Instant next = state.next_tick;
  next = std::min(next, state.settles_at());
  const bool may_send = state.is_settled && !state.is_blocked && !state.is_read_only;
  return may_send ? std::min(next, state.out.next_due()) : next;
}

const FleetRecord* FleetMember::next_node(Serial after) const {
  const MergedSet::Nodes& nodes = state_->merged.nodes();
  auto at = after.is_none() ? nodes.begin() : nodes.upper_bound(after);
  while (at != nodes.end() && at->second.record->has_left()) ++at;
  return at == nodes.end() ? nullptr : at->second.record.get();
}

const FleetRecord* FleetMember::find(Serial serial) const {
  const MergedNode* const node = std::as_const(state_->merged).find(serial);
  return node == nullptr || node->record->has_left() ? nullptr : node->record.get();
}

bool FleetMember::is_stale(const FleetRecord& record) const { return state_->is_stale_now(record); }

bool FleetMember::is_own(const FleetRecord& record) const { return state_->owns(record); }

std::vector<PeerReport> FleetMember::peers() const { return state_->reports(); }

FleetAgreement FleetMember::agreement() const { return state_->agreement(); }

FleetStatus FleetMember::status() const {
  const State& state = *state_;
  FleetStatus status{
      .is_connected = state.is_connected,
      .is_settled = state.is_settled,
      .since = state.since,
      .has_name_conflict = state.has_conflict,
      .is_read_only = state.is_read_only,
      .epoch = state.header.run.epoch,
      .node_count = state.merged.count(),
      .waiting_count = state.out.waiting_count(state.stepped_at),
      .merged_hash = state.merged.hash(),
      .is_refused = state.is_refused,
      .is_header_taken = state.is_header_taken,
      .has_told_all = state.has_told_all,
      .other_refused_count = state.other_refused_count,
      .lacks_room = state.lacks_room,
      .rejected_count = state.rejected_count,
      .sent_count = state.out.sent_count(),
      .site = state.site.version,
      .is_site_known = !state.site.held || state.site.is_fleets,
      .site_trouble = state.site.trouble.empty() ? state.site.unsound : state.site.trouble,
      .is_site_refused =
          !state.site.is_fleets && state.site.held && state.site.denied == state.site.version};
  for_each_node([&](const FleetRecord& record, bool is_stale) {
    if (is_stale) ++status.stale_count;
    if (state.owns(record)) ++status.own_count;
  });
  return status;
}

void FleetMember::on_connected(port::Instant now) {
  State& state = *state_;
  state.is_connected = true;
  state.is_settled = state.is_blocked = state.is_header_taken = state.has_told_all = false;
  state.since = state.kept_came_at = now;
  // All of it comes again, as far as the broker still has it.
  state.on_broker.clear();
  state.site.on_broker = {};
  for (auto& [name, peer] : state.peers) {
    peer.set.clear();
    peer.clashes.clear();
    peer.is_doubted = peer.is_back = false;
    if (peer.state == PeerState::online) peer.heard_at = state.heard_before(now);
  }
}

void FleetMember::on_disconnected(std::string_view, port::Instant now) {
  State& state = *state_;
  state.is_connected = state.is_settled = false;
  state.since = now;
  state.out.on_disconnected();
}

void FleetMember::on_message(const port::BrokerMessage& message, port::Instant now) {
  if (message.retained) state_->kept_came_at = now;
  state_->take(message, now);
}

void FleetMember::on_delivered(std::uint32_t token, port::Instant) {
  state_->is_blocked = false;
  const auto delivered = state_->out.take_delivered(token);
  if (!delivered) return;
  if (delivered->key.kind == TopicKind::header) {
    state_->is_refused = false;
    state_->is_header_taken = true;
  }
  if (delivered->key.kind == TopicKind::site) state_->note_site_delivered(delivered->hash);
  state_->note_on_broker(delivered->key, delivered->hash);
}

void FleetMember::on_refused(std::uint32_t token, std::string_view, port::Instant now) {
  state_->is_blocked = false;
  if (token == other_token) ++state_->other_refused_count;
  const std::optional<OutKey> key = state_->out.take_refused(token, now);
  if (key && key->kind == TopicKind::header) state_->is_refused = true;
  if (key && key->kind == TopicKind::site) state_->note_site_refused();
}

}  // namespace etcm::firmware
