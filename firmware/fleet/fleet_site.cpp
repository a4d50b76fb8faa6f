// Which document of the site counts: the greatest that was offered and is good.
#include <algorithm>
#include <utility>

#include "firmware/fleet/fleet_state.h"
#include "firmware/fleet/fleet_topics.h"
#include "firmware/fleet/site_codec.h"

namespace etcm::firmware {

namespace {

constexpr OutKey site_key{.kind = TopicKind::site};

}  // namespace

void FleetMember::State::tell_site(port::Instant now) {
  const bool is_known = site.held && site.version.number > 0 && is_settled;
  if (is_known && site.on_broker < site.version) mark_site(now);
}

// Who has it from its own file says it at once. The others wait whether that one does, and need not
// be allowed to.
void FleetMember::State::mark_site(port::Instant now) {
  // Some brokers hang up after a message that they refuse: then each try would take the nodes of
  // this gateway from the others.
  if (site.denied == site.version) return;
  out.mark(site_key, is_site_of_here() ? now : now + settings.period / 2);
}

// REQUIRES: one holds.
bool FleetMember::State::is_site_of_here() const {
  return site.held->gateway == settings.gateway ||
         (site.own && site.own->version().hash == site.version.hash);
}

// Whoever had it in a file, from now on it is the fleet's.
void FleetMember::State::note_site_taken() {
  site.trouble.clear();
  site.unsound.clear();
  site.passed_over.reset();
  if (!std::exchange(site.is_fleets, true)) has_news_to_save = true;
}

void FleetMember::State::note_site_delivered(std::uint64_t hash) {
  if (site.held && payload_hash(encode_site(*site.held)) == hash) note_site_taken();
}

// Those who only pass another's on need no right to.
void FleetMember::State::note_site_refused() {
  site.denied = site.version;
  if (!site.held || !site.own || site.held->gateway != settings.gateway) return;
  site.trouble =
      "the broker does not let this gateway tell its site: the others do not have it; take the "
      "site out here, or add `topic readwrite etcm/v1/" +
      settings.site + "/site` under `user " + settings.gateway +
      "` in etcm.acl, reload the broker and then this gateway";
  log.write(port::Level::error, "fleet: " + site.trouble);
}

void FleetMember::State::hold_site(SiteDocument document, bool is_fleets, port::Instant now) {
  if (is_fleets) {
    site.passed_over.reset();
  } else if (site.held && site.is_fleets) {
    site.passed_over = std::move(site.held);
  }
  site.is_fleets = is_fleets;
  site.held = std::move(document);
  site.version = site.held->version();
  site.refused.reset();
  site.trouble.clear();
  has_news_to_save = true;
  mark_header();
  tell_site(now);
}

// It was never the fleet's; what is, holds again.
void FleetMember::State::drop_site(port::Instant now) {
  site.dropped_number = std::max(site.dropped_number, site.version.number);
  site.held.reset();
  site.version = {};
  out.unmark(site_key);
  has_news_to_save = true;
  mark_header();
  std::optional<SiteDocument> fleets = std::exchange(site.passed_over, std::nullopt);
  if (fleets) consider_site(std::move(*fleets), now);
}

// Before it is known what the broker has, it is less than all; what an earlier run has taken out
// says nothing of that.
void FleetMember::State::hold_own_site(port::Instant now) {
  const std::uint32_t refused = site.refused ? site.refused->number : 0;
  const std::uint32_t there = std::max({site.version.number, site.on_broker.number, refused});
  const bool is_known = is_settled || there > 0 || (site.is_settled && site.dropped_number > 0);
  const std::uint32_t greatest = std::max(there, site.dropped_number);
  SiteDocument document = *site.own;
  document.number = is_known ? std::min(fleet_number_max - 1, greatest) + 1 : 0;
  hold_site(std::move(document), false, now);
}

void FleetMember::State::settle_site(port::Instant now) {
  site.is_settled = true;
  const bool is_alone = site.on_broker.number == 0 && !site.refused;
  if (site.held && site.version.number == 0 && is_alone) return hold_own_site(now);
  tell_site(now);
}

void FleetMember::State::consider_site(SiteDocument document, port::Instant now) {
  const SiteVersion version = document.version();
  if (site.refused && version == site.refused->version()) return;
  if (version <= site.version) {
    if (!site.is_fleets && version != site.version) site.passed_over = std::move(document);
    return;
  }
  const bool is_other_of_here =
      site.own && document.gateway == settings.gateway && version.hash != site.own->version().hash;
  // Later a greater one is of a second program with this name, and the two would go on for ever.
  // One of the same number may be of an earlier run that was not saved; to answer that ends, for
  // then the numbers differ.
  const bool is_tie =
      site.held && site.held->gateway == settings.gateway && document.number == site.version.number;
  if (is_other_of_here && (!site.is_settled || is_tie)) {
    site.version.number = document.number;
    hold_own_site(now);
    site.passed_over = std::move(document);
    return;
  }
  const std::string refusal = listener.on_site(document, now);
  if (refusal.empty()) return hold_site(std::move(document), true, now);
  site.trouble = document.name() + " is refused: " + refusal;
  log.write(port::Level::error,
            "fleet: " + site.trouble +
                (site.held ? "; the old one stays" : "; until then this gateway has no site"));
  site.refused = std::move(document);
  mark_header();
}

// Nobody says whether the broker still has it.
void FleetMember::State::forget_unsound_site(port::Instant now) {
  if (now - site.unsound_at >= settings.report_max) site.unsound.clear();
}

void FleetMember::State::take_site(std::string_view payload, port::Instant now) {
  site.on_broker = {};
  site.unsound.clear();
  if (payload.empty()) return tell_site(now);
  std::string wrong;
  auto document = decode_site(payload, wrong);
  if (document && document->number > std::uint64_t{site.version.number} + site_leap_max) {
    wrong = "number is far beyond the last one";
    document.reset();
  }
  if (!document) {
    ++rejected_count;
    const std::string topic = topic_text(settings.site, {.kind = TopicKind::site});
    const bool holds = site.version.number > 0;
    site.unsound = "the site on the broker is not sound: " + wrong +
                   (holds ? "; the old one stays" : "") + "; look who may write " + topic +
                   (holds ? "" : ", and empty it: mosquitto_pub -r -n -t " + topic);
    site.unsound_at = now;
    if (holds) out.mark(site_key, now + settings.report_min);
    log.write(port::Level::error, "fleet: " + site.unsound);
    return;
  }
  site.on_broker = document->version();
  if (site.on_broker >= site.version) out.unmark(site_key);
  if (site.on_broker == site.version) note_site_taken();
  tell_site(now);
  consider_site(std::move(*document), now);
}

void FleetMember::set_site(SiteDocument own, bool is_changed, port::Instant now) {
  State& state = *state_;
  own.gateway = state.settings.gateway;
  state.site.own = std::move(own);
  const std::optional<SiteDocument>& held = state.site.held;
  const bool is_same = held && state.site.own->version().hash == state.site.version.hash;
  if (is_same) return;
  const bool was_own = held && (!state.site.is_fleets || held->gateway == state.settings.gateway);
  if (!held || is_changed || was_own) state.hold_own_site(now);
}

void FleetMember::clear_site(port::Instant now) {
  State::Site& site = state_->site;
  site.own.reset();
  if (site.denied) site.trouble.clear();
  if (site.held && !site.is_fleets) state_->drop_site(now);
}

void FleetMember::retry_site(port::Instant now) {
  if (std::exchange(state_->site.denied, std::nullopt)) state_->tell_site(now);
  std::optional<SiteDocument> refused = std::exchange(state_->site.refused, std::nullopt);
  if (!refused) return;
  state_->site.trouble.clear();
  state_->consider_site(std::move(*refused), now);
}

const SiteDocument* FleetMember::site() const {
  const std::optional<SiteDocument>& held = state_->site.held;
  return held ? &*held : nullptr;
}

SiteVersion FleetMember::site_version() const { return state_->site.version; }

}  // namespace etcm::firmware
