#include "firmware/status/metric_family.h"
#include "firmware/status/shown_unit.h"

namespace etcm::firmware {

namespace {

void write_node(const MetricContext& context, Serial serial, port::Duration time,
                TextWriter& piece) {
  piece << context.name << "{serial=\"" << serial.value << "\"} ";
  piece.seconds(time) << "\n";
}

const NodeRecord& record(const MetricContext& context, std::uint32_t index) {
  return context.sources.gateway.nodes().records()[index];
}

void write_node_age(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const NodeRecord& node = record(context, index);
  if (node.is_known() && node.has_position()) {
    write_node(context, node.serial, age_of(node.positioned_at, context.asked_at), piece);
  }
}

void write_node_silence(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const NodeRecord& node = record(context, index);
  if (!node.is_known()) return;
  write_node(context, node.serial, age_of(node.heard_at, context.asked_at), piece);
}

void write_node_missing(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const NodeRecord& node = record(context, index);
  if (!node.is_missing) return;
  write_node(context, node.serial, missing_for(context.sources, node, context.asked_at), piece);
}

void write_node_name(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const NodeRecord& node = record(context, index);
  const std::string_view name = context.sources.gateway.nodes().called(node).name;
  if (!node.is_known() || name.empty()) return;
  piece << context.name << "{serial=\"" << node.serial.value << "\",name=";
  piece.label(name) << "} 1\n";
}

TextWriter& reading_labels(const MetricContext& context, const ReadingRecord& reading,
                           TextWriter& piece) {
  const Quantity& quantity = context.sources.gateway.readings().quantities[reading.quantity.value];
  piece << context.name << "{name=";
  piece.label(quantity.name) << ",unit=";
  return piece.label(quantity.unit) << ",serial=\"" << reading.serial.value << "\"} ";
}

// A series without a sample is how Prometheus is told that there is no value now.
void write_reading(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const ReadingRecord& reading = context.reading(index);
  if (reading.is_stale || !reading.nano) return;
  reading_labels(context, reading, piece).nano(*reading.nano) << "\n";
}

void write_reading_age(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const ReadingRecord& reading = context.reading(index);
  reading_labels(context, reading, piece).seconds(age_of(reading.taken_at, context.asked_at))
      << "\n";
}

// As it was published; null before.
const PublishedReading* published(const MetricContext& context, const ReadingRecord& reading) {
  for (const PublishedReading& found :
       readings_of(context.sources.gateway.readings(), reading.serial)) {
    if (found.quantity == reading.quantity) return &found;
  }
  return nullptr;
}

void write_expected(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const ReadingRecord& reading = context.reading(index);
  const PublishedReading* const shown = published(context, reading);
  if (shown == nullptr || !shown->expected_nano) return;
  reading_labels(context, reading, piece).nano(*shown->expected_nano) << "\n";
}

void write_disagrees(const MetricContext& context, std::uint32_t index, TextWriter& piece) {
  const ReadingRecord& reading = context.reading(index);
  const PublishedReading* const shown = published(context, reading);
  if (shown == nullptr) return;
  reading_labels(context, reading, piece) << (shown->disagrees ? 1 : 0) << "\n";
}

constexpr MetricFamily node_families[] = {
    MetricFamily{"etcm_node_age_seconds", "gauge", "Time since a node's last position with a fix.",
                 MetricScope::node, write_node_age},
    MetricFamily{"etcm_node_silence_seconds", "gauge", "Time since a node's last sound answer.",
                 MetricScope::node, write_node_silence},
    MetricFamily{"etcm_node_missing_seconds", "gauge",
                 "Of a node that is missing, the time since its last sound answer.",
                 MetricScope::node, write_node_missing},
    MetricFamily{"etcm_node_info", "gauge",
                 "1 for each node that has a name, to join with the others by the serial.",
                 MetricScope::node, write_node_name},
    MetricFamily{
        "etcm_reading", "gauge",
        "What a node measures, in the unit of the label; none while it is stale or the device has "
        "no valid value.",
        MetricScope::reading, write_reading},
    MetricFamily{"etcm_reading_expected", "gauge",
                 "What a reading would be by the nodes around it, once a minute.",
                 MetricScope::reading, write_expected},
    MetricFamily{"etcm_reading_disagrees", "gauge",
                 "1 when a reading has disagreed for some minutes with the nodes around it.",
                 MetricScope::reading, write_disagrees},
    MetricFamily{"etcm_reading_age_seconds", "gauge",
                 "Time since the device of a reading was read.", MetricScope::reading,
                 write_reading_age},
};

}  // namespace

std::span<const MetricFamily> node_metrics() { return node_families; }

}  // namespace etcm::firmware
