#include "firmware/sparkplug/reporter.h"

#include <algorithm>

namespace etcm::firmware::sparkplug {

namespace {

using namespace std::chrono_literals;

// Of a node, beside its readings; they are its first aliases and the first values that are told.
enum NodeMetric : std::uint8_t {
  x,
  y,
  longitude,
  latitude,
  fix,
  stale,
  in_mesh,
  neighbours,
  low_battery,
  node_metrics
};
constexpr std::uint64_t first_reading_alias = 64;
static_assert(node_metrics <= first_reading_alias);
// So many aliases each node has; those below are the gateway's.
constexpr int alias_bits = 16;

constexpr std::string_view reading_folder = "Readings/";
static_assert(reading_folder.size() + reading_name_max <= metric_name_max);
static_assert(reading_unit_max <= metric_unit_max);

// The same whatever else is known, now and in another run.
std::uint64_t first_alias_of(Serial serial) {
  return (std::uint64_t{serial.value} + 1) << alias_bits;
}

std::size_t most_readings(const Settings& settings) {
  std::size_t most = 0;
  for (const BusSettings& bus : settings.buses) {
    for (const DeviceSettings& device : bus.devices) {
      if (const Profile* const profile = find_profile(settings, device.profile)) {
        most = std::max(most, profile->readings.size());
      }
    }
  }
  return most;
}

}  // namespace

bool is_alive(const NodeRecord& node) {
  if (!node.is_known() || node.is_foreign() || node.is_missing) return false;
  // Nobody watches whether one that has left still answers.
  if (node.has_asked_to_leave() && !node.is_placed()) return false;
  return !node.stale || node.lacks_fix;
}

Reporter::Reporter(const Sources& sources, const Settings& settings) : sources_(sources) {
  update_settings(settings);
}

void Reporter::update_settings(const Settings& settings) {
  plane_ = settings.site.plane();
  readings_max_ = std::max(readings_max_, most_readings(settings));
  metrics_.reserve(std::max(node_metrics_max(), gateway_metrics_max));
  // Those of other gateways behind them are numbered anew.
  const ReadingSnapshot& readings = sources_.readings;
  for (std::size_t i = reading_names_.size(); i < readings.own_quantity_count; ++i) {
    reading_names_.push_back(std::string(reading_folder) + readings.quantities[i].name);
  }
}

std::size_t Reporter::node_metrics_max() const { return node_metrics + readings_max_; }

void Reporter::begin(port::Instant now, std::int64_t now_ms) {
  now_ = now;
  now_ms_ = now_ms;
}

std::span<const Metric> Reporter::of_gateway() {
  const Snapshot& mesh = sources_.mesh;
  metrics_.clear();
  std::uint64_t alias = 0;
  const auto add_count = [&](const char* name, std::uint32_t count) {
    add(name, ++alias, Value::count(count), now_ms_);
  };
  add_count("Mesh/Generation", mesh.generation);
  add("Mesh/Hash", ++alias, Value::hex(mesh.mesh_hash), now_ms_);
  add_count("Mesh/State", mesh.state);
  add_count("Mesh/Nodes", mesh.node_count);
  add_count("Mesh/Steiner vertices", mesh.steiner_count);
  add_count("Mesh/Features", mesh.features_active);
  add_count("Mesh/Features configured", mesh.features_configured);
  add_count("Nodes/Stale", mesh.stale_count);
  add_count("Nodes/Missing", mesh.missing_count);
  return metrics_;
}

std::span<const Metric> Reporter::of_node(const NodeRecord& node, std::span<const Value> told) {
  metrics_.clear();
  first_alias_ = first_alias_of(node.serial);
  place_ms_ = time_of(node.positioned_at);
  is_stale_ = node.stale;
  add_place(node, told);
  const auto add_own = [&](const char* name, NodeMetric metric, Value value) {
    add(name, first_alias_ + metric, value, now_ms_);
  };
  add_own("Position/Fix", fix, Value::yes_no((node.status & node_status::fix_valid) != 0));
  add_own("Position/Stale", stale, Value::yes_no(node.stale));
  add_own("Mesh/In mesh", in_mesh, Value::yes_no(node.is_placed()));
  add_own("Mesh/Neighbours", neighbours, neighbour_count(node));
  add_own("Low battery", low_battery, Value::yes_no((node.status & node_status::low_battery) != 0));
  for (const PublishedReading& reading : readings_of(sources_.readings, node.serial)) {
    // A reload may have added some whose settings have not come here yet.
    if (metrics_.size() < node_metrics_max()) add_reading(reading);
  }
  return metrics_;
}

void Reporter::add(const char* name, std::uint64_t alias, Value value, std::int64_t measured_ms) {
  metrics_.push_back({.name = name, .alias = alias, .measured_ms = measured_ms, .value = value});
}

// Where the mesh has it; where the mesh does not have it, where it says that it is.
void Reporter::add_place(const NodeRecord& node, std::span<const Value> told) {
  const bool has_place = node.is_placed() || node.has_position();
  const Position place = node.is_placed() ? node.placed : node.position;
  const auto add_coordinate = [&](const char* name, NodeMetric metric, std::int32_t coordinate) {
    Value value = has_place ? Value::whole(coordinate) : Value::none(Kind::int32);
    value.is_stale = is_stale_;
    add(name, first_alias_ + metric, value, place_ms_);
  };
  add_coordinate("Position/X", x, place.x);
  add_coordinate("Position/Y", y, place.y);
  if (plane_.projection != nullptr) add_degrees(place, has_place, told);
}

// A projection takes its time; a node that stands still costs none.
void Reporter::add_degrees(Position place, bool has_place, std::span<const Value> told) {
  Value east = Value::none(Kind::real);
  Value north = Value::none(Kind::real);
  if (told.size() > latitude && told[x].bits == metrics_[x].value.bits &&
      told[y].bits == metrics_[y].value.bits && told[x].is_null == !has_place) {
    east = told[longitude];
    north = told[latitude];
  } else if (has_place) {
    if (const auto degrees = earth_point(plane_, to_point(place))) {
      east = Value::real(static_cast<double>(degrees->longitude) / 1e9);
      north = Value::real(static_cast<double>(degrees->latitude) / 1e9);
    }
  }
  east.is_stale = north.is_stale = is_stale_;
  add("Position/Longitude", first_alias_ + longitude, east, place_ms_);
  add("Position/Latitude", first_alias_ + latitude, north, place_ms_);
}

void Reporter::add_reading(const PublishedReading& reading) {
  if (reading.quantity.value >= reading_names_.size()) return;
  Value value = reading.nano ? Value::real(static_cast<double>(*reading.nano) / 1e9)
                             : Value::none(Kind::real);
  value.is_stale = reading.is_stale;
  metrics_.push_back({.name = reading_names_[reading.quantity.value],
                      .unit = sources_.readings.quantities[reading.quantity.value].unit,
                      .alias = first_alias_ + first_reading_alias + reading.quantity.value,
                      .measured_ms = time_of(reading.taken_at),
                      .value = value});
}

// None is told as now.
std::int64_t Reporter::time_of(port::Instant instant) const {
  if (instant == port::Instant{}) return now_ms_;
  return now_ms_ - (now_ - instant) / 1ms;
}

Value Reporter::neighbour_count(const NodeRecord& node) const {
  if (!node.is_placed()) return Value::whole(0);
  // It may have joined since the mesh was published.
  const std::uint32_t row = node.vertex.value - 1u;
  const auto& vertices = sources_.mesh.vertices;
  const bool is_there = row < vertices.size() && vertices[row].serial == node.serial;
  return is_there ? Value::whole(vertices[row].degree) : Value::none(Kind::int32);
}

}  // namespace etcm::firmware::sparkplug
