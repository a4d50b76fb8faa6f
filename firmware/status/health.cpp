#include "firmware/status/health.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "firmware/alarms/alarm_subject.h"
#include "firmware/alarms/refusal_text.h"
#include "firmware/nodes/faulty_units.h"
#include "firmware/nodes/silence_cause.h"
#include "firmware/status/document.h"
#include "firmware/status/shown_unit.h"

namespace etcm::firmware {

namespace {

std::int64_t whole_seconds(port::Duration duration) {
  return std::chrono::floor<std::chrono::seconds>(duration).count();
}

// Reasons, each on a line of its own.
class Reasons {
 public:
  explicit Reasons(TextWriter& text) : text_(text) {}
  TextWriter& add() { return std::exchange(has_any_, true) ? text_ << "\n" : text_; }
  bool has_any() const { return has_any_; }

 private:
  TextWriter& text_;
  bool has_any_ = false;
};

// The first of those that are silent is named.
void look_at_buses(const StatusSources& sources, port::Instant now, Reasons& reasons) {
  const Poller& poller = sources.gateway.poller();
  const Presence& presence = sources.gateway.presence();
  const SilenceClock& clock = presence.clock();
  const PollSettings& poll = sources.gateway.settings().poll;
  BusIndex first = BusIndex::none();
  std::uint32_t count = 0;
  for (BusIndex bus{0}; bus.value < poller.bus_count(); ++bus.value) {
    if (!presence.is_silent(bus) && clock.silence_of(bus) <= poll.leave_after) continue;
    if (count++ == 0) first = bus;
  }
  if (count == 0) return;
  TextWriter& reason = reasons.add();
  reason << "bus " << bus_label(poller, first) << ": no unit has answered for "
         << whole_seconds(silent_for(sources, first, now)) << " s; "
         << silence_cause(poller, first, now, poll.stale_after);
  if (count > 1) reason << "; and " << count - 1 << " more silent";
}

// The one that has been missing for longest is named.
void look_at_missing(const StatusSources& sources, Reasons& reasons) {
  const NodeRecord* first = nullptr;
  std::uint32_t count = 0;
  for (const NodeRecord& node : sources.gateway.nodes().records()) {
    if (!node.is_missing) continue;
    ++count;
    if (first == nullptr || node.heard_at < first->heard_at) first = &node;
  }
  if (first == nullptr) return;
  const Poller& poller = sources.gateway.poller();
  TextWriter& reason = reasons.add();
  reason << count << (count == 1 ? " node is" : " nodes are")
         << " missing: " << sources.gateway.nodes().called(*first);
  if (!first->last_unit.is_none()) {
    reason << ", unit " << poller.address_of(first->last_unit).value << " of "
           << bus_label(poller, poller.bus_of(first->last_unit));
  }
  if (first->is_foreign()) {
    reason << ", last heard by gateway " << gateway_of(sources.gateway, *first);
  }
  if (count > 1) reason << ", and " << count - 1 << " more";
  if (is_with_its_gateway(sources.gateway, *first)) {
    reason << "; that gateway is gone: " << gone_cure;
  } else {
    TextLine cure;
    write_missing_cure(cure, sources.gateway, *first);
    reason << "; " << cure;
  }
}

// The first of them is named.
void look_at_absent(const StatusSources& sources, Reasons& reasons) {
  const std::span<const AbsentUnit> absent = sources.gateway.absent_units().list();
  if (absent.empty()) return;
  TextWriter& reason = reasons.add();
  reason << sources.gateway.poller().name(absent.front().unit).view() << absent.front().what();
  if (absent.size() > 1) reason << ", and " << absent.size() - 1 << " more";
  reason << "; " << absent_cure;
}

// The first of them is named.
void look_at_faulty(const StatusSources& sources, port::Instant now, Reasons& reasons) {
  const Poller& poller = sources.gateway.poller();
  const port::Duration patience = sources.gateway.settings().poll.leave_after;
  UnitIndex first = UnitIndex::none();
  std::uint32_t count = 0;
  for (UnitIndex unit{0}; unit.value < poller.unit_count(); ++unit.value) {
    if (!faulty_since(poller, unit, sources.started_at, patience, now)) continue;
    if (count++ == 0) first = unit;
  }
  if (count == 0) return;
  const FaultText text = explain_fault(poller, first);
  TextWriter& reason = reasons.add();
  reason << count << (count == 1 ? " unit is" : " units are") << " faulty: " << text.what;
  if (count > 1) reason << ", and " << count - 1 << " more";
  reason << "; " << text.cure;
}

// The first of them is named. One that was acknowledged does stand there.
void look_at_far(const StatusSources& sources, Reasons& reasons) {
  const FarNodeWatch& far = sources.gateway.far_nodes();
  const FarNode* first = nullptr;
  std::uint32_t count = 0;
  for (const FarNode& node : far.list()) {
    if (!node.is_told) continue;
    const Alarm* const alarm = sources.alarms.find_on({AlarmKind::far_node, node.serial.value});
    if (alarm != nullptr && alarm->is_acknowledged) continue;
    if (count++ == 0) first = &node;
  }
  if (first == nullptr) return;
  TextLine text;
  far.explain(*first, sources.gateway.snapshot(), sources.gateway.settings(), text);
  TextWriter& reason = reasons.add();
  reason << text.view();
  if (count > 1) reason << ", and " << count - 1 << " more";
  reason << "; " << far.cure_of(*first);
}

// The first feature or anchor of the site that the mesh has refused is named.
void look_at_refused(const StatusSources& sources, Reasons& reasons) {
  std::optional<RefusalText> first;
  std::uint32_t count = 0;
  for (const QuarantineEntry& entry : sources.gateway.quarantine()) {
    const bool is_of_site = entry.conflict == IdentityConflict::none && entry.serial.is_none();
    if (!is_of_site) continue;
    if (!first) first = refusal_text(sources.gateway, entry);
    ++count;
  }
  if (!first) return;
  TextWriter& reason = reasons.add();
  std::string_view cure = first->cure.view();
  if (cure.ends_with('.')) cure.remove_suffix(1);
  reason << first->what.view();
  if (!cure.empty()) reason << "; " << cure;
  if (count > 1) reason << "; and " << count - 1 << " more of the site refused";
}

// Two of one name: what one of them hears is not told. That of this gateway comes first.
const ReportedMember* taken_name(const FleetReport& fleet) {
  const ReportedMember* named = nullptr;
  for (const ReportedMember& member : fleet.members) {
    if (member.state != MemberState::name_taken) continue;
    if (named == nullptr || member.name == fleet.name) named = &member;
  }
  return named;
}

// The first of those that have another mesh is named.
void look_at_meshes(const FleetReport& fleet, Reasons& reasons) {
  const ReportedMember* first = nullptr;
  std::uint32_t count = 0;
  for (const ReportedMember& member : fleet.members) {
    if (!member.differs || member.why.empty()) continue;
    ++count;
    if (first == nullptr) first = &member;
  }
  if (first == nullptr) return;
  TextWriter& reason = reasons.add();
  reason << "fleet: gateway " << first->name << " has another mesh than this one: " << first->why;
  if (count > 1) reason << "; and " << count - 1 << (count == 2 ? " more differs" : " more differ");
}

// A connection that there is by now may end as those before it have.
void tell_apart(const FleetReport& fleet, port::Instant now, TextWriter& reason) {
  const std::int64_t apart = whole_seconds(time_apart(fleet, now));
  if (!fleet.is_connected) {
    reason << "fleet: no connection to the broker that lasts for " << apart << " s";
  } else {
    reason << "fleet: connected to the broker for "
           << whole_seconds(age_of(fleet.connected_or_not_since, now)) << " s, and "
           << (fleet.has_had_short ? "no connection lasted" : "there was none") << " in the "
           << apart << " s before; this one counts after " << whole_seconds(fleet.lasting) << " s";
  }
  if (fleet.trouble.empty()) return;
  if (fleet.is_connected) {
    reason << (fleet.has_had_short ? "; what ended the last one: " : "; why there was none: ");
  } else {
    reason << "; ";
  }
  reason << fleet.trouble;
}

// A broker that is started again is no trouble.
void look_at_fleet(const StatusSources& sources, port::Instant now, Reasons& reasons) {
  const FleetReport* const fleet = sources.gateway.fleet();
  if (fleet == nullptr) return;
  if (!fleet->site_trouble.empty()) reasons.add() << "fleet: " << fleet->site_trouble;
  if (!fleet->refusal.empty()) {
    reasons.add() << "fleet: " << fleet->refusal;
  } else if (time_apart(*fleet, now) > sources.gateway.settings().poll.leave_after) {
    tell_apart(*fleet, now, reasons.add());
  } else if (taken_name(*fleet) == nullptr) {
    // Where a name is taken others lack what its second gateway hears: no trouble of its own.
    look_at_meshes(*fleet, reasons);
  }
}

void look_at_names(const StatusSources& sources, Reasons& reasons) {
  const FleetReport* const fleet = sources.gateway.fleet();
  if (fleet == nullptr) return;
  const ReportedMember* const named = taken_name(*fleet);
  if (named != nullptr) reasons.add() << "fleet: gateway " << named->name << ": " << named->why;
}

// The first of those that are gone is named.
void look_at_gone(const StatusSources& sources, port::Instant now, Reasons& reasons) {
  const FleetReport* const fleet = sources.gateway.fleet();
  if (fleet == nullptr) return;
  const port::Duration leave_after = sources.gateway.settings().poll.leave_after;
  const ReportedMember* first = nullptr;
  std::uint32_t count = 0;
  for (const ReportedMember& member : fleet->members) {
    if (!is_gone_for_long(*fleet, member, leave_after, now)) continue;
    if (count++ == 0) first = &member;
  }
  if (first == nullptr) return;
  TextWriter& reason = reasons.add();
  reason << "fleet: gateway " << first->name;
  if (first->left_with_broker) reason << not_back << ", and";
  reason << " is gone for " << whole_seconds(age_of(first->since, now)) << " s: " << gone_cure
         << how_to_dismiss(*first) << first->name;
  if (count > 1) reason << "; and " << count - 1 << " more gone";
}

// What a gateway forgets with the next restart is not kept.
void look_at_disks(const StatusSources& sources, Reasons& reasons) {
  const auto look_at = [&](const DiskWriter* disk, std::string_view what) {
    if (disk == nullptr || !disk->is_in_trouble()) return;
    reasons.add() << what << ": " << disk->trouble();
  };
  look_at(sources.gateway.disk_of_state(), "state: it is not saved");
  look_at(sources.disk_of_alarms, "alarms: they are not saved");
  look_at(sources.gateway.disk_of_files(), "files: they cannot be written");
}

}  // namespace

bool is_healthy(const StatusSources& sources, port::Instant now, TextWriter& written) {
  Reasons reasons(written);
  if (!sources.masters.is_listening) {
    reasons.add() << "server: nobody can read the mesh; the log says what is wrong with its port";
  }
  if (sources.refusal != nullptr && !sources.refusal->empty()) reasons.add() << *sources.refusal;
  look_at_buses(sources, now, reasons);
  look_at_names(sources, reasons);
  look_at_gone(sources, now, reasons);
  look_at_missing(sources, reasons);
  look_at_absent(sources, reasons);
  look_at_faulty(sources, now, reasons);
  look_at_far(sources, reasons);
  look_at_refused(sources, reasons);
  look_at_fleet(sources, now, reasons);
  if (sources.gateway.is_late(now, publish_patience)) {
    reasons.add() << "mesh: a change waits to be published; restart the gateway and report it";
  }
  look_at_disks(sources, reasons);
  return !reasons.has_any();
}

}  // namespace etcm::firmware
