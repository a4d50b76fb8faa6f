#include "firmware/alarms/alarm_watch.h"

#include <algorithm>
#include <utility>

#include "firmware/alarms/alarm_subject.h"
#include "firmware/alarms/refusal_text.h"
#include "firmware/logging/text_line.h"
#include "firmware/nodes/faulty_units.h"
#include "firmware/nodes/silence_cause.h"

namespace etcm::firmware {

void AlarmWatch::step(port::Instant now) {
  if (now < look_due_ && !book_.wants_look()) return;
  look_due_ = now + look_interval;
  book_.begin_look(now);
  find_waiting_features();
  look_at_services(now);
  look_at_disks();
  look_at_buses(now);
  look_at_nodes();
  look_at_absent();
  look_at_faulty(now);
  look_at_far();
  look_at_quarantine();
  look_at_unheard();
  look_at_sensors();
  look_at_fleet(now);
  book_.end_look([&](const Alarm& alarm) { return is_judged(alarm.key, now); },
                 [&](const Alarm& alarm) { return why_ended(alarm); });
}

void AlarmWatch::find_waiting_features() {
  const std::span<const FeatureRecord> features = sources_.gateway.features();
  waiting_.clear();
  waiting_.reserve(2 * features.size());
  for (std::uint32_t number = 0; number < features.size(); ++number) {
    const FeatureRecord& feature = features[number];
    if (feature.is_active() || feature.rejection != Status::ok) continue;
    for (const FeatureEnd& end : {feature.settings.from, feature.settings.to}) {
      if (!end.is_anchor) waiting_.push_back({.serial = end.serial, .feature = number});
    }
  }
  std::sort(waiting_.begin(), waiting_.end(), [](const WaitingEnd& a, const WaitingEnd& b) {
    return std::pair(a.serial, a.feature) < std::pair(b.serial, b.feature);
  });
}

void AlarmWatch::add_waiting_feature(TextLine& text, Serial serial) const {
  const auto found =
      std::lower_bound(waiting_.begin(), waiting_.end(), serial,
                       [](const WaitingEnd& end, Serial wanted) { return end.serial < wanted; });
  if (found == waiting_.end() || found->serial != serial) return;
  const FeatureSettings& feature = sources_.gateway.features()[found->feature].settings;
  text << "; " << PlacedFeature{found->feature + 1, feature} << " waits for it";
}

void AlarmWatch::look_at_services(port::Instant now) {
  if (!sources_.masters.is_listening) {
    book_.hold({AlarmKind::not_served}, {}, "nobody can read the mesh: its port cannot be had",
               "the log says why");
  }
  if (sources_.readers != nullptr && !sources_.readers->is_listening) {
    book_.hold({AlarmKind::no_page}, {}, "there is no status page: its port cannot be had",
               "the log says why");
  }
  if (!sources_.refusal.empty()) {
    book_.hold({AlarmKind::refused_configuration}, {}, "the changed configuration is refused",
               sources_.refusal);
  }
  const Gateway& gateway = sources_.gateway;
  if (gateway.is_late(now, publish_patience)) {
    book_.hold({AlarmKind::late_mesh}, {}, "a change of the mesh waits to be published",
               "restart the gateway, and report it");
  }
}

void AlarmWatch::look_at_disks() {
  const auto look = [this](const DiskWriter* disk, AlarmKey key, std::string_view what) {
    if (disk != nullptr && disk->is_in_trouble()) book_.hold(key, {}, what, disk->trouble());
  };
  look(sources_.gateway.disk_of_files(), {AlarmKind::disk_of_files},
       "the files of the mesh cannot be written");
  look(sources_.gateway.disk_of_state(), {AlarmKind::disk_of_state},
       "the state is not saved: a restart finds an old one");
  look(disk_of_alarms_, {AlarmKind::disk_of_state, alarms_of_state},
       "the alarms are not saved: a restart finds those of an earlier moment");
}

void AlarmWatch::look_at_buses(port::Instant now) {
  const Gateway& gateway = sources_.gateway;
  const Poller& poller = gateway.poller();
  for (BusIndex bus{0}; bus.value < poller.bus_count(); ++bus.value) {
    if (!gateway.presence().is_silent(bus)) continue;
    const port::Instant since =
        std::max(gateway.presence().clock().heard_at(bus), sources_.started_at);
    book_.hold({AlarmKind::silent_bus, subject_of(poller.bus(bus).name)}, since,
               TextLine() << "bus " << poller.bus(bus).name << " is silent: no unit answers",
               silence_cause(poller, bus, now, gateway.settings().poll.stale_after));
  }
}

void AlarmWatch::look_at_nodes() {
  for (const NodeRecord& node : sources_.gateway.nodes().records()) {
    if (node.is_known()) look_at_node(node);
  }
}

void AlarmWatch::look_at_node(const NodeRecord& node) {
  const Gateway& gateway = sources_.gateway;
  const std::uint64_t subject = node.serial.value;
  if (node.is_missing) {
    if (is_with_its_gateway(gateway, node)) return;
    TextLine text;
    write_node(text, gateway, node);
    text << " is missing";
    add_waiting_feature(text, node.serial);
    TextLine cure;
    write_missing_cure(cure, gateway, node);
    return book_.hold({AlarmKind::missing_node, subject}, node.heard_at, text, cure);
  }
  // Those of others are told by their own gateways.
  if (node.is_foreign()) return;
  if (node.lacks_fix) {
    TextLine text;
    write_node(text, gateway, node);
    text << " answers, and tells no position";
    const auto told = told_at(gateway.poller(), node.last_unit);
    const NoPosition why = explain(told);
    if (told != DevicePosition::State::value) text << ": it " << why.what;
    book_.hold({AlarmKind::no_fix, subject},
               node.has_position() ? node.positioned_at : node.known_since, text, why.cure);
  }
  if ((node.status & node_status::low_battery) != 0) {
    TextLine text;
    write_node(text, gateway, node);
    book_.hold({AlarmKind::low_battery, subject}, {}, text << " has a low battery",
               "change it, or look at what charges it");
  }
}

void AlarmWatch::look_at_absent() {
  const Poller& poller = sources_.gateway.poller();
  for (const AbsentUnit& absent : sources_.gateway.absent_units().list()) {
    const std::string_view bus = poller.bus(poller.bus_of(absent.unit)).name;
    book_.hold({AlarmKind::never_answered, subject_of(bus, poller.address_of(absent.unit).value)},
               absent.since == port::Instant{} ? sources_.started_at : absent.since,
               TextLine() << poller.name(absent.unit).view() << absent.what(), absent_cure);
  }
}

void AlarmWatch::look_at_faulty(port::Instant now) {
  const Poller& poller = sources_.gateway.poller();
  const port::Duration patience = sources_.gateway.settings().poll.leave_after;
  for (UnitIndex unit{0}; unit.value < poller.unit_count(); ++unit.value) {
    const auto since = faulty_since(poller, unit, sources_.started_at, patience, now);
    if (!since) continue;
    const std::string_view bus = poller.bus(poller.bus_of(unit)).name;
    const FaultText text = explain_fault(poller, unit);
    book_.hold({AlarmKind::faulty_unit, subject_of(bus, poller.address_of(unit).value)}, *since,
               text.what, text.cure);
  }
}

void AlarmWatch::look_at_far() {
  const Gateway& gateway = sources_.gateway;
  for (const FarNode& node : gateway.far_nodes().list()) {
    if (!node.is_told) continue;
    TextLine text;
    gateway.far_nodes().explain(node, gateway.snapshot(), gateway.settings(), text);
    book_.hold({AlarmKind::far_node, node.serial.value}, node.since, text,
               gateway.far_nodes().cure_of(node));
  }
}

void AlarmWatch::look_at_quarantine() {
  const Gateway& gateway = sources_.gateway;
  for (const QuarantineEntry& entry : gateway.quarantine()) {
    const std::optional<RefusalText> refusal = refusal_text(gateway, entry);
    if (refusal) book_.hold(refusal->key, entry.since, refusal->what, refusal->cure);
  }
}

void AlarmWatch::look_at_unheard() {
  const UnheardEnds& unheard = sources_.gateway.unheard_ends();
  for (const NodeEnd& end : unheard.ends()) {
    if (!end.is_told) continue;
    TextLine text;
    unheard.explain(end, sources_.gateway.nodes(), text);
    TextLine cure;
    UnheardEnds::write_cure(end, sources_.gateway.nodes(), "there", cure);
    book_.hold({AlarmKind::unheard_end, end.serial.value}, {}, text, cure);
  }
}

void AlarmWatch::look_at_sensors() {
  const ReadingSnapshot& readings = sources_.gateway.readings();
  for (const PublishedReading& reading : readings.readings) {
    if (!reading.is_own() || !reading.disagrees) continue;
    const Quantity& quantity = readings.quantities[reading.quantity.value];
    TextLine text;
    text << sources_.gateway.nodes().called(reading.serial) << ": its " << quantity.name
         << " disagrees with the nodes around it";
    book_.hold({AlarmKind::disagreeing_sensor, subject_of(quantity.name, reading.serial.value)}, {},
               text, "look after the sensor");
  }
}

// A broker that is started again is no trouble.
void AlarmWatch::look_at_fleet(port::Instant now) {
  const FleetReport* const fleet = sources_.gateway.fleet();
  if (fleet == nullptr) return;
  const port::Duration patience = sources_.gateway.settings().poll.leave_after;
  if (time_apart(*fleet, now) > patience) {
    book_.hold({AlarmKind::no_broker}, *fleet->apart_since,
               "no connection to the broker of the fleet that lasts", fleet->trouble);
  }
  if (!fleet->refusal.empty()) {
    const Sentence why = parts_of(fleet->refusal);
    book_.hold({AlarmKind::refused_by_broker}, {}, why.what, why.cure);
  }
  if (!fleet->site_trouble.empty()) {
    const Sentence why = parts_of(fleet->site_trouble);
    book_.hold({AlarmKind::site_of_fleet}, {}, why.what, why.cure);
  }
  for (const ReportedMember& member : fleet->members) look_at_member(member, now);
}

void AlarmWatch::look_at_member(const ReportedMember& member, port::Instant now) {
  const std::uint64_t subject = subject_of(member.name);
  TextLine text;
  text << "gateway " << member.name;
  switch (member.state) {
    case MemberState::unknown:
    case MemberState::gone: {
      // Once told it goes on until that one is back, whether this gateway is connected or not.
      const AlarmKey key{AlarmKind::gone_gateway, subject};
      const port::Duration leave_after = sources_.gateway.settings().poll.leave_after;
      const FleetReport& fleet = *sources_.gateway.fleet();
      if (!book_.is_on(key) && !is_gone_for_long(fleet, member, leave_after, now)) return;
      text << (member.left_with_broker ? not_back : " is gone");
      TextLine cure;
      cure << gone_cure << how_to_dismiss(member) << member.name;
      return book_.hold(key, member.since, text, cure);
    }
    case MemberState::name_taken: {
      const FleetReport& fleet = *sources_.gateway.fleet();
      text << ": another one has this name too";
      if (fleet.is_silent && member.name == fleet.name) text << ", and this one is silent";
      return book_.hold({AlarmKind::name_taken, subject}, member.since, text, member.why);
    }
    case MemberState::rejected:
      text << " says what is not taken: " << member.why;
      return book_.hold({AlarmKind::rejected_gateway, subject}, member.since, text,
                        "give both one version; what is no gateway's is taken back by a retained "
                        "message without content at its topic");
    case MemberState::here:
      if (!member.differs) return;
      return book_.hold({AlarmKind::other_mesh, subject}, {}, text << " has another mesh",
                        member.why);
    case MemberState::waiting:
      return;
  }
}

}  // namespace etcm::firmware
