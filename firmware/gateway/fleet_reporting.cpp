// What the list of gateways says.
#include <algorithm>
#include <string>
#include <utility>

#include "firmware/gateway/fleet_difference.h"
#include "firmware/gateway/fleet_link.h"
#include "firmware/logging/text_line.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

constexpr port::Duration report_pause = 500ms;
// What a member has on the broker is here long before that.
constexpr port::Duration set_time_max = 60s;
// A connection that has stood so long is one; and so long, where those before it ended sooner.
constexpr port::Duration lasting = 10s;
// A gateway that went so long ago, and without which nothing is missing, does not come back.
constexpr port::Duration gone_for_good = 24h;
constexpr port::Duration lasting_after_short = 60s;
constexpr std::uint32_t short_connections_max = 1;

bool has_left(const PeerReport& peer) {
  return peer.state == PeerState::offline || peer.state == PeerState::silent;
}

constexpr const char* two_of_one_name =
    "two gateways use this name; give each its own `name` in [mqtt]";

// Of this gateway. Most often one of the two was set up as a copy of the other.
constexpr const char* silent_twin =
    "this gateway is silent, and the others know nothing of what it hears: another one, which was "
    "there first, uses its name too; give this one a `name` of its own in [mqtt], and restart it";
constexpr const char* speaking_twin =
    "another gateway uses this name too, and tells nothing of what it hears until it has one of "
    "its own; give it its own `name` in [mqtt]";

constexpr std::string_view lack_of_room =
    "there is no room here for all nodes of the site; raise vertices_max in [mesh] of this "
    "gateway, and start it again";

// What is wrong with another member, for a person. `differs`: it has another mesh for good.
std::string why_of(const PeerReport& peer, const OwnStand& own, bool differs,
                   port::Instant connected_since, port::Instant now) {
  if (!peer.quarantine.empty() || peer.state != PeerState::online) return peer.quarantine;
  if (peer.has_name_conflict) return two_of_one_name;
  if (peer.is_complete) return differs ? difference_of(peer, own) : std::string();
  if (!own.lack.empty()) return std::string(own.lack);
  if (now - std::max(peer.since, connected_since) < set_time_max) return {};
  return "not all of its nodes have come; the broker must not drop what it has kept (Mosquitto: "
         "max_queued_messages 0)";
}

}  // namespace

MemberState FleetLink::shown_state(const PeerReport& peer, const FleetStatus& status,
                                   port::Instant now) const {
  if (!peer.quarantine.empty()) return MemberState::rejected;
  if (!status.is_connected) return MemberState::unknown;
  if (peer.has_name_conflict) return MemberState::name_taken;
  if (may_come_back(peer, status, now)) return MemberState::unknown;
  if (has_left(peer)) return MemberState::gone;
  const bool is_here = peer.state == PeerState::online && peer.is_complete;
  return is_here ? MemberState::here : MemberState::waiting;
}

// A broker that is ended tells the last wills of some to others, just before these lose it too.
bool FleetLink::has_left_with_broker(const PeerReport& peer) const {
  return has_left(peer) && !peer.is_back && away_since_ && peer.since >= *away_since_ - gone_grace;
}

// One that begins may do so together with its broker, and does not know since when another is gone.
bool FleetLink::may_come_back(const PeerReport& peer, const FleetStatus& status,
                              port::Instant now) const {
  const bool went_long_before = away_since_ && peer.since < *away_since_ - gone_grace;
  return has_left(peer) && !peer.is_back && !went_long_before && now - status.since < return_time;
}

void FleetLink::make_report(port::Instant now) {
  report_due_ = now + report_pause;
  const FleetStatus status = member_.status();
  const FleetAgreement agreement = member_.agreement();
  note_apart(status, now);
  report_.is_connected = status.is_connected;
  report_.is_settled = status.is_connected && status.is_settled;
  report_.is_silent = status.is_read_only;
  report_.is_told = report_.is_settled && status.is_header_taken;
  report_.has_told_all = report_.is_told && status.has_told_all;
  report_.other_refused_count = status.other_refused_count;
  report_.is_site_known = report_.is_settled && status.is_site_known;
  report_.connected_or_not_since = status.since;
  note_refusal(status, now);
  report_.broker = broker_.counters();
  report_.agreeing = status.is_connected ? agreement.agreeing : 1;
  const SiteDocument* const site = member_.site();
  report_.site_number = status.site.number;
  report_.site_gateway = site == nullptr ? "" : site->gateway;
  report_.site_trouble = site_.find_trouble(member_, status);
  report_.members.clear();
  report_.members.push_back(own_row(status));
  const OwnStand own = own_stand(status);
  if (!status.is_connected) differences_.end_all();
  for (const PeerReport& peer : member_.peers()) {
    const bool is_other = std::find(agreement.differing.begin(), agreement.differing.end(),
                                    peer.name) != agreement.differing.end();
    const bool agrees = status.is_connected && peer.state == PeerState::online && !is_other;
    tell_presence(peer, status, now);
    tell_twin(peer);
    report_.members.push_back(peer_row(peer, own, status, agrees, now));
    tell_difference(report_.members.back());
  }
  std::sort(report_.members.begin(), report_.members.end(),
            [](const ReportedMember& a, const ReportedMember& b) { return a.name < b.name; });
}

// After a moment, for a gateway that starts again is back in less. Where this gateway is apart
// itself, or was, it knows nothing of the others yet.
void FleetLink::tell_presence(const PeerReport& peer, const FleetStatus& status,
                              port::Instant now) {
  const bool is_here = peer.state == PeerState::online;
  const bool is_sure =
      status.is_connected && std::min(now - status.since, now - peer.since) >= gone_grace;
  if (peer.state == PeerState::unknown || (!is_here && !is_sure)) return;
  if (may_come_back(peer, status, now)) return;
  const auto [known, is_new] = here_.try_emplace(peer.name, is_here);
  if (is_new || std::exchange(known->second, is_here) == is_here) return;
  if (is_here) {
    log_.write(port::Level::info, TextLine() << "gateway " << peer.name << " is here again");
    return;
  }
  if (has_left_with_broker(peer)) {
    log_.write(port::Level::warning,
               TextLine() << "gateway " << peer.name << not_back << "; " << gone_cure);
    return;
  }
  log_.write(port::Level::warning,
             TextLine() << "gateway " << peer.name << " is gone: "
                        << (peer.state == PeerState::offline ? "its connection to the broker ended"
                                                             : "nothing comes of it any more")
                        << "; " << gone_cure);
}

void FleetLink::tell_twin(const PeerReport& peer) {
  if (!peer.has_name_conflict) {
    doubled_.erase(peer.name);
  } else if (doubled_.insert(peer.name).second) {
    log_.write(port::Level::warning, TextLine()
                                         << "gateway " << peer.name << ": " << two_of_one_name
                                         << "; one of them tells nothing until then");
  }
}

// As soon as the list says why. Who is gone meanwhile, or differs in something else, has not come
// to agree.
void FleetLink::tell_difference(const ReportedMember& row) {
  if (row.state != MemberState::here) return;
  if (row.agrees) {
    if (differing_.erase(row.name) == 0) return;
    log_.write(port::Level::info, TextLine() << "gateway " << row.name << " agrees again");
  } else if (row.differs && !row.why.empty() && differing_.insert(row.name).second) {
    log_.write(port::Level::warning, TextLine() << "gateway " << row.name
                                                << " has another mesh than this one: " << row.why);
  }
}

bool FleetLink::is_gone(std::string_view gateway) const {
  return std::any_of(report_.members.begin(), report_.members.end(),
                     [&](const auto& member) { return member.name == gateway && member.has_left; });
}

// Another one says of them that they have left, all of it connected.
std::optional<port::Duration> FleetLink::nodes_leave_in(std::string_view gateway,
                                                        port::Instant now) const {
  const FleetStatus status = member_.status();
  for (const PeerReport& peer : member_.peers()) {
    if (peer.name != gateway || !has_left(peer) || peer.node_count == 0) continue;
    const port::Instant from = status.is_connected ? std::max(peer.since, status.since) : now;
    const port::Duration wait = peer.is_back ? leave_after_ : std::max(leave_after_, return_time);
    return std::max<port::Duration>(from + wait - now, {});
  }
  return std::nullopt;
}

bool FleetLink::is_dismissed(const PeerReport& peer, const char* why) {
  if (peer.state == PeerState::online || peer.node_count > 0) return false;
  if (!member_.dismiss(peer.name)) return false;
  differing_.erase(peer.name);
  log_.write(port::Level::info,
             TextLine() << "gateway " << peer.name << " is no longer in the list: " << why);
  report_due_ = {};
  return true;
}

bool FleetLink::dismiss_gone(std::string_view gateway, port::Instant now) {
  bool is_done = false;
  for (const PeerReport& peer : member_.peers()) {
    is_done = is_done || (peer.name == gateway && is_dismissed(peer, "dismissed"));
  }
  if (is_done) make_report(now);
  return is_done;
}

std::uint32_t FleetLink::dismiss_gone(port::Instant now) {
  std::uint32_t count = 0;
  for (const PeerReport& peer : member_.peers()) count += is_dismissed(peer, "dismissed") ? 1 : 0;
  if (count > 0) make_report(now);
  return count;
}

void FleetLink::dismiss_long_gone(port::Instant now) {
  for (const PeerReport& peer : member_.peers()) {
    if (now - peer.since < gone_for_good || misses_nodes_of(peer.name)) continue;
    static_cast<void>(is_dismissed(peer, "gone for a day, and none of its nodes is left"));
  }
}

bool FleetLink::misses_nodes_of(const std::string& gateway) const {
  return std::any_of(nodes_.records().begin(), nodes_.records().end(), [&](const auto& node) {
    return node.is_missing && node.is_foreign() && gateways_[node.owner.value] == gateway;
  });
}

void FleetLink::note_apart(const FleetStatus& status, port::Instant now) {
  const bool has_ended = connected_at_ && !(status.is_connected && status.since == *connected_at_);
  if (has_ended) {
    const bool was_short = status.since - *connected_at_ < lasting_after_short;
    short_connections_ = was_short ? short_connections_ + 1 : 0;
    const bool were_all_back = status.since - *connected_at_ >= return_time;
    if (!away_since_ || were_all_back) away_since_ = status.since;
    connected_at_.reset();
  }
  // One may come and go between two reports.
  const bool has_passed = !report_.is_connected && !status.is_connected &&
                          status.since != report_.connected_or_not_since;
  if (report_.apart_since && (has_ended || has_passed)) report_.has_had_short = true;
  if (status.is_connected) connected_at_ = status.since;
  const port::Duration stood =
      short_connections_ > short_connections_max ? lasting_after_short : lasting;
  report_.lasting = stood;
  if (status.is_connected && now - status.since >= stood) {
    if (stood == lasting_after_short) short_connections_ = 0;
    report_.apart_since.reset();
    report_.has_had_short = false;
    report_.trouble.clear();
    return;
  }
  if (!report_.apart_since) report_.apart_since = status.since;
  const std::string_view why = broker_.why_down();
  if (!why.empty()) report_.trouble = why;
}

void FleetLink::note_refusal(const FleetStatus& status, port::Instant now) {
  report_.refusal.clear();
  // Some brokers hang up after a refusal, again and again.
  const bool has_just_ended = !status.is_connected && now - status.since < port::broker_pause_max;
  if (!status.is_refused || !(status.is_connected || has_just_ended)) return;
  // Those that are only remembered may be of another site.
  std::string others;
  for (const PeerReport& peer : member_.peers()) {
    if (peer.state == PeerState::online) others += (others.empty() ? "" : ", ") + peer.name;
  }
  const std::string allow =
      "allow it to write etcm/v1/" + report_.site + "/" + report_.name + "/# there";
  report_.refusal =
      "the broker does not let this gateway tell what it hears, so the others know nothing of "
      "it; " +
      (others.empty() ? "correct `site` in [mqtt], for nobody else is heard at site '" +
                            report_.site + "', or " + allow
                      : "correct `name`, and its user, key or certificate, in [mqtt], or " + allow +
                            "; at site '" + report_.site + "' it hears " + others);
}

ReportedMember FleetLink::peer_row(const PeerReport& peer, const OwnStand& own,
                                   const FleetStatus& status, bool agrees, port::Instant now) {
  const bool can_tell = status.is_connected && peer.state == PeerState::online;
  if (agrees || !can_tell) differences_.end(peer.name);
  const bool differs = !agrees && can_tell && differences_.last(peer, own, now);
  const bool left_with_broker = has_left_with_broker(peer);
  port::Instant since = left_with_broker ? *away_since_ : peer.since;
  if (!status.is_connected) since = status.since;
  return {.name = peer.name,
          .state = shown_state(peer, status, now),
          .since = since,
          .node_count = peer.node_count,
          .generation = peer.generation,
          .mesh_hash = can_tell ? std::optional(peer.mesh_hash) : std::nullopt,
          .agrees = agrees,
          .is_proven = peer.is_proven,
          .version = peer.version,
          .differs = differs,
          .why = !status.is_connected || (agrees && peer.is_complete && !peer.has_name_conflict)
                     ? peer.quarantine
                     : why_of(peer, own, differs, status.since, now),
          .has_left = has_left(peer),
          .left_with_broker = left_with_broker};
}

OwnStand FleetLink::own_stand(const FleetStatus& status) const {
  OwnStand own{.is_shared = is_shared_,
               .known_count = status.node_count,
               .known_hash = status.merged_hash,
               .mesh_hash = mesh_hash_,
               .mesh_nodes = mesh_nodes_,
               .site = status.site,
               .site_trouble = report_.site_trouble,
               .is_site_refused = status.is_site_refused,
               .version = version_,
               .lack = mesh_lack_};
  if (is_full_ || status.lacks_room) own.lack = lack_of_room;
  return own;
}

ReportedMember FleetLink::own_row(const FleetStatus& status) const {
  std::string why;
  if (status.has_name_conflict) {
    why = status.is_read_only ? silent_twin : speaking_twin;
  } else if (!report_.refusal.empty()) {
    why = report_.refusal;
  } else if (is_full_ || status.lacks_room) {
    why = lack_of_room;
  }
  return {.name = report_.name,
          .state = status.has_name_conflict ? MemberState::name_taken : MemberState::here,
          .since = status.since,
          .node_count = status.own_count,
          .generation = own_generation_,
          .mesh_hash = mesh_hash_,
          .agrees = true,
          .is_proven = true,
          .version = version_,
          .why = std::move(why)};
}

}  // namespace etcm::firmware
