// What the gateway and its nodes tell a Sparkplug host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/config/settings.h"
#include "firmware/publish/reading_snapshot.h"
#include "firmware/publish/snapshot.h"
#include "firmware/records/node_table.h"
#include "firmware/sparkplug/payload.h"

namespace etcm::firmware::sparkplug {

// All of it must outlive its users.
struct Sources {
  const NodeTable& nodes;
  const Snapshot& mesh;  // published last
  const ReadingSnapshot& readings;
};

// Metrics of the gateway that can change; beside them a birth has the two that cannot.
inline constexpr std::size_t gateway_metrics_max = 9;

// Whether a host may take its values for those of a device that is there: it answers this gateway.
bool is_alive(const NodeRecord& node);

class Reporter {
 public:
  Reporter(const Sources& sources, const Settings& settings);

  // The site, and which devices there are, may be others.
  void update_settings(const Settings& settings);
  // Metrics of a node at the most.
  std::size_t node_metrics_max() const;

  // What is asked for is reported as of this instant, which is `now_ms` by the time of day.
  void begin(port::Instant now, std::int64_t now_ms);

  // Of these two each is valid until the next of either. Always the same metrics in the same order.
  std::span<const Metric> of_gateway();
  // `told`: the values that were reported of it last; none, or as many as now. The same metrics as
  // last time, unless it has become another device.
  std::span<const Metric> of_node(const NodeRecord& node, std::span<const Value> told);

 private:
  void add(const char* name, std::uint64_t alias, Value value, std::int64_t measured_ms);
  void add_place(const NodeRecord& node, std::span<const Value> told);
  void add_degrees(Position place, bool has_place, std::span<const Value> told);
  void add_reading(const PublishedReading& reading);
  std::int64_t time_of(port::Instant instant) const;
  Value neighbour_count(const NodeRecord& node) const;

  const Sources sources_;
  SitePlane plane_;
  std::size_t readings_max_ = 0;            // of a device
  std::vector<std::string> reading_names_;  // by quantity
  std::vector<Metric> metrics_;
  std::uint64_t first_alias_ = 0;  // of the node that is reported
  std::int64_t place_ms_ = 0;      // when that was where it is
  bool is_stale_ = false;
  port::Instant now_{};
  std::int64_t now_ms_ = 0;
};

}  // namespace etcm::firmware::sparkplug
