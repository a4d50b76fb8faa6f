// One metric, and what its samples are written from.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/status/bus_meter.h"
#include "firmware/status/document.h"
#include "firmware/status/status_sources.h"

namespace etcm::firmware {

// What a sample is written from.
struct MetricContext {
  const StatusSources& sources;
  const BusMeter& meter;
  port::Instant asked_at;
  const char* name;

  const Snapshot& snapshot() const { return sources.gateway.snapshot(); }
  const Poller& poller() const { return sources.gateway.poller(); }
  const ReadingRecord& reading(std::uint32_t index) const {
    return sources.gateway.reading_table().records()[index];
  }
  // Null where the bus cannot be shared.
  const port::LineClients* clients(BusIndex bus) const {
    return poller().client_requests(bus).clients();
  }
};

// Of what there is a sample each.
enum class MetricScope : std::uint8_t { gateway, bus, shared_bus, unit, node, reading };

// Its samples are those of the scope, and what write() adds.
struct MetricFamily {
  const char* name;
  const char* type;
  const char* help;
  MetricScope scope;
  void (*write)(const MetricContext& context, std::uint32_t index, TextWriter& piece);
};

// In the order of the document.
std::span<const MetricFamily> gateway_metrics();
std::span<const MetricFamily> bus_metrics();   // and of their sharing and units
std::span<const MetricFamily> node_metrics();  // and of readings

}  // namespace etcm::firmware
