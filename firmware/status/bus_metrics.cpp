#include "firmware/status/metric_family.h"

namespace etcm::firmware {

namespace {

using port::BusResult;

// "name_suffix{bus="yard",unit="7"", to be completed by more labels or by "} value".
TextWriter& unit_labels(const MetricContext& context, const char* suffix, UnitIndex unit,
                        TextWriter& piece) {
  piece << context.name << suffix << "{bus=";
  piece.label(bus_label(context.poller(), context.poller().bus_of(unit)));
  return piece << ",unit=\"" << context.poller().address_of(unit).value << "\"";
}

TextWriter& bus_labels(const MetricContext& context, BusIndex bus, TextWriter& piece) {
  piece << context.name << "{bus=";
  return piece.label(bus_label(context.poller(), bus)) << "} ";
}

void write_unit_requests(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const UnitIndex unit{index};
  unit_labels(context, "", unit, piece) << "} " << context.poller().counters(unit).requests << "\n";
}

void write_unit_errors(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
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

void write_unit_answer(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const UnitIndex unit{index};
  const UnitCounters& counters = context.poller().counters(unit);
  unit_labels(context, "_sum", unit, piece) << "} ";
  piece.seconds(counters.answer_time) << "\n";
  unit_labels(context, "_count", unit, piece) << "} " << counters.count(BusResult::ok) << "\n";
}

void write_unit_answer_max(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const UnitIndex unit{index};
  unit_labels(context, "", unit, piece) << "} ";
  piece.seconds(context.poller().counters(unit).answer_time_max) << "\n";
}

void write_bus_silent(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const BusIndex bus{index};
  bus_labels(context, bus, piece) << (context.sources.gateway.presence().is_silent(bus) ? 1 : 0)
                                  << "\n";
}

void write_bus_busy(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const BusIndex bus{index};
  bus_labels(context, bus, piece);
  piece.seconds(context.poller().bus_counters(bus).busy) << "\n";
}
void write_bus_floor(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const BusIndex bus{index};
  bus_labels(context, bus, piece);
  piece.seconds(context.poller().bus_counters(bus).floor) << "\n";
}
void write_bus_utilisation(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const BusIndex bus{index};
  bus_labels(context, bus, piece).decimal(context.meter.use(bus).utilisation, 4) << "\n";
}
void write_bus_efficiency(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const BusIndex bus{index};
  const BusUse& use = context.meter.use(bus);
  if (use.efficiency > 0) bus_labels(context, bus, piece).decimal(use.efficiency, 4) << "\n";
}

void write_share_listening(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const port::ServiceCounters& service = context.clients(BusIndex{index})->counters().service;
  bus_labels(context, BusIndex{index}, piece) << (service.is_listening ? 1 : 0) << "\n";
}
void write_share_clients(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  bus_labels(context, BusIndex{index}, piece)
      << context.clients(BusIndex{index})->counters().service.clients << "\n";
}
void write_share_refused(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  bus_labels(context, BusIndex{index}, piece)
      << context.clients(BusIndex{index})->counters().service.rejected << "\n";
}
void write_share_requests(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const port::ClientCounters& counters = context.clients(BusIndex{index})->counters();
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
void write_share_seconds(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  bus_labels(context, BusIndex{index}, piece);
  piece.seconds(context.poller().client_requests(BusIndex{index}).time()) << "\n";
}

constexpr MetricFamily bus_families[] = {
    MetricFamily{"etcm_bus_busy_seconds_total", "counter",
                 "Time in which at least one question was under way.", MetricScope::bus,
                 write_bus_busy},
    MetricFamily{
        "etcm_bus_floor_seconds_total", "counter",
        "Least time that the bytes and silences of the answered questions need on a serial "
        "line.",
        MetricScope::bus, write_bus_floor},
    MetricFamily{"etcm_bus_utilisation_ratio", "gauge",
                 "Part of the last 10 seconds in which a question was under way.", MetricScope::bus,
                 write_bus_utilisation},
    MetricFamily{"etcm_bus_efficiency_ratio", "gauge",
                 "Of that time, the part that bytes and silences need at least; serial lines only.",
                 MetricScope::bus, write_bus_efficiency},
    MetricFamily{"etcm_share_listening", "gauge",
                 "1 where others can connect to share the bus, 0 where the port cannot be had.",
                 MetricScope::shared_bus, write_share_listening},
    MetricFamily{"etcm_share_clients", "gauge", "Clients that share the bus now.",
                 MetricScope::shared_bus, write_share_clients},
    MetricFamily{
        "etcm_share_requests_total", "counter",
        "Requests of those who share the bus: answered by a unit, no_answer of it, no_path to "
        "it, or busy, because there was no time.",
        MetricScope::shared_bus, write_share_requests},
    MetricFamily{"etcm_share_refused_total", "counter",
                 "Requests that may not be sent, and clients that were rejected.",
                 MetricScope::shared_bus, write_share_refused},
    MetricFamily{"etcm_share_busy_seconds_total", "counter",
                 "Time in which such a request was under way.", MetricScope::shared_bus,
                 write_share_seconds},
    MetricFamily{"etcm_unit_requests_total", "counter", "Questions to a unit.", MetricScope::unit,
                 write_unit_requests},
    MetricFamily{"etcm_unit_errors_total", "counter",
                 "Questions without a sound answer: torn is one read while the node changed it, "
                 "unbelieved one that is not of the node expected, jumped one with a position that "
                 "speed_max does not allow.",
                 MetricScope::unit, write_unit_errors},
    MetricFamily{"etcm_unit_answer_seconds", "summary", "Time from a question to its answer.",
                 MetricScope::unit, write_unit_answer},
    MetricFamily{"etcm_unit_answer_longest_seconds", "gauge", "The longest of these.",
                 MetricScope::unit, write_unit_answer_max},
    MetricFamily{"etcm_bus_silent", "gauge",
                 "1 when no node of the bus answers, or none of its units has since the start.",
                 MetricScope::bus, write_bus_silent},
};

}  // namespace

std::span<const MetricFamily> bus_metrics() { return bus_families; }

}  // namespace etcm::firmware
