#include "firmware/status/metrics_document.h"

#include <array>

namespace etcm::firmware {

namespace {

using port::BusResult;

// What a sample is written from.
struct Context {
  const StatusSources& sources;
  const BusMeter& meter;
  port::Instant asked_at;
  const char* name;

  const Snapshot& snapshot() const { return sources.gateway.snapshot(); }
  const Poller& poller() const { return sources.gateway.poller(); }
};

// Of what there is a sample each.
enum class Scope : std::uint8_t { gateway, bus, shared_bus, unit, node, reading };

// One metric: its samples are those of the scope, and what write() adds.
struct Family {
  const char* name;
  const char* type;
  const char* help;
  Scope scope;
  void (*write)(const Context& context, std::uint32_t index, TextWriter& piece);
};

std::uint32_t count_of(Scope scope, const Context& context) {
  switch (scope) {
    case Scope::gateway:
      return 1;
    case Scope::bus:
    case Scope::shared_bus:
      return context.poller().bus_count();
    case Scope::unit:
      return context.poller().unit_count();
    case Scope::node:
      return static_cast<std::uint32_t>(context.sources.gateway.nodes().records().size());
    case Scope::reading:
      return static_cast<std::uint32_t>(context.sources.gateway.reading_table().records().size());
  }
  return 0;
}

const ReadingRecord& reading_at(const Context& context, std::uint32_t index) {
  return context.sources.gateway.reading_table().records()[index];
}

const port::LineClients* clients_at(const Context& context, std::uint32_t bus) {
  return context.poller().client_requests(BusIndex{bus}).clients();
}

// Of the units that are only looked for, those that are not there would be most of the text. A
// reading is that of the node that answered at its unit last.
bool is_shown(Scope scope, std::uint32_t index, const Context& context) {
  if (scope == Scope::unit) {
    return context.poller().is_listed(UnitIndex{index}) ||
           context.poller().counters(UnitIndex{index}).has_answered();
  }
  if (scope == Scope::shared_bus) {
    const port::LineClients* const clients = clients_at(context, index);
    return clients != nullptr && clients->is_shared();
  }
  if (scope != Scope::reading) return true;
  const ReadingRecord& reading = reading_at(context, index);
  const NodeRecord* const node = context.sources.gateway.nodes().find(reading.serial);
  return node != nullptr && node->last_unit == reading.unit_index;
}

void plain(const Context& context, std::uint64_t value, TextWriter& piece) {
  piece << context.name << " " << value << "\n";
}

void plain_seconds(const Context& context, port::Duration value, TextWriter& piece) {
  piece << context.name << " ";
  piece.seconds(value) << "\n";
}

// "name_suffix{bus="yard",unit="7"", to be completed by more labels or by "} value".
TextWriter& unit_labels(const Context& context, const char* suffix, UnitIndex unit,
                        TextWriter& piece) {
  piece << context.name << suffix << "{bus=";
  piece.label(bus_label(context.poller(), context.poller().bus_of(unit)));
  return piece << ",unit=\"" << context.poller().address_of(unit).value << "\"";
}

TextWriter& bus_labels(const Context& context, BusIndex bus, TextWriter& piece) {
  piece << context.name << "{bus=";
  return piece.label(bus_label(context.poller(), bus)) << "} ";
}

void write_build(const Context& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{version=";
  piece.label(context.sources.version) << "} 1\n";
}

void write_state(const Context& context, std::uint32_t, TextWriter& piece) {
  const auto flag = [&](const char* name, std::uint16_t bit) {
    piece << context.name << "{flag=\"" << name << "\"} "
          << ((context.snapshot().state & bit) != 0 ? 1 : 0) << "\n";
  };
  flag("partial", snapshot_state::partial);
  flag("stale", snapshot_state::stale);
  flag("budget_hit", snapshot_state::budget_hit);
  flag("missing", snapshot_state::missing);
  flag("bus_silent", snapshot_state::bus_silent);
}

void write_features(const Context& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{state=\"active\"} " << context.snapshot().features_active << "\n"
        << context.name << "{state=\"configured\"} " << context.snapshot().features_configured
        << "\n";
}

// Of those that are wanted.
void write_disk(const Context& context, std::uint32_t, TextWriter& piece) {
  const auto disk = [&](const char* section, const DiskWriter* writer) {
    if (writer == nullptr) return;
    piece << context.name << "{section=\"" << section << "\"} " << (writer->is_in_trouble() ? 1 : 0)
          << "\n";
  };
  disk("files", context.sources.gateway.disk_of_files());
  disk("state", context.sources.gateway.disk_of_state());
}

void write_listening(const Context& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{server=\"modbus\"} " << (context.sources.masters.is_listening ? 1 : 0)
        << "\n"
        << context.name << "{server=\"http\"} " << (context.sources.readers.is_listening ? 1 : 0)
        << "\n";
}
void write_clients(const Context& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{server=\"modbus\"} " << context.sources.masters.clients << "\n"
        << context.name << "{server=\"http\"} " << context.sources.readers.clients << "\n";
}
void write_served(const Context& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{server=\"modbus\"} " << context.sources.masters.requests << "\n"
        << context.name << "{server=\"http\"} " << context.sources.readers.requests << "\n";
}
void write_rejected(const Context& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{server=\"modbus\"} " << context.sources.masters.rejected << "\n"
        << context.name << "{server=\"http\"} " << context.sources.readers.rejected << "\n";
}

void write_memory(const Context& context, std::uint32_t, TextWriter& piece) {
  if (context.sources.resident_bytes != nullptr) {
    plain(context, context.sources.resident_bytes(), piece);
  }
}

void write_unit_requests(const Context& context, std::uint32_t index, TextWriter& piece) {
  const UnitIndex unit{index};
  unit_labels(context, "", unit, piece) << "} " << context.poller().counters(unit).requests << "\n";
}

void write_unit_errors(const Context& context, std::uint32_t index, TextWriter& piece) {
  const UnitIndex unit{index};
  const UnitCounters& counters = context.poller().counters(unit);
  const auto kind = [&](const char* name, std::uint64_t count) {
    unit_labels(context, "", unit, piece) << ",kind=\"" << name << "\"} " << count << "\n";
  };
  kind("timeout", counters.count(BusResult::timeout));
  kind("exception", counters.count(BusResult::exception));
  kind("bad_answer", counters.count(BusResult::bad_answer));
  kind("link_lost", counters.count(BusResult::link_lost));
  kind("torn", counters.torn);
  kind("unbelieved", counters.unbelieved);
  kind("jumped", counters.jumped);
}

void write_unit_answer(const Context& context, std::uint32_t index, TextWriter& piece) {
  const UnitIndex unit{index};
  const UnitCounters& counters = context.poller().counters(unit);
  unit_labels(context, "_sum", unit, piece) << "} ";
  piece.seconds(counters.answer_time) << "\n";
  unit_labels(context, "_count", unit, piece) << "} " << counters.count(BusResult::ok) << "\n";
}

void write_unit_answer_max(const Context& context, std::uint32_t index, TextWriter& piece) {
  const UnitIndex unit{index};
  unit_labels(context, "", unit, piece) << "} ";
  piece.seconds(context.poller().counters(unit).answer_time_max) << "\n";
}

void write_node(const Context& context, Serial serial, port::Instant since, TextWriter& piece) {
  piece << context.name << "{serial=\"" << serial.value << "\"} ";
  piece.seconds(age_of(since, context.asked_at)) << "\n";
}

const NodeRecord& record(const Context& context, std::uint32_t index) {
  return context.sources.gateway.nodes().records()[index];
}

void write_node_age(const Context& context, std::uint32_t index, TextWriter& piece) {
  const NodeRecord& node = record(context, index);
  if (node.is_known() && node.has_position()) {
    write_node(context, node.serial, node.positioned_at, piece);
  }
}

void write_node_silence(const Context& context, std::uint32_t index, TextWriter& piece) {
  const NodeRecord& node = record(context, index);
  if (node.is_known()) write_node(context, node.serial, node.heard_at, piece);
}

void write_node_missing(const Context& context, std::uint32_t index, TextWriter& piece) {
  const NodeRecord& node = record(context, index);
  if (node.is_missing) write_node(context, node.serial, node.heard_at, piece);
}

TextWriter& reading_labels(const Context& context, const ReadingRecord& reading,
                           TextWriter& piece) {
  const Quantity& quantity = context.sources.gateway.readings().quantities[reading.quantity.value];
  piece << context.name << "{name=";
  piece.label(quantity.name) << ",unit=";
  return piece.label(quantity.unit) << ",serial=\"" << reading.serial.value << "\"} ";
}

// A series without a sample is how Prometheus is told that there is no value now.
void write_reading(const Context& context, std::uint32_t index, TextWriter& piece) {
  const ReadingRecord& reading = reading_at(context, index);
  if (reading.is_stale || !reading.nano) return;
  reading_labels(context, reading, piece).nano(*reading.nano) << "\n";
}

void write_reading_age(const Context& context, std::uint32_t index, TextWriter& piece) {
  const ReadingRecord& reading = reading_at(context, index);
  reading_labels(context, reading, piece).seconds(age_of(reading.taken_at, context.asked_at))
      << "\n";
}

// As it was published; null before.
const PublishedReading* published(const Context& context, const ReadingRecord& reading) {
  for (const PublishedReading& found :
       readings_of(context.sources.gateway.readings(), reading.serial)) {
    if (found.quantity == reading.quantity) return &found;
  }
  return nullptr;
}

void write_expected(const Context& context, std::uint32_t index, TextWriter& piece) {
  const ReadingRecord& reading = reading_at(context, index);
  const PublishedReading* const shown = published(context, reading);
  if (shown == nullptr || !shown->expected_nano) return;
  reading_labels(context, reading, piece).nano(*shown->expected_nano) << "\n";
}

void write_disagrees(const Context& context, std::uint32_t index, TextWriter& piece) {
  const ReadingRecord& reading = reading_at(context, index);
  const PublishedReading* const shown = published(context, reading);
  if (shown == nullptr) return;
  reading_labels(context, reading, piece) << (shown->disagrees ? 1 : 0) << "\n";
}

void write_bus_silent(const Context& context, std::uint32_t index, TextWriter& piece) {
  const BusIndex bus{index};
  bus_labels(context, bus, piece) << (context.sources.gateway.presence().is_silent(bus) ? 1 : 0)
                                  << "\n";
}

void write_bus_busy(const Context& context, std::uint32_t index, TextWriter& piece) {
  const BusIndex bus{index};
  bus_labels(context, bus, piece);
  piece.seconds(context.poller().bus_counters(bus).busy) << "\n";
}
void write_bus_floor(const Context& context, std::uint32_t index, TextWriter& piece) {
  const BusIndex bus{index};
  bus_labels(context, bus, piece);
  piece.seconds(context.poller().bus_counters(bus).floor) << "\n";
}
void write_bus_utilisation(const Context& context, std::uint32_t index, TextWriter& piece) {
  const BusIndex bus{index};
  bus_labels(context, bus, piece).decimal(context.meter.use(bus).utilisation, 4) << "\n";
}
void write_bus_efficiency(const Context& context, std::uint32_t index, TextWriter& piece) {
  const BusIndex bus{index};
  const BusUse& use = context.meter.use(bus);
  if (use.efficiency > 0) bus_labels(context, bus, piece).decimal(use.efficiency, 4) << "\n";
}

void write_share_listening(const Context& context, std::uint32_t index, TextWriter& piece) {
  const port::ServiceCounters& service = clients_at(context, index)->counters().service;
  bus_labels(context, BusIndex{index}, piece) << (service.is_listening ? 1 : 0) << "\n";
}
void write_share_clients(const Context& context, std::uint32_t index, TextWriter& piece) {
  bus_labels(context, BusIndex{index}, piece)
      << clients_at(context, index)->counters().service.clients << "\n";
}
void write_share_refused(const Context& context, std::uint32_t index, TextWriter& piece) {
  bus_labels(context, BusIndex{index}, piece)
      << clients_at(context, index)->counters().service.rejected << "\n";
}
void write_share_requests(const Context& context, std::uint32_t index, TextWriter& piece) {
  const port::ClientCounters& counters = clients_at(context, index)->counters();
  const auto result = [&](const char* name, std::uint64_t count) {
    piece << context.name << "{bus=";
    piece.label(bus_label(context.poller(), BusIndex{index}))
        << ",result=\"" << name << "\"} " << count << "\n";
  };
  result("answered", counters.answered);
  result("no_answer", counters.no_answer);
  result("no_path", counters.no_path);
  result("busy", counters.busy);
}
void write_share_seconds(const Context& context, std::uint32_t index, TextWriter& piece) {
  bus_labels(context, BusIndex{index}, piece);
  piece.seconds(context.poller().client_requests(BusIndex{index}).time()) << "\n";
}

constexpr std::array families{
    Family{"etcm_build_info", "gauge", "Version of the gateway.", Scope::gateway, write_build},
    Family{"etcm_uptime_seconds", "gauge", "Time since the gateway was started.", Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain_seconds(context, age_of(context.sources.started_at, context.asked_at), piece);
           }},
    Family{"etcm_generation", "gauge", "Generation of the mesh that was published last.",
           Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().generation, piece);
           }},
    Family{
        "etcm_state", "gauge",
        "1 when something is not in the mesh (partial), a position is not fresh (stale), room or "
        "budget was too small (budget_hit), a node fell silent and has not come back (missing), "
        "or no node of a bus answers (bus_silent).",
        Scope::gateway, write_state},
    Family{"etcm_nodes", "gauge", "Nodes in the mesh.", Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().node_count, piece);
           }},
    Family{"etcm_steiner_vertices", "gauge", "Steiner vertices in the mesh.", Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().steiner_count, piece);
           }},
    Family{"etcm_edges", "gauge", "Edges of the mesh.", Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().edge_count, piece);
           }},
    Family{"etcm_triangles", "gauge", "Triangles of the mesh.", Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().triangle_count, piece);
           }},
    Family{"etcm_features", "gauge", "Features in the mesh, and in the configuration.",
           Scope::gateway, write_features},
    Family{"etcm_quarantined", "gauge", "Nodes and features that the mesh refused.", Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().quarantined_count, piece);
           }},
    Family{"etcm_stale_nodes", "gauge",
           "Nodes in the mesh that have not answered lately, or have no fix.", Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().stale_count, piece);
           }},
    Family{"etcm_missing_nodes", "gauge",
           "Nodes that fell silent, left the mesh for that and have not come back.", Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().missing_count, piece);
           }},
    Family{"etcm_waiting_nodes", "gauge", "Nodes that answer and have not told where they are.",
           Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().waiting_count, piece);
           }},
    Family{"etcm_long_links", "gauge", "Edges longer than the radio range, if one is set.",
           Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().analysis.long_link_count, piece);
           }},
    Family{"etcm_coverage_holes", "gauge", "Worst places out of the sensing range, if one is set.",
           Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.snapshot().analysis.hole_count, piece);
           }},
    Family{"etcm_mesh_changes_total", "counter", "Changes of the mesh done or refused.",
           Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain(context, context.sources.gateway.mesh_times().changes, piece);
           }},
    Family{"etcm_mesh_seconds_total", "counter", "Time that changes of the mesh took.",
           Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain_seconds(context, context.sources.gateway.mesh_times().total, piece);
           }},
    Family{"etcm_mesh_last_seconds", "gauge", "Time that the last change took.", Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain_seconds(context, context.sources.gateway.mesh_times().last, piece);
           }},
    Family{"etcm_mesh_longest_seconds", "gauge", "Time that the longest change took.",
           Scope::gateway,
           [](const Context& context, std::uint32_t, TextWriter& piece) {
             plain_seconds(context, context.sources.gateway.mesh_times().longest, piece);
           }},
    Family{"etcm_disk_trouble", "gauge", "1 where files or state cannot be written now.",
           Scope::gateway, write_disk},
    Family{"etcm_listening", "gauge",
           "1 where clients can connect, 0 where the port cannot be had.", Scope::gateway,
           write_listening},
    Family{"etcm_clients", "gauge", "Clients connected now.", Scope::gateway, write_clients},
    Family{"etcm_requests_total", "counter", "Requests of clients.", Scope::gateway, write_served},
    Family{"etcm_refused_total", "counter",
           "Requests that were wrong, and clients that were rejected.", Scope::gateway,
           write_rejected},
    Family{"process_resident_memory_bytes", "gauge", "Memory of the process that is in RAM.",
           Scope::gateway, write_memory},
    Family{"etcm_bus_busy_seconds_total", "counter",
           "Time in which at least one question was under way.", Scope::bus, write_bus_busy},
    Family{"etcm_bus_floor_seconds_total", "counter",
           "Least time that the bytes and silences of the answered questions need on a serial "
           "line.",
           Scope::bus, write_bus_floor},
    Family{"etcm_bus_utilisation_ratio", "gauge",
           "Part of the last 10 seconds in which a question was under way.", Scope::bus,
           write_bus_utilisation},
    Family{"etcm_bus_efficiency_ratio", "gauge",
           "Of that time, the part that bytes and silences need at least; serial lines only.",
           Scope::bus, write_bus_efficiency},
    Family{"etcm_share_listening", "gauge",
           "1 where others can connect to share the bus, 0 where the port cannot be had.",
           Scope::shared_bus, write_share_listening},
    Family{"etcm_share_clients", "gauge", "Clients that share the bus now.", Scope::shared_bus,
           write_share_clients},
    Family{"etcm_share_requests_total", "counter",
           "Requests of those who share the bus: answered by a unit, no_answer of it, no_path to "
           "it, or busy, because there was no time.",
           Scope::shared_bus, write_share_requests},
    Family{"etcm_share_refused_total", "counter",
           "Requests that may not be sent, and clients that were rejected.", Scope::shared_bus,
           write_share_refused},
    Family{"etcm_share_busy_seconds_total", "counter",
           "Time in which such a request was under way.", Scope::shared_bus, write_share_seconds},
    Family{"etcm_unit_requests_total", "counter", "Questions to a unit.", Scope::unit,
           write_unit_requests},
    Family{"etcm_unit_errors_total", "counter",
           "Questions without a sound answer: torn is one read while the node changed it, "
           "unbelieved one that is not of the node expected, jumped one with a position that "
           "speed_max "
           "does not allow.",
           Scope::unit, write_unit_errors},
    Family{"etcm_unit_answer_seconds", "summary", "Time from a question to its answer.",
           Scope::unit, write_unit_answer},
    Family{"etcm_unit_answer_longest_seconds", "gauge", "The longest of these.", Scope::unit,
           write_unit_answer_max},
    Family{"etcm_bus_silent", "gauge",
           "1 when no node of the bus answers, though some are known there.", Scope::bus,
           write_bus_silent},
    Family{"etcm_node_age_seconds", "gauge", "Time since a node's last position with a fix.",
           Scope::node, write_node_age},
    Family{"etcm_node_silence_seconds", "gauge", "Time since a node's last sound answer.",
           Scope::node, write_node_silence},
    Family{"etcm_node_missing_seconds", "gauge",
           "Of a node that is missing, the time since its last sound answer.", Scope::node,
           write_node_missing},
    Family{
        "etcm_reading", "gauge",
        "What a node measures, in the unit of the label; none while it is stale or the device has "
        "no valid value.",
        Scope::reading, write_reading},
    Family{"etcm_reading_expected", "gauge",
           "What a reading would be by the nodes around it, once a minute.", Scope::reading,
           write_expected},
    Family{"etcm_reading_disagrees", "gauge",
           "1 when a reading has disagreed for some minutes with the nodes around it.",
           Scope::reading, write_disagrees},
    Family{"etcm_reading_age_seconds", "gauge", "Time since the device of a reading was read.",
           Scope::reading, write_reading_age},
};

}  // namespace

bool MetricsDocument::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  if (cursor.section >= families.size()) return false;
  const Family& family = families[cursor.section];
  const Context context{sources_, meter_, asked_at, family.name};
  if (cursor.item == 0) {
    piece << "# HELP " << family.name << " " << family.help << "\n# TYPE " << family.name << " "
          << family.type << "\n";
  }
  const std::uint32_t count = count_of(family.scope, context);
  while (cursor.item < count && !is_shown(family.scope, cursor.item, context)) ++cursor.item;
  if (cursor.item < count) family.write(context, cursor.item++, piece);
  if (cursor.item >= count) cursor.next_section();
  return true;
}

}  // namespace etcm::firmware
