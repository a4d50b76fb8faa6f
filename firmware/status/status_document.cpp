#include "firmware/status/status_document.h"

#include <algorithm>
#include <array>

#include "firmware/status/health.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;

// Sections of the documents.
enum : std::uint32_t { opening, counts, missing, quarantine, buses, events, closing };
enum : std::uint32_t { ages_head, ages, ages_tail };

// Nodes that are looked at in one piece, and of those so many at the most are written.
constexpr std::uint32_t age_looks_max = 50;
constexpr std::uint32_t missing_looks_max = 1000;

const char* word(port::Level level) {
  switch (level) {
    case port::Level::error:
      return "error";
    case port::Level::warning:
      return "warning";
    case port::Level::info:
      break;
  }
  return "info";
}

}  // namespace

bool StatusDocument::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  switch (cursor.section) {
    case opening:
      write_head(asked_at, piece);
      cursor.next_section();
      return true;
    case counts:
      write_counts(piece);
      piece << ",\n\"missing\":[";
      cursor.next_section();
      return true;
    case missing:
      write_missing(cursor, asked_at, piece);
      return true;
    case quarantine:
      write_quarantine(cursor, asked_at, piece);
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
  piece.json(sources_.version) << ",\"instance\":\"";
  piece.hex(instance_of(sources_))
      << "\",\"uptime_ms\":" << age_of(sources_.started_at, asked_at) / 1ms
      << ",\"generation\":" << snapshot.generation << ",\"state\":{\"partial\":";
  piece.yes_or_no((snapshot.state & snapshot_state::partial) != 0) << ",\"stale\":";
  piece.yes_or_no((snapshot.state & snapshot_state::stale) != 0) << ",\"budget_hit\":";
  piece.yes_or_no((snapshot.state & snapshot_state::budget_hit) != 0) << ",\"missing\":";
  piece.yes_or_no((snapshot.state & snapshot_state::missing) != 0) << ",\"bus_silent\":";
  piece.yes_or_no((snapshot.state & snapshot_state::bus_silent) != 0) << "},\"trouble\":";
  std::array<char, 512> room;
  TextWriter reason(room);
  is_healthy(sources_, asked_at, reason);
  piece.json(reason.text()) << ",\"interval_ms\":" << poll.interval / 1ms
                            << ",\"stale_after_ms\":" << poll.stale_after / 1ms
                            << ",\"leave_after_ms\":" << poll.leave_after / 1ms;
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
        << ",\"waiting_nodes\":" << snapshot.waiting_count
        << ",\"vertices_max\":" << sources_.gateway.settings().mesh.vertices_max
        << ",\"mesh_changes\":" << times.changes << ",\"mesh_last_us\":" << times.last / 1us
        << ",\"mesh_longest_us\":" << times.longest / 1us
        << ",\"radio_range\":" << snapshot.analysis.radio_range
        << ",\"parts\":" << snapshot.analysis.parts_with_relays
        << ",\"long_links\":" << snapshot.analysis.long_link_count
        << ",\"relays\":" << snapshot.analysis.relay_count
        << ",\"sensing_range\":" << snapshot.analysis.sensing_range
        << ",\"holes\":" << snapshot.analysis.hole_count
        << ",\"gaps\":" << snapshot.analysis.unwatched_gap_count
        << ",\"quantities\":" << sources_.gateway.readings().quantities.size()
        << ",\"readings_sequence\":" << sources_.gateway.readings().sequence
        << ",\"masters\":" << sources_.masters.clients
        << ",\"readers\":" << sources_.readers.clients;
}

// One node a piece.
void StatusDocument::write_missing(Cursor& cursor, port::Instant asked_at,
                                   TextWriter& piece) const {
  const std::span<const NodeRecord> nodes = sources_.gateway.nodes().records();
  for (std::uint32_t look = 0; look < missing_looks_max; ++look) {
    if (cursor.item >= nodes.size()) {
      piece << "],\n\"quarantine\":[";
      return cursor.next_section();
    }
    const NodeRecord& node = nodes[cursor.item++];
    if (!node.is_missing) continue;
    piece << cursor.separator() << "{\"serial\":" << node.serial.value
          << ",\"since_ms\":" << age_of(node.heard_at, asked_at) / 1ms;
    write_unit(node.last_unit, piece);
    piece << "}";
    return;
  }
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
    piece << "],\n\"buses\":[";
    return cursor.next_section();
  }
  const QuarantineEntry& entry = entries[cursor.item++];
  piece << cursor.separator() << "{\"since_ms\":" << age_of(entry.since, asked_at) / 1ms;
  if (!entry.serial.is_none()) piece << ",\"serial\":" << entry.serial.value;
  if (entry.feature != 0) piece << ",\"feature\":" << entry.feature;
  write_unit(entry.unit_index, piece);
  piece << ",\"why\":";
  piece.json(explain(entry)) << "}";
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
    if (poller.bus_of(unit) != bus) continue;
    ++units;
    const bool has_answered = poller.counters(unit).count(port::BusResult::ok) > 0;
    if (has_answered && poller.failures(unit) == 0) ++answering;
  }
  const BusUse& use = meter_.use(bus);
  piece << cursor.separator() << "{\"name\":";
  piece.json(bus_label(poller, bus))
      << ",\"units\":" << units << ",\"answering\":" << answering << ",\"utilisation\":";
  piece.decimal(use.utilisation, 3) << ",\"efficiency\":";
  piece.decimal(use.efficiency, 3);
  const Presence& presence = sources_.gateway.presence();
  if (presence.is_silent(bus)) {
    const port::Instant since = std::max(presence.clock().heard_at(bus), sources_.started_at);
    piece << ",\"silent_ms\":" << age_of(since, asked_at) / 1ms;
  }
  piece << "}";
}

// The newest first.
void StatusDocument::write_event(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  // New ones may come between two pieces, and then the oldest are gone.
  if (cursor.item == 0) cursor.part = static_cast<std::uint32_t>(sources_.events.written());
  const std::uint64_t number = std::uint64_t{cursor.part} - cursor.item;
  const std::uint64_t oldest = sources_.events.written() - sources_.events.count();
  if (cursor.item >= cursor.part || number <= oldest) return cursor.next_section();
  ++cursor.item;
  const RecentEvent event = sources_.events.at(static_cast<std::uint32_t>(number - 1 - oldest));
  piece << cursor.separator() << "\n{\"number\":" << event.number
        << ",\"age_ms\":" << age_of(event.at, asked_at) / 1ms << ",\"level\":";
  piece.json(word(event.level)) << ",\"text\":";
  piece.json(event.text) << "}";
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
