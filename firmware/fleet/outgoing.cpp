#include "firmware/fleet/outgoing.h"

#include <algorithm>

#include "firmware/fleet/fleet_hash.h"

namespace etcm::firmware {

std::uint64_t payload_hash(std::string_view payload) {
  return payload.empty() ? 0 : std::max(std::uint64_t{1}, fnv_hash(payload));
}

void Outgoing::mark(OutKey key, port::Instant due) {
  Slot& slot = slots_[key];
  if (slot.due <= due) return;
  due_.erase({slot.due, key});
  slot.due = due;
  if (due != port::never) due_.insert({due, key});
}

void Outgoing::unmark(OutKey key) {
  const auto at = slots_.find(key);
  if (at == slots_.end()) return;
  due_.erase({at->second.due, key});
  at->second.due = port::never;
}

const Outgoing::Slot* Outgoing::find(OutKey key) const {
  const auto at = slots_.find(key);
  return at == slots_.end() ? nullptr : &at->second;
}

// The sum over all nodes is told too, where it becomes another one.
void Outgoing::set_record(OutKey key, Slot& slot, std::uint64_t record_hash, port::Instant now) {
  if (key.kind != TopicKind::node || slot.record_hash == record_hash) return;
  node_hash_ += record_hash - slot.record_hash;
  if (slot.record_hash == 0) ++node_count_;
  if (record_hash == 0) --node_count_;
  slot.record_hash = record_hash;
  mark({.kind = TopicKind::set}, now);
}

void Outgoing::note_sent(OutKey key, Slot& slot, const OutMessage& message, port::Instant now) {
  if (slot.in_flight != 0) in_flight_.erase(slot.in_flight);
  due_.erase({slot.due, key});
  slot.due = port::never;
  slot.sent_at = now;
  slot.was_sent = true;
  slot.is_refused = false;
  slot.in_flight = ++token_;
  in_flight_[token_] = key;
  ++sent_count_;
  slot.hash = payload_hash(message.payload);
  set_record(key, slot, message.record_hash, now);
}

std::optional<Outgoing::Delivered> Outgoing::take_delivered(std::uint32_t token) {
  const auto at = in_flight_.find(token);
  if (at == in_flight_.end()) return std::nullopt;
  const OutKey key = at->second;
  in_flight_.erase(at);
  Slot& slot = slots_[key];
  slot.in_flight = 0;
  const Delivered delivered{.key = key, .hash = slot.hash};
  if (slot.hash == 0 && slot.due == port::never) slots_.erase(key);
  return delivered;
}

std::optional<OutKey> Outgoing::take_refused(std::uint32_t token, port::Instant now) {
  const auto at = in_flight_.find(token);
  if (at == in_flight_.end()) return std::nullopt;
  const OutKey key = at->second;
  in_flight_.erase(at);
  Slot& slot = slots_[key];
  slot.in_flight = 0;
  slot.is_refused = true;
  slot.hash = 0;
  set_record(key, slot, 0, now);
  return key;
}

void Outgoing::on_disconnected() {
  in_flight_.clear();
  for (auto& [key, slot] : slots_) {
    slot.in_flight = 0;
    slot.is_refused = false;
  }
}

void Outgoing::forget_nodes(port::Instant now) {
  for (auto& [key, slot] : slots_) {
    if (key.kind != TopicKind::node) continue;
    in_flight_.erase(slot.in_flight);
    slot.in_flight = 0;
    slot.hash = slot.record_hash = 0;
  }
  node_count_ = 0;
  node_hash_ = 0;
  mark({.kind = TopicKind::set}, now);
}

std::uint32_t Outgoing::waiting_count(port::Instant now) const {
  const auto due = std::count_if(due_.begin(), due_.end(),
                                 [now](const auto& each) { return each.first <= now; });
  return static_cast<std::uint32_t>(static_cast<std::size_t>(due) + in_flight_.size());
}

}  // namespace etcm::firmware
