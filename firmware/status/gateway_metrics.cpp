#include <algorithm>

#include "firmware/status/metric_family.h"

namespace etcm::firmware {

namespace {

void plain(const MetricContext& context, std::uint64_t value, TextWriter& piece) {
  piece << context.name << " " << value << "\n";
}

void plain_seconds(const MetricContext& context, port::Duration value, TextWriter& piece) {
  piece << context.name << " ";
  piece.seconds(value) << "\n";
}

void write_build(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{version=";
  piece.label(context.sources.version) << "} 1\n";
}

// Of one that has a name.
void write_site(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const std::string_view name = context.snapshot().names->site();
  if (name.empty()) return;
  piece << context.name << "{site=";
  piece.label(name) << "} 1\n";
}

void write_state(const MetricContext& context, std::uint32_t, TextWriter& piece) {
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

void write_features(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{state=\"active\"} " << context.snapshot().features_active << "\n"
        << context.name << "{state=\"configured\"} " << context.snapshot().features_configured
        << "\n";
}

void write_alarms(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  for (const Severity severity : {Severity::critical, Severity::major, Severity::minor}) {
    piece << context.name << "{severity=\"" << to_string(severity) << "\"} "
          << context.sources.alarms.on_count(severity) << "\n";
  }
}

// Of those that are wanted.
void write_disk(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const auto disk = [&](const char* section, const DiskWriter* writer) {
    if (writer == nullptr) return;
    piece << context.name << "{section=\"" << section << "\"} " << (writer->is_in_trouble() ? 1 : 0)
          << "\n";
  };
  disk("files", context.sources.gateway.disk_of_files());
  disk("state", context.sources.gateway.disk_of_state());
  disk("alarms", context.sources.disk_of_alarms);
}

void write_listening(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{server=\"modbus\"} " << (context.sources.masters.is_listening ? 1 : 0)
        << "\n"
        << context.name << "{server=\"http\"} " << (context.sources.readers.is_listening ? 1 : 0)
        << "\n";
}
void write_clients(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{server=\"modbus\"} " << context.sources.masters.clients << "\n"
        << context.name << "{server=\"http\"} " << context.sources.readers.clients << "\n";
}
void write_served(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{server=\"modbus\"} " << context.sources.masters.requests << "\n"
        << context.name << "{server=\"http\"} " << context.sources.readers.requests << "\n";
}
void write_rejected(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  piece << context.name << "{server=\"modbus\"} " << context.sources.masters.rejected << "\n"
        << context.name << "{server=\"http\"} " << context.sources.readers.rejected << "\n";
}

void write_refused(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const std::string* const refusal = context.sources.refusal;
  plain(context, refusal != nullptr && !refusal->empty() ? 1 : 0, piece);
}

// Of a gateway that is in a fleet.
void write_connected(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const FleetReport* const fleet = context.sources.gateway.fleet();
  if (fleet != nullptr) plain(context, fleet->is_connected ? 1 : 0, piece);
}
void write_agreeing(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const FleetReport* const fleet = context.sources.gateway.fleet();
  if (fleet != nullptr) plain(context, fleet->agreeing, piece);
}
void write_site_number(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const FleetReport* const fleet = context.sources.gateway.fleet();
  if (fleet != nullptr) plain(context, fleet->site_number, piece);
}
void write_site_trouble(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const FleetReport* const fleet = context.sources.gateway.fleet();
  if (fleet != nullptr) plain(context, fleet->site_trouble.empty() ? 0 : 1, piece);
}
void write_members(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const FleetReport* const fleet = context.sources.gateway.fleet();
  if (fleet == nullptr) return;
  for (const MemberState state :
       {MemberState::here, MemberState::waiting, MemberState::gone, MemberState::unknown,
        MemberState::name_taken, MemberState::rejected}) {
    const auto count =
        std::count_if(fleet->members.begin(), fleet->members.end(),
                      [&](const ReportedMember& member) { return member.state == state; });
    piece << context.name << "{state=\"" << to_string(state) << "\"} " << count << "\n";
  }
}

// Of the broker of such a gateway.
template <auto counter>
void write_broker(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const FleetReport* const fleet = context.sources.gateway.fleet();
  if (fleet != nullptr) plain(context, fleet->broker.*counter, piece);
}
void write_messages(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const FleetReport* const fleet = context.sources.gateway.fleet();
  if (fleet == nullptr) return;
  piece << context.name << "{what=\"received\"} " << fleet->broker.received << "\n"
        << context.name << "{what=\"delivered\"} " << fleet->broker.delivered << "\n"
        << context.name << "{what=\"refused\"} " << fleet->broker.refused << "\n";
}
void write_held_limit(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  const bool is_in_fleet = context.sources.gateway.fleet() != nullptr;
  if (is_in_fleet) plain(context, std::uint64_t{port::broker_held_bytes_max}, piece);
}

void write_heap(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  if (context.sources.heap_bytes != nullptr) plain(context, context.sources.heap_bytes(), piece);
}
void write_memory(const MetricContext& context, std::uint32_t, TextWriter& piece) {
  if (context.sources.resident_bytes != nullptr) {
    plain(context, context.sources.resident_bytes(), piece);
  }
}

constexpr MetricFamily gateway_families[] = {
    MetricFamily{"etcm_build_info", "gauge", "Version of the gateway.", MetricScope::gateway,
                 write_build},
    MetricFamily{"etcm_site_info", "gauge", "1, with the name of the site, where it has one.",
                 MetricScope::gateway, write_site},
    MetricFamily{
        "etcm_uptime_seconds", "gauge", "Time since the gateway was started.", MetricScope::gateway,
        [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
          plain_seconds(context, age_of(context.sources.started_at, context.asked_at), piece);
        }},
    MetricFamily{"etcm_generation", "gauge", "Generation of the mesh that was published last.",
                 MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().generation, piece);
                 }},
    MetricFamily{
        "etcm_state", "gauge",
        "1 when something is not in the mesh (partial), a position is not fresh (stale), room or "
        "budget was too small (budget_hit), a node fell silent and has not come back (missing), "
        "or a bus is silent (bus_silent).",
        MetricScope::gateway, write_state},
    MetricFamily{"etcm_nodes", "gauge", "Nodes in the mesh.", MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().node_count, piece);
                 }},
    MetricFamily{"etcm_steiner_vertices", "gauge", "Steiner vertices in the mesh.",
                 MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().steiner_count, piece);
                 }},
    MetricFamily{"etcm_edges", "gauge", "Edges of the mesh.", MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().edge_count, piece);
                 }},
    MetricFamily{"etcm_triangles", "gauge", "Triangles of the mesh.", MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().triangle_count, piece);
                 }},
    MetricFamily{"etcm_features", "gauge", "Features in the mesh, and in the configuration.",
                 MetricScope::gateway, write_features},
    MetricFamily{"etcm_quarantined", "gauge", "Nodes and features that the mesh refused.",
                 MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().quarantined_count, piece);
                 }},
    MetricFamily{"etcm_stale_nodes", "gauge",
                 "Nodes in the mesh that have not answered lately, or have no fix.",
                 MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().stale_count, piece);
                 }},
    MetricFamily{"etcm_alarms", "gauge", "Alarms that are on.", MetricScope::gateway, write_alarms},
    MetricFamily{"etcm_alarms_unacknowledged", "gauge",
                 "Of these, those that nobody has acknowledged.", MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.sources.alarms.unacknowledged_count(), piece);
                 }},
    MetricFamily{"etcm_missing_nodes", "gauge",
                 "Nodes that fell silent, left the mesh for that and have not come back.",
                 MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().missing_count, piece);
                 }},
    MetricFamily{"etcm_absent_units", "gauge",
                 "Units that the settings name one by one and that have never answered.",
                 MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().absent_count, piece);
                 }},
    MetricFamily{"etcm_waiting_nodes", "gauge",
                 "Nodes that answer and have not told where they are.", MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().waiting_count, piece);
                 }},
    MetricFamily{
        "etcm_long_links", "gauge",
        "Links to a neighbour, without relays, longer than the radio range, if one is set.",
        MetricScope::gateway,
        [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
          plain(context, context.snapshot().analysis.long_link_count, piece);
        }},
    MetricFamily{"etcm_coverage_holes", "gauge",
                 "Worst places out of the sensing range, if one is set.", MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.snapshot().analysis.hole_count, piece);
                 }},
    MetricFamily{"etcm_mesh_changes_total", "counter", "Changes of the mesh done or refused.",
                 MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain(context, context.sources.gateway.mesh_times().changes, piece);
                 }},
    MetricFamily{"etcm_mesh_seconds_total", "counter", "Time that changes of the mesh took.",
                 MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain_seconds(context, context.sources.gateway.mesh_times().total, piece);
                 }},
    MetricFamily{"etcm_mesh_last_seconds", "gauge", "Time that the last change took.",
                 MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain_seconds(context, context.sources.gateway.mesh_times().last, piece);
                 }},
    MetricFamily{"etcm_mesh_longest_seconds", "gauge", "Time that the longest change took.",
                 MetricScope::gateway,
                 [](const MetricContext& context, std::uint32_t, TextWriter& piece) {
                   plain_seconds(context, context.sources.gateway.mesh_times().longest, piece);
                 }},
    MetricFamily{"etcm_disk_trouble", "gauge",
                 "1 where files, state or alarms cannot be written now.", MetricScope::gateway,
                 write_disk},
    MetricFamily{"etcm_configuration_refused", "gauge",
                 "1 where the configuration was changed to one that is not taken over.",
                 MetricScope::gateway, write_refused},
    MetricFamily{"etcm_listening", "gauge",
                 "1 where clients can connect, 0 where the port cannot be had.",
                 MetricScope::gateway, write_listening},
    MetricFamily{"etcm_clients", "gauge", "Clients connected now.", MetricScope::gateway,
                 write_clients},
    MetricFamily{"etcm_requests_total", "counter", "Requests of clients.", MetricScope::gateway,
                 write_served},
    MetricFamily{"etcm_refused_total", "counter",
                 "Requests that were wrong, and clients that were rejected.", MetricScope::gateway,
                 write_rejected},
    MetricFamily{"etcm_fleet_connected", "gauge", "1 while the broker of the fleet is connected.",
                 MetricScope::gateway, write_connected},
    MetricFamily{"etcm_fleet_members", "gauge", "Gateways of the fleet, this one among them.",
                 MetricScope::gateway, write_members},
    MetricFamily{"etcm_fleet_agreeing", "gauge", "Those that have the mesh that this one has.",
                 MetricScope::gateway, write_agreeing},
    MetricFamily{"etcm_fleet_site_number", "gauge",
                 "Number of the document of the site that holds; 0 while there is none.",
                 MetricScope::gateway, write_site_number},
    MetricFamily{"etcm_fleet_site_trouble", "gauge",
                 "1 while something is wrong with that document here.", MetricScope::gateway,
                 write_site_trouble},
    MetricFamily{"etcm_mqtt_connections_total", "counter", "Sessions with the broker.",
                 MetricScope::gateway, write_broker<&port::BrokerCounters::connections>},
    MetricFamily{"etcm_mqtt_failures_total", "counter",
                 "Attempts to reach the broker in vain, and sessions that were lost.",
                 MetricScope::gateway, write_broker<&port::BrokerCounters::failures>},
    MetricFamily{"etcm_mqtt_messages_total", "counter", "Messages from the broker and to it.",
                 MetricScope::gateway, write_messages},
    MetricFamily{"etcm_mqtt_held_bytes_most", "gauge",
                 "Most bytes of messages that were sent and not yet delivered at a time.",
                 MetricScope::gateway, write_broker<&port::BrokerCounters::held_bytes_most>},
    MetricFamily{"etcm_mqtt_held_bytes_limit", "gauge", "What these are never more than.",
                 MetricScope::gateway, write_held_limit},
    MetricFamily{"etcm_heap_bytes", "gauge",
                 "Memory that the process has from its heap now, all libraries included.",
                 MetricScope::gateway, write_heap},
    MetricFamily{"process_resident_memory_bytes", "gauge", "Memory of the process that is in RAM.",
                 MetricScope::gateway, write_memory},
};

}  // namespace

std::span<const MetricFamily> gateway_metrics() { return gateway_families; }

}  // namespace etcm::firmware
