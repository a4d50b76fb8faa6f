#include "firmware/home_assistant/announcer.h"

#include <algorithm>
#include <utility>

#include "firmware/fleet/fleet_hash.h"
#include "firmware/fleet/fleet_member.h"
#include "firmware/fleet/fleet_record.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// Between two looks at all nodes.
constexpr port::Duration round_pause = 1s;
// All is announced again after this: somebody may have taken a device out, such as the gateway that
// had the node before.
constexpr port::Duration repeat_interval = 1h;
// Until a broker that took no more is asked again.
constexpr port::Duration room_pause = 100ms;
// In one step: the fleet's own messages go before.
constexpr int messages_max = 4;
constexpr int announced_looks_max = 512;
void mix(std::uint64_t& hash, std::string_view text) {
  // Between two texts stands what no text has.
  hash = fnv_hash("\xff", fnv_hash(text, hash));
}

}  // namespace

Announcer::Announcer(const Settings& settings, std::string_view version, const NodeTable& nodes,
                     const ReadingSnapshot& readings, port::MessageBroker& broker)
    : version_(version),
      nodes_(nodes),
      snapshot_(readings),
      broker_(broker),
      prefix_(settings.mqtt->home_assistant),
      site_(settings.mqtt->site),
      gateway_(settings.mqtt->name) {
  readings_.reserve(fleet_readings_max);
  update_settings(settings);
}

void Announcer::update_settings(const Settings& settings) {
  has_degrees_ = settings.site.projection != nullptr;
  announced_.resize(nodes_.records().size());
  due_ = {};
}

void Announcer::step(port::Instant now, const FleetStanding& fleet) {
  if (std::exchange(refused_count_, fleet.other_refused_count) != fleet.other_refused_count) {
    is_under_way_ = false;
    due_ = now + repeat_interval;
  }
  if (!broker_.is_connected() || now < due_) return;
  if (!fleet.has_told_all) {
    due_ = now + round_pause;
    return;
  }
  if (!is_under_way_) begin_round(now);
  int sent = 0;
  for (int looks = 0; looks < announced_looks_max && sent < messages_max; ++looks) {
    if (next_slot_ == announced_.size()) {
      is_under_way_ = false;
      due_ = now + round_pause;
      return;
    }
    const Outcome outcome = look_at(next_slot_);
    if (outcome == Outcome::no_room) {
      due_ = now + room_pause;
      return;
    }
    if (outcome == Outcome::sent) ++sent;
    ++next_slot_;
  }
}

port::Instant Announcer::next_deadline() const {
  return broker_.is_connected() ? due_ : port::never;
}

// A broker that was started again may have kept nothing.
void Announcer::begin_round(port::Instant now) {
  is_under_way_ = true;
  next_slot_ = 0;
  if (session_ == broker_.counters().connections && now < repeat_due_) return;
  session_ = broker_.counters().connections;
  repeat_due_ = now + repeat_interval;
  for (Announced& announced : announced_) announced.shape = 0;
}

Announcer::Outcome Announcer::look_at(std::size_t slot) {
  Announced& announced = announced_[slot];
  const NodeRecord& node = nodes_.records()[slot];
  const bool is_own = node.is_known() && !node.is_foreign() && !node.has_asked_to_leave();
  if (!announced.serial.is_none() && (!is_own || node.serial != announced.serial)) {
    const Outcome outcome = take_back(announced);
    if (outcome == Outcome::no_room) return outcome;
  }
  return is_own ? announce(node, announced) : Outcome::nothing;
}

// One that is known in another record is announced from there, or by another gateway.
Announcer::Outcome Announcer::take_back(Announced& announced) {
  const NodeRecord* const node = nodes_.find(announced.serial);
  const bool is_gone = node == nullptr || node->has_asked_to_leave();
  if (is_gone && !send(announced.serial, {})) return Outcome::no_room;
  announced = {};
  return is_gone ? Outcome::sent : Outcome::nothing;
}

Announcer::Outcome Announcer::announce(const NodeRecord& record, Announced& announced) {
  const Serial serial = record.serial;
  const std::string_view name = nodes_.called(record).name;
  collect_readings(serial);
  const std::uint64_t now = shape(name);
  if (announced.serial == serial && announced.shape == now) return Outcome::nothing;
  const AnnouncedNode node{.site = site_,
                           .gateway = gateway_,
                           .serial = serial,
                           .name = name,
                           .has_degrees = has_degrees_,
                           .readings = readings_};
  if (!send(serial, announcement(node, version_))) return Outcome::no_room;
  announced = {.serial = serial, .shape = now};
  return Outcome::sent;
}

// Those that the fleet tells.
void Announcer::collect_readings(Serial serial) {
  readings_.clear();
  for (const PublishedReading& reading : readings_of(snapshot_, serial)) {
    if (readings_.size() == fleet_readings_max) return;
    const Quantity& quantity = snapshot_.quantities[reading.quantity.value];
    if (quantity.name.size() > fleet_text_max || quantity.unit.size() > fleet_text_max) continue;
    readings_.push_back({.name = quantity.name, .unit = quantity.unit});
  }
}

// Never 0.
std::uint64_t Announcer::shape(std::string_view name) const {
  std::uint64_t hash = fnv_begin ^ (has_degrees_ ? 1 : 0);
  mix(hash, name);
  for (const AnnouncedReading& reading : readings_) {
    mix(hash, reading.name);
    mix(hash, reading.unit);
  }
  return std::max<std::uint64_t>(hash, 1);
}

bool Announcer::send(Serial serial, const std::string& payload) {
  const std::string topic = announcement_topic(prefix_, site_, serial);
  return broker_.publish({.topic = topic, .payload = payload, .retained = true}, other_token);
}

}  // namespace etcm::firmware
