// Other programs that go by the name of this gateway: earlier runs of it, which are dead, and
// twins, which are not. A twin is known by what no dead run can say: a header that tells of this
// run. That its beat goes on says nothing: what a dead run had sent may come at any time, where a
// bridge between brokers was down.
// Of twins the one that was there first goes on: each run is later than all that the broker knew
// of before it spoke. Those that began together go by their numbers.
#include <algorithm>
#include <tuple>

#include "firmware/fleet/fleet_state.h"
#include "firmware/fleet/json_text.h"

namespace etcm::firmware {

OtherRun& FleetMember::State::other_run(const FleetRun& run, bool& is_new) {
  const auto known = std::find_if(other_runs.begin(), other_runs.end(), [&](const OtherRun& each) {
    return each.run.instance == run.instance && each.run.epoch != 0;
  });
  is_new = known == other_runs.end();
  if (!is_new) return *known;
  // In place of the one that has been dead for the longest.
  OtherRun& oldest =
      *std::min_element(other_runs.begin(), other_runs.end(),
                        [](const auto& a, const auto& b) { return a.alive_until < b.alive_until; });
  oldest = {.run = run};
  oldest.run.epoch = std::max(oldest.run.epoch, std::uint32_t{1});
  return oldest;
}

// Dead or alive, that run was there before this one.
void FleetMember::State::note_arrival(const FleetRun& run) {
  if (has_arrived || run.instance == settings.instance) return;
  const std::uint32_t after = std::min(run.arrival, fleet_number_max - 1) + 1;
  if (after <= header.run.arrival) return;
  header.run.arrival = after;
  // What others have been told of this run is not so any more.
  next_conflict = {};
}

void FleetMember::State::take_other_header(const FleetHeader& theirs, port::Instant now) {
  const FleetRun& run = theirs.run;
  bool is_new = false;
  OtherRun& other = other_run(run, is_new);
  const bool goes_on = std::tuple(run.epoch, theirs.beat) > std::tuple(other.run.epoch, other.beat);
  const bool is_quiet = other.last_seen_at == port::Instant{};
  other.run.epoch = std::max(run.epoch, std::uint32_t{1});
  other.run.arrival = run.arrival;
  other.beat = theirs.beat;
  other.last_seen_at = now;
  // It is to know at once that it is not alone; one that has not spoken yet asks first.
  if (is_quiet && has_arrived) out.mark({.kind = TopicKind::header}, now);
  if (is_new && !has_arrived) asks_for_other = true;
  const bool is_alive =
      theirs.other_instance == settings.instance || (goes_on && other.alive_until > now);
  if (is_alive) note_alive(other, now);
}

void FleetMember::State::take_conflict(const FleetRun& run, port::Instant now) {
  bool is_new = false;
  OtherRun& other = other_run(run, is_new);
  const bool is_quiet = other.last_seen_at == port::Instant{};
  other.run.arrival = run.arrival;
  other.last_seen_at = now;
  if (is_quiet && has_arrived) out.mark({.kind = TopicKind::header}, now);
  note_alive(other, now);
}

void FleetMember::State::note_alive(OtherRun& other, port::Instant now) {
  other.alive_until = now + settings.silent_after;
  judge_twins(now);
}

// Its connection has ended, or one that it had before: then it is heard of soon.
void FleetMember::State::note_end(const FleetRun& run, port::Instant now) {
  for (OtherRun& other : other_runs) {
    if (other.run.epoch == 0 || other.run.instance != run.instance) continue;
    other.last_seen_at = {};
    other.alive_until = std::min(other.alive_until, now + settings.period / 2);
  }
}

// The one that was seen last: a header that tells of it proves to it that this run lives.
std::uint64_t FleetMember::State::other_instance(port::Instant now) const {
  const OtherRun& last = *std::max_element(
      other_runs.begin(), other_runs.end(),
      [](const auto& a, const auto& b) { return a.last_seen_at < b.last_seen_at; });
  const bool is_seen =
      last.last_seen_at != port::Instant{} && now - last.last_seen_at < settings.silent_after;
  return is_seen ? last.run.instance : 0;
}

// A total order, the same to all: so of any number of twins one goes on.
bool FleetMember::State::outranks(const FleetRun& other) const {
  if (other.arrival != header.run.arrival) return other.arrival < header.run.arrival;
  return other.instance > settings.instance;
}

void FleetMember::State::judge_twins(port::Instant now) {
  bool is_any = false;
  bool is_outranked = false;
  for (const OtherRun& other : other_runs) {
    if (other.alive_until <= now) continue;
    is_any = true;
    is_outranked = is_outranked || outranks(other.run);
  }
  if (is_any == has_conflict && is_outranked == is_read_only) return;
  const bool may_speak_again = is_read_only && !is_outranked;
  has_conflict = is_any;
  is_read_only = is_outranked;
  const std::string begin = "gateway " + settings.gateway + " of the fleet: ";
  if (!is_any) {
    log.write(port::Level::info, begin + "no other gateway uses its name any more");
  } else {
    log.write(port::Level::error,
              begin + "another gateway uses this name of [mqtt] too; give each its own. " +
                  (is_outranked ? "This one tells nothing until then"
                                : "The other one tells nothing until then"));
  }
  listener.on_name_conflict(is_any, is_outranked, now);
  mark_header();
  if (is_outranked) {
    // What was held is the other one's to hold.
    held.clear();
    neighbours.clear();
    out.forget_nodes(now);
  }
  if (may_speak_again && is_settled) {
    settle(now);
    return;
  }
  std::vector<Serial> heard;
  for (const auto& [serial, node] : local) heard.push_back(serial);
  for (const Serial serial : heard) reconcile(serial, now);
}

}  // namespace etcm::firmware
