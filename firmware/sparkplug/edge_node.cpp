#include "firmware/sparkplug/edge_node.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <numeric>

#include "firmware/config/unit_count.h"

namespace etcm::firmware::sparkplug {

namespace {

using namespace std::chrono_literals;

// In one step; polling must not wait for more.
constexpr int messages_max = 64;
constexpr int looks_max = 512;
// Until a broker that took no more is asked again.
constexpr port::Duration room_pause = 20ms;
constexpr std::size_t serial_digits_max = 10;
// A command that is longer asks for nothing: it would take its time to look through.
constexpr std::size_t command_bytes_max = 4096;

std::uint64_t shape_of(std::span<const Metric> metrics) {
  std::uint64_t shape = 0xcbf29ce484222325;
  for (const Metric& metric : metrics) shape = (shape ^ metric.alias) * 0x100000001b3;
  return shape;
}

void keep_told(std::span<const Metric> metrics, std::span<Value> told) {
  for (std::size_t i = 0; i < metrics.size(); ++i) told[i] = metrics[i].value;
}

Metric birth_sequence_metric(std::uint8_t number, std::int64_t now_ms) {
  return {.name = "bdSeq", .measured_ms = now_ms, .value = Value::count(number)};
}

}  // namespace

EdgeNode::EdgeNode(const EdgeNodeNames& names, const Settings& settings, port::Duration pause,
                   const Sources& sources, port::MessageBroker& broker,
                   const port::WallClock& clock)
    : names_(names),
      pause_(pause),
      sources_(sources),
      broker_(broker),
      clock_(clock),
      reporter_(sources, settings),
      birth_(topic_of("NBIRTH", false)),
      data_(topic_of("NDATA", false)),
      device_birth_(topic_of("DBIRTH", true)),
      device_death_(topic_of("DDEATH", true)),
      device_data_(topic_of("DDATA", true)),
      commands_(topic_of("NCMD", false).text),
      writer_({}) {
  update_settings(settings);
  broker_.set_listener(this);
  set_last_will();
  broker_.subscribe(std::array{commands_});
}

EdgeNode::Topic EdgeNode::topic_of(const char* type, bool is_of_device) const {
  Topic topic{.text = "spBv1.0/" + names_.group + "/" + type + "/" + names_.edge_node +
                      (is_of_device ? "/" : "")};
  topic.stem = topic.text.size();
  if (is_of_device) topic.text.reserve(topic.stem + serial_digits_max);
  return topic;
}

void EdgeNode::update_settings(const Settings& settings) {
  reporter_.update_settings(settings);
  told_max_ = reporter_.node_metrics_max();
  devices_.resize(sources_.nodes.records().size());
  // Nodes of other gateways have records too, and are no devices.
  const std::size_t places =
      node_record_capacity(std::max(count_units(settings), settings.room.units));
  told_.assign(places * told_max_, {});
  free_places_.reserve(places);
  forget_births();
  const std::size_t most = std::max(told_max_, gateway_metrics_max + 2);
  order_.reserve(most);
  room_.resize(payload_bytes_max(most));
  writer_ = PayloadWriter(room_);
  is_under_way_ = false;
  wants_births_ = is_connected_;
}

// Each connection has a will of its own; a host knows by the number which birth it ends.
void EdgeNode::set_last_will() {
  const std::int64_t now_ms = clock_.milliseconds();
  writer_.begin(now_ms);
  writer_.add_birth(birth_sequence_metric(birth_sequence_, now_ms));
  broker_.set_last_will(
      {.topic = topic_of("NDEATH", false).text, .payload = writer_.finish(std::nullopt)});
}

void EdgeNode::on_connected(port::Instant now) {
  is_connected_ = wants_births_ = true;
  births_due_ = now;
}

void EdgeNode::on_disconnected(std::string_view, port::Instant) {
  is_connected_ = wants_births_ = is_under_way_ = false;
  ++birth_sequence_;
  set_last_will();
}

void EdgeNode::on_message(const port::BrokerMessage& message, port::Instant) {
  // One that the broker kept was for an earlier connection.
  if (message.retained || message.topic != commands_) return;
  if (message.payload.size() > command_bytes_max || !asks_for_rebirth(message.payload)) return;
  wants_births_ = true;
  if (!is_birth_) is_under_way_ = false;
}

void EdgeNode::step(port::Instant now) {
  if (!is_connected_ || now < blocked_until_) return;
  if (!is_under_way_) {
    if (wants_births_) {
      if (births_due_ <= now) begin_births(now);
    } else if (round_due_ <= now) {
      is_under_way_ = true;
      is_birth_ = is_gateway_told_ = false;
      next_slot_ = 0;
      round_due_ = now + pause_;
    }
  }
  if (is_under_way_) go_on(now);
}

port::Instant EdgeNode::next_deadline() const {
  if (!is_connected_) return port::never;
  if (is_under_way_) return blocked_until_;
  return std::max(blocked_until_, wants_births_ ? births_due_ : round_due_);
}

void EdgeNode::begin_births(port::Instant now) {
  wants_births_ = false;
  is_under_way_ = is_birth_ = true;
  is_gateway_told_ = false;
  next_slot_ = 0;
  births_due_ = now + rebirth_pause;
  round_due_ = now + pause_;
  forget_births();
}

void EdgeNode::forget_births() {
  for (Device& device : devices_) device.place = no_place;
  free_places_.resize(told_.size() / told_max_);
  std::iota(free_places_.begin(), free_places_.end(), 0u);
}

void EdgeNode::go_on(port::Instant now) {
  now_ms_ = clock_.milliseconds();
  reporter_.begin(now, now_ms_);
  int sent = 0;
  for (int looks = 0; looks < looks_max && sent < messages_max; ++looks) {
    if (is_gateway_told_ && next_slot_ == devices_.size()) {
      is_under_way_ = false;
      return;
    }
    const Outcome outcome = is_gateway_told_ ? tell_node(next_slot_) : tell_gateway();
    if (outcome == Outcome::no_room) {
      blocked_until_ = now + room_pause;
      return;
    }
    if (outcome == Outcome::sent) ++sent;
    next_slot_ += is_gateway_told_ ? 1 : 0;
    is_gateway_told_ = true;
  }
}

EdgeNode::Outcome EdgeNode::tell_gateway() {
  const std::span<const Metric> metrics = reporter_.of_gateway();
  writer_.begin(now_ms_);
  if (is_birth_) {
    sequence_ = 0;
    writer_.add_birth(birth_sequence_metric(birth_sequence_, now_ms_));
    writer_.add_birth(
        {.name = "Node Control/Rebirth", .measured_ms = now_ms_, .value = Value::yes_no(false)});
    for (const Metric& metric : metrics) writer_.add_birth(metric);
  } else if (!add_changes(metrics, gateway_told_)) {
    return Outcome::nothing;
  }
  if (!send(is_birth_ ? birth_.text : data_.text, writer_.finish(sequence_))) {
    return Outcome::no_room;
  }
  keep_told(metrics, gateway_told_);
  return Outcome::sent;
}

EdgeNode::Outcome EdgeNode::tell_node(std::size_t slot) {
  Device& device = devices_[slot];
  const NodeRecord& node = sources_.nodes.records()[slot];
  const bool is_there = is_alive(node);
  if (device.is_born() && (!is_there || node.serial != device.serial)) {
    const Outcome outcome = tell_death(device);
    if (outcome != Outcome::sent || !is_there) return outcome;
  }
  if (!is_there) return Outcome::nothing;
  const std::span<const Metric> metrics =
      reporter_.of_node(node, device.is_born() ? told_of(device) : std::span<Value>{});
  if (!device.is_born() || device.shape != shape_of(metrics)) {
    return tell_birth(device, node.serial, metrics);
  }
  return tell_changes(device, metrics);
}

EdgeNode::Outcome EdgeNode::tell_death(Device& device) {
  writer_.begin(now_ms_);
  if (!send(of_device(device_death_, device.serial), writer_.finish(sequence_))) {
    return Outcome::no_room;
  }
  free_places_.push_back(device.place);
  device.place = no_place;
  return Outcome::sent;
}

EdgeNode::Outcome EdgeNode::tell_birth(Device& device, Serial serial,
                                       std::span<const Metric> metrics) {
  // More nodes than units can answer: some wait until others have died.
  if (!device.is_born() && free_places_.empty()) return Outcome::nothing;
  writer_.begin(now_ms_);
  sort_by_time(metrics);
  for (const std::uint16_t i : order_) writer_.add_birth(metrics[i]);
  if (!send(of_device(device_birth_, serial), writer_.finish(sequence_))) return Outcome::no_room;
  if (!device.is_born()) {
    device.place = free_places_.back();
    free_places_.pop_back();
  }
  device.serial = serial;
  device.shape = shape_of(metrics);
  keep_told(metrics, told_of(device));
  return Outcome::sent;
}

EdgeNode::Outcome EdgeNode::tell_changes(const Device& device, std::span<const Metric> metrics) {
  const std::span<Value> told = told_of(device);
  writer_.begin(now_ms_);
  if (!add_changes(metrics, told)) return Outcome::nothing;
  if (!send(of_device(device_data_, device.serial), writer_.finish(sequence_))) {
    return Outcome::no_room;
  }
  keep_told(metrics, told);
  return Outcome::sent;
}

// The specification wants what was measured earlier before what was measured later.
void EdgeNode::sort_by_time(std::span<const Metric> metrics) {
  order_.resize(metrics.size());
  std::iota(order_.begin(), order_.end(), std::uint16_t{0});
  std::sort(order_.begin(), order_.end(), [&](std::uint16_t a, std::uint16_t b) {
    return metrics[a].measured_ms != metrics[b].measured_ms
               ? metrics[a].measured_ms < metrics[b].measured_ms
               : a < b;
  });
}

// False: nothing has changed.
bool EdgeNode::add_changes(std::span<const Metric> metrics, std::span<const Value> told) {
  bool is_any = false;
  for (std::size_t i = 0; i < metrics.size() && !is_any; ++i) {
    is_any = metrics[i].value != told[i];
  }
  if (!is_any) return false;
  sort_by_time(metrics);
  for (const std::uint16_t i : order_) {
    if (metrics[i].value != told[i]) writer_.add_change(metrics[i], told[i].is_stale);
  }
  return true;
}

std::string_view EdgeNode::of_device(Topic& topic, Serial serial) {
  std::array<char, serial_digits_max> digits;
  const char* const end =
      std::to_chars(digits.data(), digits.data() + digits.size(), serial.value).ptr;
  topic.text.resize(topic.stem);
  topic.text += std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data()));
  return topic.text;
}

bool EdgeNode::send(std::string_view topic, std::string_view payload) {
  if (!broker_.publish({.topic = topic, .payload = payload, .at_most_once = true}, 0)) return false;
  ++sequence_;
  return true;
}

std::span<Value> EdgeNode::told_of(const Device& device) {
  return std::span(told_).subspan(device.place * told_max_, told_max_);
}

}  // namespace etcm::firmware::sparkplug
