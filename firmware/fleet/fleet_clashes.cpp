// Which serials two gateways hear at the same time in two places.
//
// The one that hears a node which another speaks for sees both places, and tells the owner. It is
// no moving node, nor one that two receivers hear: where its owner said that it is, it would have
// been here too about that time. And it is none that has just gone from one to the other: the owner
// would have lost it by then.
#include "firmware/fleet/fleet_clashes.h"

#include <algorithm>
#include <utility>

#include "firmware/fleet/fleet_state.h"
#include "firmware/fleet/json_fields.h"
#include "firmware/fleet/json_text.h"

namespace etcm::firmware {

namespace {

constexpr std::uint32_t answers_wanted = 3;
constexpr OutKey clashes_key{.kind = TopicKind::clashes};

}  // namespace

std::string encode_clashes(const std::vector<ToldClash>& clashes) {
  if (clashes.empty()) return {};
  JsonText json;
  json.object().key("clashes").array();
  for (const ToldClash& clash : clashes) {
    json.object().key("serial").number(clash.serial.value).key("owner").text(clash.owner);
    json.key("x").number(clash.position.x).key("y").number(clash.position.y).end();
  }
  return json.end().end().take();
}

bool decode_clashes(std::string_view payload, std::vector<ToldClash>& clashes, std::string& wrong) {
  clashes.clear();
  if (payload.empty()) return true;
  const std::optional<files::JsonValue> json = parse_message(payload, wrong);
  if (!json) return false;
  JsonFields fields(*json);
  const files::JsonValue* const list = fields.list("clashes", clashes_max);
  for (std::size_t i = 0; list != nullptr && i < list->items.size(); ++i) {
    JsonFields item(list->items[i], "clashes/" + std::to_string(i) + "/");
    ToldClash clash;
    clash.serial = Serial{item.number("serial", Serial::none_value - 1)};
    clash.owner = item.text("owner", fleet_name_max);
    clash.position.x = item.signed_number("x", position_max);
    clash.position.y = item.signed_number("y", position_max);
    if (item.is_sound() && !is_fleet_name(clash.owner)) item.reject("owner", "is no name");
    if (!item.is_sound()) {
      wrong = item.wrong();
      clashes.clear();
      return false;
    }
    clashes.push_back(std::move(clash));
  }
  wrong = fields.wrong();
  return fields.is_sound();
}

void PlaceBox::add(Position place) {
  const bool is_first = count_++ == 0;
  x_min_ = is_first ? place.x : std::min<std::int64_t>(x_min_, place.x);
  x_max_ = is_first ? place.x : std::max<std::int64_t>(x_max_, place.x);
  y_min_ = is_first ? place.y : std::min<std::int64_t>(y_min_, place.y);
  y_max_ = is_first ? place.y : std::max<std::int64_t>(y_max_, place.y);
}

void PlaceBox::add(const PlaceBox& other) {
  if (other.count_ == 0) return;
  const auto corner = [](std::int64_t x, std::int64_t y) {
    return Position{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
  };
  const std::uint32_t count = count_ + other.count_;
  add(corner(other.x_min_, other.y_min_));
  add(corner(other.x_max_, other.y_max_));
  count_ = count;
}

bool PlaceBox::is_far_from(Position place, std::int64_t apart_min) const {
  if (count_ == 0) return false;
  const std::int64_t x = std::max({x_min_ - place.x, place.x - x_max_, std::int64_t{0}});
  const std::int64_t y = std::max({y_min_ - place.y, place.y - y_max_, std::int64_t{0}});
  return std::max(x, y) > std::max(apart_min, std::max(x_max_ - x_min_, y_max_ - y_min_));
}

// The record of who speaks for the node, where that is another one that hears it now; or null.
const MergedNode* FleetMember::State::heard_elsewhere(Serial serial) const {
  const MergedNode* const known = merged.find(serial);
  if (known == nullptr || is_read_only) return nullptr;
  const FleetRecord& record = *known->record;
  const bool is_heard = !record.has_left() && record.is_heard && record.node.position &&
                        record.owner != settings.gateway;
  const auto owner = peers.find(record.owner);
  const bool is_there = owner != peers.end() && owner->second.state == PeerState::online;
  return is_heard && is_there ? known : nullptr;
}

void FleetMember::State::watch_place(const LocalNode& here, port::Instant now) {
  const Serial serial = here.node.serial;
  const MergedNode* const known = heard_elsewhere(serial);
  if (known == nullptr || !here.node.position) {
    apart.erase(serial);
    return;
  }
  HeardApart& heard = apart[serial];
  // A box is of two answers at least: between them the node may have been anywhere on its way.
  if (heard.record_at != known->received_at && heard.since.count() != 1) {
    heard.record_at = known->received_at;
    heard.before = std::exchange(heard.since, PlaceBox{});
  }
  heard.since.add(*here.node.position);
  PlaceBox box = heard.before;
  box.add(heard.since);
  if (!box.is_far_from(*known->record->node.position, settings.apart_min)) {
    heard.count = 0;
    return;
  }
  if (heard.count++ == 0) heard.apart_since = now;
  heard.apart_at = now;
  heard.is_clash = heard.is_clash || (heard.count >= answers_wanted &&
                                      now - heard.apart_since >= settings.apart_after);
  heard.place = *here.node.position;
}

// What this one hears beside the owner, for the owner.
void FleetMember::State::tell_clashes(port::Instant now) {
  std::vector<ToldClash> told;
  for (auto at = apart.begin(); at != apart.end();) {
    const auto& [serial, heard] = *at;
    const auto here = local.find(serial);
    const MergedNode* const known = heard_elsewhere(serial);
    const bool is_over = here == local.end() || !here->second.is_heard || known == nullptr ||
                         (heard.is_clash && now - heard.apart_at >= settings.silent_after);
    if (is_over) {
      at = apart.erase(at);
      continue;
    }
    if (heard.is_clash && told.size() < clashes_max) {
      // Where it was when that was told first, while it is about there.
      const auto same =
          std::find_if(told_clashes.begin(), told_clashes.end(), [&](const auto& each) {
            return each.serial == at->first && each.owner == known->record->owner;
          });
      PlaceBox before;
      if (same != told_clashes.end()) before.add(same->position);
      const bool has_moved =
          before.count() == 0 || before.is_far_from(heard.place, settings.apart_min);
      told.push_back({.serial = serial,
                      .owner = known->record->owner,
                      .position = has_moved ? heard.place : same->position});
    }
    ++at;
  }
  if (told == told_clashes) return;
  told_clashes = std::move(told);
  out.mark(clashes_key, now);
}

void FleetMember::State::note_clash(FleetClash clash, port::Instant now) {
  Clash& known = clashes[{clash.serial, clash.gateway}];
  const bool is_new = known.seen_at == port::Instant{};
  if (is_new || known.clash.is_owner != clash.is_owner) has_clash_news = true;
  clash.since = is_new ? now : known.clash.since;
  known = {.clash = std::move(clash), .seen_at = now};
}

// Where the owner hears it that another one tells of, if that one speaks for it.
std::optional<Position> FleetMember::State::place_at(const ToldClash& told) const {
  const MergedNode* const known = std::as_const(merged).find(told.serial);
  if (known == nullptr || known->record->has_left()) return std::nullopt;
  if (told.owner != settings.gateway) {
    const MergedNode* const there = heard_elsewhere(told.serial);
    const bool is_so = there != nullptr && there->record->owner == told.owner;
    return is_so ? there->record->node.position : std::nullopt;
  }
  const auto here = local.find(told.serial);
  const bool is_heard = here != local.end() && here->second.is_heard && owns(*known->record);
  return is_heard ? here->second.node.position : std::nullopt;
}

void FleetMember::State::find_clashes(port::Instant now) {
  tell_clashes(now);
  for (const ToldClash& told : told_clashes) {
    const MergedNode* const known = merged.find(told.serial);
    note_clash({.serial = told.serial,
                .gateway = told.owner,
                .here = told.position,
                .there = *known->record->node.position},
               now);
  }
  for (const auto& [name, peer] : peers) {
    if (peer.state != PeerState::online) continue;
    for (const ToldClash& told : peer.clashes) {
      const std::optional<Position> place = place_at(told);
      if (!place || clashes.size() >= 2 * clashes_max) continue;
      note_clash({.serial = told.serial,
                  .gateway = name,
                  .of = told.owner == settings.gateway ? std::string() : told.owner,
                  .here = *place,
                  .there = told.position,
                  .is_owner = true},
                 now);
    }
  }
  // A connection that is cut for a moment, or the other one being the owner now, is no end of it.
  if (is_connected && !is_settled) return;
  const std::size_t gone = std::erase_if(clashes, [&](const auto& each) {
    return now - each.second.seen_at >= 2 * settings.apart_after;
  });
  if (gone > 0) has_clash_news = true;
}

// The list of another one, in place of the one before. What it takes back of a node that this one
// speaks for is over.
void FleetMember::State::take_clashes(Peer& peer, std::vector<ToldClash> told) {
  for (const ToldClash& before : std::exchange(peer.clashes, std::move(told))) {
    const auto is_same = [&](const ToldClash& each) { return each.serial == before.serial; };
    if (std::any_of(peer.clashes.begin(), peer.clashes.end(), is_same)) continue;
    const MergedNode* const known = merged.find(before.serial);
    if (known == nullptr || !owns(*known->record)) continue;
    has_clash_news = clashes.erase({before.serial, peer.name}) > 0 || has_clash_news;
  }
}

void FleetMember::end_clash(Serial serial, port::Instant now) {
  State& state = *state_;
  const std::size_t ended =
      std::erase_if(state.clashes, [&](const auto& each) { return each.first.first == serial; });
  if (ended == 0) return;
  state.has_clash_news = true;
  state.apart.erase(serial);
  lose(serial, now);
  state.tell_clashes(now);
}

std::vector<FleetClash> FleetMember::clashes() const {
  std::vector<FleetClash> clashes;
  for (const auto& [key, each] : state_->clashes) clashes.push_back(each.clash);
  return clashes;
}

bool FleetMember::take_clash_news() { return std::exchange(state_->has_clash_news, false); }

void FleetMember::set_apart_min(std::int64_t units) { state_->settings.apart_min = units; }

}  // namespace etcm::firmware
