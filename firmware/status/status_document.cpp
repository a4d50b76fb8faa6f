#include "firmware/status/status_document.h"

#include <algorithm>
#include <array>
#include <utility>

#include "firmware/config/site_plan.h"
#include "firmware/mesh/feature_reason.h"
#include "firmware/status/health.h"
#include "firmware/status/shown_unit.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// Sections of the documents.
enum : std::uint32_t {
  opening,
  troubles,
  restart,
  counts,
  fleet,
  missing,
  left_nodes,
  quarantine,
  unheard,
  buses,
  events,
  closing
};
enum : std::uint32_t { ages_head, ages, ages_tail };

// Nodes that are looked at in one piece, and of those so many at the most are written.
constexpr std::uint32_t age_looks_max = 50;
constexpr std::uint32_t missing_looks_max = 1000;
// Of why a bus has no link.
constexpr std::size_t why_shown_max = 160;
// Of all reasons of trouble; fits a piece though all of it be quotation marks.
constexpr std::size_t troubles_shown_max = 1200;

}  // namespace

bool StatusDocument::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  switch (cursor.section) {
    case opening:
      write_head(asked_at, piece);
      cursor.next_section();
      return true;
    case troubles:
      write_troubles(asked_at, piece);
      cursor.next_section();
      return true;
    case restart:
      write_needs_restart(piece);
      cursor.next_section();
      return true;
    case counts:
      write_plan(piece);
      write_counts(piece);
      cursor.next_section();
      return true;
    case fleet:
      write_fleet(cursor, asked_at, piece);
      return true;
    case missing:
      write_missing(cursor, asked_at, piece);
      return true;
    case left_nodes:
      write_left(cursor, asked_at, piece);
      return true;
    case quarantine:
      write_quarantine(cursor, asked_at, piece);
      return true;
    case unheard:
      write_unheard(cursor, piece);
      return true;
    case buses:
      write_bus(cursor, asked_at, piece);
      return true;
    case events:
      write_event(cursor, asked_at, piece);
      return true;
    case closing:
      piece << "]}\n";
      cursor.next_section();
      return true;
    default:
      return false;
  }
}

void StatusDocument::write_head(port::Instant asked_at, TextWriter& piece) const {
  const Snapshot& snapshot = sources_.gateway.snapshot();
  const PollSettings& poll = sources_.gateway.settings().poll;
  piece << "{\"version\":";
  piece.json(sources_.version) << ",\"name\":";
  piece.json(snapshot.names->site()) << ",\"instance\":\"";
  piece.hex(instance_of(sources_))
      << "\",\"time_ms\":" << sources_.wall_clock.milliseconds()
      << ",\"uptime_ms\":" << age_of(sources_.started_at, asked_at) / 1ms
      << ",\"generation\":" << snapshot.generation << ",\"state\":{\"partial\":";
  piece.yes_or_no((snapshot.state & snapshot_state::partial) != 0) << ",\"stale\":";
  piece.yes_or_no((snapshot.state & snapshot_state::stale) != 0) << ",\"budget_hit\":";
  piece.yes_or_no((snapshot.state & snapshot_state::budget_hit) != 0) << ",\"missing\":";
  piece.yes_or_no((snapshot.state & snapshot_state::missing) != 0) << ",\"bus_silent\":";
  piece.yes_or_no((snapshot.state & snapshot_state::bus_silent) != 0)
      << "},\"interval_ms\":" << poll.interval / 1ms
      << ",\"stale_after_ms\":" << poll.stale_after / 1ms
      << ",\"leave_after_ms\":" << poll.leave_after / 1ms;
}

void StatusDocument::write_troubles(port::Instant asked_at, TextWriter& piece) const {
  std::array<char, troubles_shown_max> room;
  TextWriter reasons(room);
  is_healthy(sources_, asked_at, reasons);
  std::string_view left = reasons.text();
  std::string_view before = ",\"troubles\":[";
  if (left.empty()) piece << before;
  while (!left.empty()) {
    const std::string_view line = left.substr(0, left.find('\n'));
    left.remove_prefix(std::min(line.size() + 1, left.size()));
    piece << std::exchange(before, ",");
    piece.json(line);
  }
  piece << "]";
}

// Those that there is room for.
void StatusDocument::write_needs_restart(TextWriter& piece) const {
  if (sources_.needs_restart == nullptr || sources_.needs_restart->empty()) return;
  constexpr std::size_t keys_max = 10;
  constexpr std::size_t key_bytes_max = 60;
  std::string_view before = ",\"needs_restart\":[";
  std::size_t room = keys_max;
  for (const std::string& key : *sources_.needs_restart) {
    if (room-- == 0) break;
    piece << std::exchange(before, ",");
    piece.json(port::cut_utf8(key, key_bytes_max));
  }
  piece << "],\"config\":";
  piece.json(port::cut_utf8(sources_.config, why_shown_max));
}

// Where its corners are in the mesh: upper left, upper right, lower left.
void StatusDocument::write_plan(TextWriter& piece) const {
  const SiteSettings& site = sources_.gateway.settings().site;
  if (site.plan == nullptr) return;
  const auto corners = plan_corners(*site.plan, site.plane());
  if (!corners) return;
  piece << ",\"plan\":{\"version\":\"";
  piece.hash(site.plan->version) << "\",\"width\":" << site.plan->width
                                 << ",\"height\":" << site.plan->height << ",\"corners\":";
  std::string_view before = "[";
  for (const PlanPlace& corner : *corners) {
    piece << before << "[";
    piece.decimal(corner.x, 3) << ",";
    piece.decimal(corner.y, 3) << "]";
    before = ",";
  }
  piece << "]}";
}

void StatusDocument::write_counts(TextWriter& piece) const {
  const Snapshot& snapshot = sources_.gateway.snapshot();
  const MeshTimes& times = sources_.gateway.mesh_times();
  piece << ",\n\"nodes\":" << snapshot.node_count
        << ",\"steiner_vertices\":" << snapshot.steiner_count
        << ",\"edges\":" << snapshot.edge_count << ",\"triangles\":" << snapshot.triangle_count
        << ",\"features_active\":" << snapshot.features_active
        << ",\"features_configured\":" << snapshot.features_configured
        << ",\"quarantined\":" << snapshot.quarantined_count
        << ",\"stale_nodes\":" << snapshot.stale_count
        << ",\"disagreeing_sensors\":" << count_disagreeing(sources_.gateway.readings())
        << ",\"missing_nodes\":" << snapshot.missing_count
        << ",\"absent_units\":" << snapshot.absent_count
        << ",\"waiting_nodes\":" << snapshot.waiting_count
        << ",\"vertices_max\":" << sources_.gateway.settings().mesh.vertices_max
        << ",\"mesh_changes\":" << times.changes << ",\"mesh_last_us\":" << times.last / 1us
        << ",\"mesh_longest_us\":" << times.longest / 1us
        << ",\"radio_range\":" << snapshot.analysis.radio_range
        << ",\"parts\":" << snapshot.analysis.parts_with_relays
        << ",\"parts_alone\":" << snapshot.analysis.parts_alone
        << ",\"long_links\":" << snapshot.analysis.long_link_count
        << ",\"relays\":" << snapshot.analysis.relay_count
        << ",\"sensing_range\":" << snapshot.analysis.sensing_range
        << ",\"holes\":" << snapshot.analysis.hole_count
        << ",\"gaps\":" << snapshot.analysis.unwatched_gap_count
        << ",\"quantities\":" << sources_.gateway.readings().quantities.size()
        << ",\"readings_sequence\":" << sources_.gateway.readings().sequence
        << ",\"alarms\":{\"on\":" << sources_.alarms.on_count()
        << ",\"critical\":" << sources_.alarms.on_count(Severity::critical)
        << ",\"major\":" << sources_.alarms.on_count(Severity::major)
        << ",\"unacknowledged\":" << sources_.alarms.unacknowledged_count() << ",\"ended\":"
        << sources_.alarms.ended_count() + sources_.alarms.open_count() - sources_.alarms.on_count()
        << ",\"edition\":" << sources_.alarms.edition()
        << "},\"masters\":" << sources_.masters.clients
        << ",\"readers\":" << sources_.readers.clients;
}

// One gateway a piece.
void StatusDocument::write_fleet(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  const FleetReport* const report = sources_.gateway.fleet();
  if (report != nullptr && cursor.item == 0) write_fleet_head(*report, asked_at, piece);
  if (report != nullptr && cursor.item < report->members.size()) {
    const ReportedMember& member = report->members[cursor.item++];
    return write_member(member, asked_at, cursor.separator(), piece);
  }
  piece << (report != nullptr ? "]},\n\"missing\":[" : ",\n\"missing\":[");
  cursor.next_section();
}

void StatusDocument::write_fleet_head(const FleetReport& report, port::Instant asked_at,
                                      TextWriter& piece) const {
  piece << ",\n\"fleet\":{\"site\":";
  piece.json(report.site) << ",\"name\":";
  piece.json(report.name) << ",\"connected\":";
  piece.yes_or_no(report.is_connected);
  if (!report.is_connected) {
    piece << ",\"apart_ms\":" << age_of(report.connected_or_not_since, asked_at) / 1ms
          << ",\"trouble\":";
    piece.json(report.trouble);
  }
  if (report.site_number > 0) {
    piece << ",\"site_number\":" << report.site_number << ",\"site_gateway\":";
    piece.json(report.site_gateway);
  }
  if (!report.site_trouble.empty()) {
    piece << ",\"site_trouble\":";
    piece.json(report.site_trouble);
  }
  piece << ",\"agreeing\":" << report.agreeing << ",\"members\":[";
}

void StatusDocument::write_member(const ReportedMember& member, port::Instant asked_at,
                                  std::string_view separator, TextWriter& piece) const {
  piece << separator << "\n{\"name\":";
  piece.json(member.name) << ",\"state\":";
  piece.json(to_string(member.state))
      << ",\"since_ms\":" << age_of(member.since, asked_at) / 1ms
      << ",\"nodes\":" << member.node_count << ",\"generation\":" << member.generation
      << ",\"mesh_hash\":";
  if (member.mesh_hash) {
    piece << "\"";
    piece.hash(*member.mesh_hash) << "\"";
  } else {
    piece << "null";
  }
  piece << ",\"agrees\":";
  piece.yes_or_no(member.agrees) << ",\"version\":";
  piece.json(member.version);
  if (!member.why.empty()) {
    piece << ",\"why\":";
    piece.json(member.why);
  }
  piece << "}";
}

// One node a piece.
void StatusDocument::write_missing(Cursor& cursor, port::Instant asked_at,
                                   TextWriter& piece) const {
  const std::span<const NodeRecord> nodes = sources_.gateway.nodes().records();
  for (std::uint32_t look = 0; look < missing_looks_max; ++look) {
    if (cursor.item >= nodes.size()) {
      piece << "],\n\"left\":[";
      return cursor.next_section();
    }
    const NodeRecord& node = nodes[cursor.item++];
    if (!node.is_missing) continue;
    piece << cursor.separator() << "{\"serial\":" << node.serial.value;
    write_name(node.serial, piece);
    piece << ",\"since_ms\":" << missing_for(sources_, node, asked_at) / 1ms;
    write_unit(node.last_unit, piece);
    const std::string_view gateway = gateway_name(sources_.gateway.snapshot(), node.owner);
    if (!gateway.empty()) {
      piece << ",\"gateway\":";
      piece.json(gateway);
    }
    piece << "}";
    return;
  }
}

// The same: who has said that it leaves, how long ago.
void StatusDocument::write_left(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  const std::span<const NodeRecord> nodes = sources_.gateway.nodes().records();
  for (std::uint32_t look = 0; look < missing_looks_max; ++look) {
    if (cursor.item >= nodes.size()) {
      piece << "],\n\"quarantine\":[";
      return cursor.next_section();
    }
    const NodeRecord& node = nodes[cursor.item++];
    if (node.left_at == port::Instant{} || node.is_placed()) continue;
    piece << cursor.separator() << "{\"serial\":" << node.serial.value;
    write_name(node.serial, piece);
    piece << ",\"since_ms\":" << age_of(node.left_at, asked_at) / 1ms << "}";
    return;
  }
}

void StatusDocument::write_name(Serial serial, TextWriter& piece) const {
  const CalledNode node = sources_.gateway.nodes().called(serial);
  if (node.name.empty()) return;
  piece << ",\"name\":";
  piece.json(node.name);
}

void StatusDocument::write_unit(UnitIndex unit, TextWriter& piece) const {
  if (unit.is_none()) return;
  const Poller& poller = sources_.gateway.poller();
  piece << ",\"bus\":";
  piece.json(bus_label(poller, poller.bus_of(unit)))
      << ",\"unit\":" << poller.address_of(unit).value;
}

void StatusDocument::write_quarantine(Cursor& cursor, port::Instant asked_at,
                                      TextWriter& piece) const {
  const std::span<const QuarantineEntry> entries = sources_.gateway.quarantine();
  if (cursor.item >= entries.size()) {
    piece << "],\n\"unheard\":[";
    return cursor.next_section();
  }
  const QuarantineEntry& entry = entries[cursor.item++];
  piece << cursor.separator() << "{\"since_ms\":" << age_of(entry.since, asked_at) / 1ms;
  if (!entry.serial.is_none()) {
    piece << ",\"serial\":" << entry.serial.value;
    write_name(entry.serial, piece);
  }
  if (entry.feature != 0) {
    piece << ",\"feature\":" << entry.feature;
    const std::string_view name = sources_.gateway.snapshot().names->feature(entry.feature);
    if (!name.empty()) {
      piece << ",\"name\":";
      piece.json(name);
    }
  }
  write_unit(entry.unit_index, piece);
  piece << ",\"why\":";
  write_why(entry, piece);
  piece << "}";
}

void StatusDocument::write_why(const QuarantineEntry& entry, TextWriter& piece) const {
  const std::span<const FeatureRecord> features = sources_.gateway.features();
  if (entry.feature == 0 || entry.feature > features.size()) {
    piece.json(explain(entry));
    return;
  }
  const auto reason =
      reason_of(features[entry.feature - 1].settings, entry.rejection.mesh, entry.blocker, features,
                sources_.gateway.nodes(), sources_.gateway.settings().site.plane());
  if (!reason) {
    piece.json(explain(entry));
    return;
  }
  std::array<char, 2 * sizeof(TextLine)> room;
  TextWriter why(room);
  why << reason->what.view() << "; " << reason->cure.view();
  piece.json(why.text());
}

// One node a piece.
void StatusDocument::write_unheard(Cursor& cursor, TextWriter& piece) const {
  const UnheardEnds& unheard_ends = sources_.gateway.unheard_ends();
  const std::span<const NodeEnd> ends = unheard_ends.ends();
  for (std::uint32_t look = 0; look < missing_looks_max; ++look) {
    if (cursor.item >= ends.size()) {
      piece << "],\n\"buses\":[";
      return cursor.next_section();
    }
    const NodeEnd& end = ends[cursor.item++];
    if (!end.is_told) continue;
    TextLine text;
    unheard_ends.explain(end, sources_.gateway.nodes(), text);
    UnheardEnds::write_cure(end, sources_.gateway.nodes(), "there", text << "; ");
    piece << cursor.separator() << "{\"serial\":" << end.serial.value;
    write_name(end.serial, piece);
    piece << ",\"why\":";
    piece.json(text.view()) << "}";
    return;
  }
}

void StatusDocument::write_bus(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  const Poller& poller = sources_.gateway.poller();
  if (cursor.item >= poller.bus_count()) {
    piece << "],\n\"events\":[";
    return cursor.next_section();
  }
  const BusIndex bus{cursor.item++};
  std::uint32_t units = 0;
  std::uint32_t answering = 0;
  for (UnitIndex unit{0}; unit.value < poller.unit_count(); ++unit.value) {
    if (poller.bus_of(unit) != bus || !is_shown(poller, unit)) continue;
    ++units;
    if (is_answering(sources_.gateway, unit)) ++answering;
  }
  const BusUse& use = meter_.use(bus);
  piece << cursor.separator() << "{\"name\":";
  piece.json(bus_label(poller, bus))
      << ",\"units\":" << units << ",\"answering\":" << answering << ",\"utilisation\":";
  piece.decimal(use.utilisation, 3) << ",\"efficiency\":";
  piece.decimal(use.efficiency, 3);
  if (sources_.gateway.presence().is_silent(bus)) {
    piece << ",\"silent_ms\":" << silent_for(sources_, bus, asked_at) / 1ms;
  }
  if (!poller.is_up(bus)) {
    piece << ",\"no_link\":";
    piece.json(port::cut_utf8(poller.why_down(bus), why_shown_max));
  }
  piece << "}";
}

void StatusDocument::write_event(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  const std::optional<RecentEvent> event = next_event(sources_.events, cursor);
  if (!event) return cursor.next_section();
  piece << cursor.separator() << "\n{\"number\":" << event->number
        << ",\"age_ms\":" << age_of(event->at, asked_at) / 1ms << ",\"level\":";
  piece.json(word_of(event->level)) << ",\"text\":";
  piece.json(event->text) << "}";
}

bool AgesDocument::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  switch (cursor.section) {
    case ages_head:
      piece << "[";
      cursor.next_section();
      return true;
    case ages: {
      const std::span<const NodeRecord> nodes = sources_.gateway.nodes().records();
      for (std::uint32_t look = 0; look < age_looks_max; ++look) {
        if (cursor.item >= nodes.size()) {
          cursor.next_section();
          return true;
        }
        const NodeRecord& node = nodes[cursor.item++];
        if (!node.is_known() || !node.has_position()) continue;
        piece << cursor.separator() << "[" << node.serial.value << ","
              << age_of(node.positioned_at, asked_at) / 1ms << "]";
      }
      return true;
    }
    case ages_tail:
      piece << "]\n";
      cursor.next_section();
      return true;
    default:
      return false;
  }
}

}  // namespace etcm::firmware
