#include "firmware/persist/saved_state.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <utility>

#include "etcm/port/bytes.h"
#include "firmware/config/fleet_settings.h"
#include "firmware/config/unit_count.h"
#include "firmware/fleet/fleet_member.h"
#include "firmware/records/node_table.h"

namespace etcm::firmware {

namespace {

enum Section : std::size_t {
  buses,
  nodes,
  anchors,
  features,
  steiner,
  missing,
  quantities,
  sensors,
  kinds
};

constexpr std::size_t counts_at = 20;
constexpr std::size_t time_at = counts_at + kinds * 4;
constexpr std::size_t flags_at = time_at + 8;
constexpr std::size_t head_size = flags_at + 4;
constexpr std::uint32_t oldest_version = 1;
constexpr std::uint32_t first_version_with_flags = 4;
constexpr std::uint32_t first_version_with_silences = 5;
constexpr std::uint32_t flag_canonical = 1;
constexpr std::uint32_t flag_fleet = 2;
constexpr std::uint32_t flag_last = 4;
constexpr std::uint32_t flag_plane = 8;
// How many kinds of records a form has.
constexpr std::size_t kinds_of(std::uint32_t version) {
  return version == 1 ? missing : version == 2 ? quantities : kinds;
}
constexpr std::size_t node_size = 24;
constexpr std::size_t node_size_without_silence = 20;
constexpr std::size_t anchor_size = 8;
constexpr std::size_t feature_size = 8;
constexpr std::size_t steiner_size = 20;
constexpr std::size_t quantity_size_least = 2;
constexpr std::size_t quantity_size_max = quantity_size_least + reading_name_max + reading_unit_max;
constexpr std::size_t sensor_size = 124;
constexpr std::size_t crs_size_max = 255;
constexpr std::size_t plane_size_max = 26 + crs_size_max;
constexpr std::uint8_t flag_silent = 1;
constexpr std::uint8_t flag_about_place = 1;
constexpr std::uint8_t flag_position = 1;
constexpr std::uint8_t flag_disagrees = 1;
constexpr std::uint8_t flag_slow_change = 2;
constexpr std::uint8_t flag_noisy = 4;
constexpr unsigned ended_alarms_shift = 3;  // two bits, behind the flags
// A silence that goes on is as good as another one each hour.
constexpr std::uint32_t seconds_per_hour = 3600;

double take_real(port::ByteReader& reader) {
  return std::bit_cast<double>(reader.take<std::uint64_t>());
}

std::string_view take_short_text(port::ByteReader& reader) {
  return reader.take_text(reader.take<std::uint8_t>());
}

// In the order in which they are saved.
std::array<double*, 10> numbers_of(LearnedSensor& sensor) {
  return {&sensor.reference, &sensor.followed,  &sensor.slow_change, &sensor.slow_residual,
          &sensor.residual,  &sensor.roughness, &sensor.step,        &sensor.wander,
          &sensor.rise,      &sensor.fall};
}

Position take_position(port::ByteReader& reader) {
  Position position;
  position.x = reader.take<std::int32_t>();
  position.y = reader.take<std::int32_t>();
  return position;
}

SavedNode take_node(port::ByteReader& reader, bool has_silence, std::uint8_t& flags) {
  SavedNode node;
  node.serial = Serial{reader.take<std::uint32_t>()};
  node.position = take_position(reader);
  node.age_ms = reader.take<std::uint32_t>();
  node.bus = reader.take<std::uint16_t>();
  node.address = reader.take<std::uint8_t>();
  flags = reader.take<std::uint8_t>();
  if (has_silence) node.silence_s = reader.take<std::uint32_t>();
  return node;
}

LearnedSensor take_sensor(port::ByteReader& reader) {
  LearnedSensor sensor;
  sensor.serial = Serial{reader.take<std::uint32_t>()};
  sensor.quantity = QuantityIndex{reader.take<std::uint16_t>()};
  const auto flags = reader.take<std::uint8_t>();
  sensor.disagrees = (flags & flag_disagrees) != 0;
  sensor.has_slow_change = (flags & flag_slow_change) != 0;
  sensor.is_noisy = (flags & flag_noisy) != 0;
  sensor.ended_alarms = static_cast<std::uint8_t>(flags >> ended_alarms_shift & 3u);
  sensor.sample_count = reader.take<std::uint8_t>();
  sensor.definition = reader.take<std::uint64_t>();
  sensor.point.x = reader.take<std::int64_t>();
  sensor.point.y = reader.take<std::int64_t>();
  sensor.age_s = reader.take<std::uint32_t>();
  for (double* const number : numbers_of(sensor)) *number = take_real(reader);
  sensor.residual_count = reader.take<std::uint16_t>();
  sensor.roughness_count = reader.take<std::uint16_t>();
  sensor.step_count = reader.take<std::uint16_t>();
  sensor.wander_count = reader.take<std::uint16_t>();
  return sensor;
}

DocumentPlane take_plane(port::ByteReader& reader) {
  DocumentPlane plane;
  plane.is_about_place = (reader.take<std::uint8_t>() & flag_about_place) != 0;
  plane.crs = take_short_text(reader);
  plane.unit = reader.take<std::int64_t>();
  plane.x = reader.take<std::int64_t>();
  plane.y = reader.take<std::int64_t>();
  return plane;
}

template <class Value, class Key>
bool has_twins(const std::vector<Value>& values, Key key) {
  using KeyValue = decltype(key(values.front()));
  std::vector<KeyValue> keys;
  keys.reserve(values.size());
  for (const Value& value : values) keys.push_back(key(value));
  std::sort(keys.begin(), keys.end());
  return std::adjacent_find(keys.begin(), keys.end()) != keys.end();
}

// What the mesh itself does not find when it is given such a state.
std::string judge(const SavedState& state) {
  if (state.next_generation <= state.generation) return "its generations contradict each other";
  std::vector<SavedNode> known = state.nodes;
  for (const SavedMissing& each : state.missing) known.push_back(each.node);
  for (const SavedNode& node : known) {
    if (node.serial.is_none()) return "a node has no serial";
    if (node.bus != no_saved_bus && node.bus >= state.buses.size()) {
      return "node " + std::to_string(node.serial.value) + " is on a bus it does not name";
    }
  }
  if (has_twins(known, [](const SavedNode& node) { return node.serial; })) {
    return "two nodes have one serial";
  }
  if (state.plane && state.plane->unit <= 0) return "its plane has no unit";
  const std::size_t ends = state.nodes.size() + state.anchors.size();
  for (const SavedFeature& feature : state.features) {
    if (feature.from >= ends || feature.to >= ends) return "a feature ends at no node";
  }
  if (state.is_canonical && !state.steiner.empty()) return "its mesh contradicts itself";
  const bool are_on_features =
      std::all_of(state.steiner.begin(), state.steiner.end(),
                  [&](const SteinerPlace& place) { return place.feature < state.features.size(); });
  if (!are_on_features) return "a Steiner vertex is on no feature";
  for (LearnedSensor sensor : state.sensors) {
    if (sensor.quantity.value >= state.quantities.size()) {
      return "a sensor measures what it does not name";
    }
    const auto numbers = numbers_of(sensor);
    if (std::any_of(numbers.begin(), numbers.end(),
                    [](const double* number) { return !std::isfinite(*number); })) {
      return "what it says of a sensor is no number";
    }
  }
  return "";
}

}  // namespace

std::string decode_state(std::span<const std::byte> bytes, SavedState& state) {
  state = {};
  port::ByteReader reader(bytes);
  const auto version = reader.take<std::uint32_t>();
  if (reader.is_cut_off()) return "it is cut off";
  if (version < oldest_version || version > saved_state_version) {
    return std::string("it is from ") + (version > saved_state_version ? "a newer" : "an older") +
           " gateway (form " + std::to_string(version) + ", this one knows " +
           std::to_string(saved_state_version) + ")";
  }
  state.generation = reader.take<std::uint32_t>();
  state.next_generation = reader.take<std::uint32_t>();
  state.mesh_hash = reader.take<std::uint64_t>();
  std::uint32_t counts[kinds] = {};
  for (std::size_t kind = 0; kind < kinds_of(version); ++kind) {
    counts[kind] = reader.take<std::uint32_t>();
  }
  if (kinds_of(version) == kinds) state.saved_at_s = reader.take<std::int64_t>();
  const std::uint32_t state_flags =
      version >= first_version_with_flags ? reader.take<std::uint32_t>() : 0;
  state.is_canonical = (state_flags & flag_canonical) != 0;
  state.is_last = (state_flags & flag_last) != 0;

  const auto each = [&](Section section, std::size_t size_least, auto take) {
    if (!reader.has(counts[section], size_least)) {
      static_cast<void>(reader.take_bytes(reader.left() + 1));
      return;
    }
    for (std::uint32_t i = 0; i < counts[section] && !reader.is_cut_off(); ++i) take();
  };
  each(buses, 1, [&] { state.buses.emplace_back(take_short_text(reader)); });
  const bool has_silences = version >= first_version_with_silences;
  each(nodes, has_silences ? node_size : node_size_without_silence, [&] {
    std::uint8_t flags = 0;
    state.nodes.push_back(take_node(reader, has_silences, flags));
    state.nodes.back().is_silent = has_silences && (flags & flag_silent) != 0;
  });
  each(anchors, anchor_size, [&] { state.anchors.push_back(take_position(reader)); });
  each(features, feature_size, [&] {
    SavedFeature feature;
    feature.from = reader.take<std::uint32_t>();
    feature.to = reader.take<std::uint32_t>();
    state.features.push_back(feature);
  });
  each(steiner, steiner_size, [&] {
    SteinerPlace place;
    place.feature = reader.take<std::uint32_t>();
    place.point.x = reader.take<std::int64_t>();
    place.point.y = reader.take<std::int64_t>();
    state.steiner.push_back(place);
  });
  each(missing, node_size, [&] {
    std::uint8_t flags = 0;
    const SavedNode node = take_node(reader, true, flags);
    state.missing.push_back({.node = node, .has_position = (flags & flag_position) != 0});
  });
  each(quantities, quantity_size_least, [&] {
    Quantity quantity;
    quantity.name = take_short_text(reader);
    quantity.unit = take_short_text(reader);
    state.quantities.push_back(std::move(quantity));
  });
  each(sensors, sensor_size, [&] { state.sensors.push_back(take_sensor(reader)); });
  if ((state_flags & flag_plane) != 0) state.plane = take_plane(reader);
  if (reader.is_cut_off()) return "it is cut off";
  if ((state_flags & flag_fleet) != 0) {
    const std::span<const std::byte> fleet = reader.take_bytes(reader.left());
    state.fleet.assign(fleet.begin(), fleet.end());
  }
  if (reader.left() != 0) return "it is too long";
  return judge(state);
}

std::size_t saved_state_size_max(const Settings& settings) {
  std::size_t size = head_size + plane_size_max;
  for (const BusSettings& bus : settings.buses) size += 1 + saved_bus_name(bus.name).size();
  const std::size_t buses_room = std::max<std::size_t>(settings.room.buses, settings.buses.size());
  size += (buses_room - settings.buses.size()) * (1 + saved_bus_name_max);
  // A vertex is a node, an anchor or a Steiner vertex; a feature in the mesh takes a place of its.
  size += settings.mesh.vertices_max * std::max({node_size, anchor_size, steiner_size});
  size += settings.mesh.features_max * feature_size;
  size += quantities_of(settings).size() * quantity_size_max;
  size += count_readings(settings) * sensor_size;
  if (settings.mqtt) size += save_bytes_max(fleet_settings_of(settings));
  return size +
         node_record_capacity(std::max(count_units(settings), settings.room.units)) * node_size;
}

StateWriter::StateWriter(std::size_t size_max) { bytes_.reserve(size_max); }

template <class Value>
void StateWriter::put_content(Value value) {
  port::put_number(bytes_, value);
  mix(static_cast<std::uint64_t>(value));
}

void StateWriter::mix(std::uint64_t value) {
  content_ = (content_ ^ value) * 0x9e3779b97f4a7c15u;
  content_ ^= content_ >> 32;
}

void StateWriter::begin(std::uint32_t generation, std::uint32_t next_generation,
                        std::uint64_t mesh_hash, std::int64_t time_of_day_s) {
  bytes_.clear();
  content_ = 0;
  is_canonical_ = is_last_ = has_plane_ = has_fleet_ = false;
  std::fill(std::begin(counts_), std::end(counts_), 0u);
  port::put_number(bytes_, saved_state_version);
  port::put_number(bytes_, generation);
  port::put_number(bytes_, next_generation);
  put_content(mesh_hash);
  bytes_.resize(time_at);  // the counts, and then the flags, come in finish()
  port::put_number(bytes_, time_of_day_s);
  bytes_.resize(head_size);
}

void StateWriter::add_bus(std::string_view name) {
  name = saved_bus_name(name);
  count(buses);
  put_content(static_cast<std::uint8_t>(name.size()));
  for (const char c : name) put_content(static_cast<std::uint8_t>(c));
}

void StateWriter::add(const SavedNode& node) {
  count(nodes);
  put_node(node, node.is_silent ? flag_silent : std::uint8_t{0});
  if (node.is_silent) mix(node.silence_s / seconds_per_hour);
}

void StateWriter::put_node(const SavedNode& node, std::uint8_t flags) {
  put_content(node.serial.value);
  put_content(node.position.x);
  put_content(node.position.y);
  port::put_number(bytes_, node.age_ms);
  put_content(node.bus);
  put_content(node.address);
  put_content(flags);
  port::put_number(bytes_, node.silence_s);
}

void StateWriter::add(Position anchor) {
  count(anchors);
  put_content(anchor.x);
  put_content(anchor.y);
}

void StateWriter::add(const SavedFeature& feature) {
  count(features);
  put_content(feature.from);
  put_content(feature.to);
}

void StateWriter::add(const SteinerPlace& place) {
  count(steiner);
  put_content(place.feature);
  put_content(place.point.x);
  put_content(place.point.y);
}

void StateWriter::add(const SavedMissing& each) {
  count(missing);
  put_node(each.node, each.has_position ? flag_position : std::uint8_t{0});
  mix(each.node.silence_s / seconds_per_hour);
}

void StateWriter::add(const Quantity& quantity) {
  count(quantities);
  for (const std::string& text : {std::cref(quantity.name), std::cref(quantity.unit)}) {
    port::put_number(bytes_, static_cast<std::uint8_t>(text.size()));
    for (const char c : text) port::put_number(bytes_, static_cast<std::uint8_t>(c));
  }
}

void StateWriter::add(const LearnedSensor& sensor) {
  count(sensors);
  port::put_number(bytes_, sensor.serial.value);
  port::put_number(bytes_, static_cast<std::uint16_t>(sensor.quantity.value));
  port::put_number(bytes_,
                   static_cast<std::uint8_t>((sensor.disagrees ? flag_disagrees : 0) |
                                             (sensor.has_slow_change ? flag_slow_change : 0) |
                                             (sensor.is_noisy ? flag_noisy : 0) |
                                             (sensor.ended_alarms & 3u) << ended_alarms_shift));
  port::put_number(bytes_, static_cast<std::uint8_t>(sensor.sample_count));
  port::put_number(bytes_, sensor.definition);
  port::put_number(bytes_, sensor.point.x);
  port::put_number(bytes_, sensor.point.y);
  port::put_number(bytes_, sensor.age_s);
  LearnedSensor numbers = sensor;
  for (const double* const number : numbers_of(numbers)) {
    port::put_number(bytes_, std::bit_cast<std::uint64_t>(*number));
  }
  port::put_number(bytes_, static_cast<std::uint16_t>(sensor.residual_count));
  port::put_number(bytes_, static_cast<std::uint16_t>(sensor.roughness_count));
  port::put_number(bytes_, static_cast<std::uint16_t>(sensor.step_count));
  port::put_number(bytes_, static_cast<std::uint16_t>(sensor.wander_count));
}

void StateWriter::add(const DocumentPlane& plane) {
  const std::string_view crs = plane.crs;
  if (crs.size() > crs_size_max) return;
  has_plane_ = true;
  put_content(plane.is_about_place ? flag_about_place : std::uint8_t{0});
  put_content(static_cast<std::uint8_t>(crs.size()));
  for (const char c : crs) put_content(static_cast<std::uint8_t>(c));
  put_content(plane.unit);
  put_content(plane.x);
  put_content(plane.y);
}

void StateWriter::add_fleet(std::span<const std::byte> fleet) {
  has_fleet_ = true;
  bytes_.insert(bytes_.end(), fleet.begin(), fleet.end());
  for (const std::byte byte : fleet) mix(std::to_integer<std::uint64_t>(byte));
}

std::span<const std::byte> StateWriter::finish() {
  const auto set = [this](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) bytes_[at + i] = static_cast<std::byte>(value >> (8 * i));
  };
  for (std::size_t kind = 0; kind < kinds; ++kind) set(counts_at + 4 * kind, counts_[kind]);
  set(flags_at, (is_canonical_ ? flag_canonical : 0) | (has_fleet_ ? flag_fleet : 0) |
                    (is_last_ ? flag_last : 0) | (has_plane_ ? flag_plane : 0));
  return bytes_;
}

}  // namespace etcm::firmware
