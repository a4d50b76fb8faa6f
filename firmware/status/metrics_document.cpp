#include "firmware/status/metrics_document.h"

#include "firmware/status/metric_family.h"
#include "firmware/status/shown_unit.h"

namespace etcm::firmware {

namespace {

std::uint32_t count_of(MetricScope scope, const MetricContext& context) {
  switch (scope) {
    case MetricScope::gateway:
      return 1;
    case MetricScope::bus:
    case MetricScope::shared_bus:
      return context.poller().bus_count();
    case MetricScope::unit:
      return context.poller().unit_count();
    case MetricScope::node:
      return static_cast<std::uint32_t>(context.sources.gateway.nodes().records().size());
    case MetricScope::reading:
      return static_cast<std::uint32_t>(context.sources.gateway.reading_table().records().size());
  }
  return 0;
}

// A
// reading is that of the node that answered at its unit last.
bool has_sample(MetricScope scope, std::uint32_t index, const MetricContext& context) {
  if (scope == MetricScope::unit) {
    return is_shown(context.poller(), UnitIndex{index});
  }
  if (scope == MetricScope::shared_bus) {
    const port::LineClients* const clients = context.clients(BusIndex{index});
    return clients != nullptr && clients->is_shared();
  }
  if (scope != MetricScope::reading) return true;
  const ReadingRecord& reading = context.reading(index);
  const NodeRecord* const node = context.sources.gateway.nodes().find(reading.serial);
  return node != nullptr && node->last_unit == reading.unit_index;
}

// The family of a section of the document; null behind the last.
const MetricFamily* family_of(std::uint32_t section) {
  for (const auto families : {gateway_metrics(), bus_metrics(), node_metrics()}) {
    if (section < families.size()) return &families[section];
    section -= static_cast<std::uint32_t>(families.size());
  }
  return nullptr;
}

}  // namespace

bool MetricsDocument::write_next(Cursor& cursor, port::Instant asked_at, TextWriter& piece) const {
  const MetricFamily* const found = family_of(cursor.section);
  if (found == nullptr) return false;
  const MetricFamily& family = *found;
  const MetricContext context{sources_, meter_, asked_at, family.name};
  if (cursor.item == 0) {
    piece << "# HELP " << family.name << " " << family.help << "\n# TYPE " << family.name << " "
          << family.type << "\n";
  }
  const std::uint32_t count = count_of(family.scope, context);
  while (cursor.item < count && !has_sample(family.scope, cursor.item, context)) ++cursor.item;
  if (cursor.item < count) family.write(context, cursor.item++, piece);
  if (cursor.item >= count) cursor.next_section();
  return true;
}

}  // namespace etcm::firmware
