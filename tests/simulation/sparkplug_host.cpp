#include "sparkplug_host.h"

#include <algorithm>
#include <array>
#include <exception>
#include <set>
#include <utility>

#include "firmware/rebirth_command.h"

namespace etcm::simulation {

namespace {

constexpr std::string_view root = "spBv1.0/plant/";
constexpr std::string_view edge_node = "/west";
constexpr const char* good = "192";
constexpr Duration look_pause = std::chrono::seconds(1);
constexpr Duration told_within = std::chrono::seconds(20);

std::string name_of(const std::string& device) {
  return device.empty() ? "the edge node" : "device " + device;
}

}  // namespace

SparkplugHost::SparkplugHost(test::BrokerModel& broker, inputs::Random& random,
                             const test::MemberClock& clock)
    : client_(broker, random, std::size_t{0}, clock, "host") {
  client_.set_listener(this);
  client_.subscribe(std::array{std::string(root) + "#"});
}

void SparkplugHost::send(std::string_view payload) {
  // Where it has no room it is asked for again, for nothing has come.
  static_cast<void>(client_.publish(
      {.topic = std::string(root) + "NCMD" + std::string(edge_node), .payload = payload}, 0));
}

void SparkplugHost::ask_for_births() { send(test::rebirth_command()); }

void SparkplugHost::talk_rubbish(inputs::Random& random) {
  std::string bytes = test::rebirth_command();
  bytes.resize(random.index(bytes.size()));
  for (std::uint64_t i = random.below(40); i > 0; --i) {
    bytes += static_cast<char>(random.next());
  }
  send(bytes);
}

void SparkplugHost::forget() {
  is_born_ = false;
  edge_node_ = {};
  devices_.clear();
}

void SparkplugHost::on_connected(Instant) {
  forget();
  ask_for_births();
}

void SparkplugHost::on_disconnected(std::string_view, Instant) { forget(); }

void SparkplugHost::on_message(const port::BrokerMessage& message, Instant) {
  if (!wrong_.empty() || !message.topic.starts_with(root)) return;
  std::string_view rest = message.topic.substr(root.size());
  const std::string_view type = rest.substr(0, rest.find('/'));
  if (type == "NCMD") return;
  rest.remove_prefix(std::min(type.size() + edge_node.size(), rest.size()));
  if (!rest.empty()) rest.remove_prefix(1);
  try {
    take(type, std::string(rest), test::read_sparkplug(message.payload));
  } catch (const std::exception& error) {
    wrong_ = std::string(type) + " cannot be read: " + error.what();
  }
  if (message.retained) wrong_ = std::string(type) + " is retained";
}

void SparkplugHost::take(std::string_view type, const std::string& device,
                         const test::SparkplugPayload& told) {
  const std::string name = std::string(type) + " of " + name_of(device);
  if (type == "NDEATH") {
    // Of an earlier connection: it has died already.
    if (told.value("bdSeq") == birth_sequence_) forget();
    return;
  }
  if (!told.sequence) {
    wrong_ = name + " has no number";
    return;
  }
  if (type == "NBIRTH") {
    forget();
    is_born_ = true;
    sequence_ = 0;
    birth_sequence_ = told.value("bdSeq");
  }
  if (!is_born_) return;
  const std::uint8_t expected = sequence_++;
  if (*told.sequence != expected) {
    wrong_ = name + " has number " + std::to_string(*told.sequence) + " instead of " +
             std::to_string(expected);
    return;
  }
  std::string why;
  const bool is_there = devices_.contains(device);
  if (type == "NBIRTH") {
    why = born(edge_node_, told);
  } else if (type == "NDATA") {
    why = changed(edge_node_, told);
  } else if (type == "DBIRTH") {
    why = born(devices_[device] = {}, told);
  } else if (!is_there) {
    why = "was never born";
  } else if (type == "DDATA") {
    why = changed(devices_[device], told);
  } else if (type == "DDEATH") {
    devices_.erase(device);
  } else {
    why = "is of no kind that is known";
  }
  if (!why.empty()) wrong_ = name + ": " + why;
}

void SparkplugHost::note(Told& of, const std::string& name, const test::SparkplugMetric& metric) {
  of.values[name] = metric.value;
  const auto quality = metric.properties.find("Quality");
  if (quality == metric.properties.end()) return;
  if (quality->second == good) {
    of.qualities.erase(name);
  } else {
    of.qualities[name] = quality->second;
  }
}

std::string SparkplugHost::born(Told& of, const test::SparkplugPayload& told) {
  ++births_;
  for (const test::SparkplugMetric& metric : told.metrics) {
    if (metric.name.empty()) return "a metric without a name is born";
    if (of.values.contains(metric.name)) return metric.name + " is born twice";
    if (metric.alias && !of.names.emplace(*metric.alias, metric.name).second) {
      return metric.name + " has the alias of another";
    }
    note(of, metric.name, metric);
  }
  return {};
}

std::string SparkplugHost::changed(Told& of, const test::SparkplugPayload& told) {
  if (told.metrics.empty()) return "nothing has changed";
  for (const test::SparkplugMetric& metric : told.metrics) {
    const auto name = metric.alias ? of.names.find(*metric.alias) : of.names.end();
    if (name == of.names.end()) return "a metric changes that was never born";
    note(of, name->second, metric);
  }
  return {};
}

std::string SparkplugHost::look(GatewayRun& run, bool is_gateway_connected, Instant now) {
  if (!wrong_.empty()) return wrong_;
  if (now - looked_at_ < look_pause) return {};
  looked_at_ = now;
  const auto before = std::exchange(differs_since_, {});
  if (!is_born_ || !is_gateway_connected) return {};
  std::set<std::string> there;
  for (const firmware::NodeRecord& node : run.gateway().nodes().records()) {
    if (firmware::sparkplug::is_alive(node)) there.insert(std::to_string(node.serial.value));
  }
  const auto differ = [&](const std::string& device) {
    const auto since = before.find(device);
    differs_since_[device] = since == before.end() ? now : since->second;
  };
  for (const std::string& device : there) {
    if (!devices_.contains(device)) differ(device);
  }
  for (const auto& [device, told] : devices_) {
    if (!there.contains(device)) differ(device);
  }
  for (const auto& [device, since] : differs_since_) {
    if (now - since < told_within) continue;
    return devices_.contains(device) ? "device " + device + " has died, and the host was not told"
                                     : "device " + device + " lives, and was not born for the host";
  }
  return {};
}

std::string SparkplugHost::look_at_rest(const SiteWorld& site, GatewayRun& run) const {
  if (!is_born_) return "at rest, the host knows of no edge node";
  std::size_t living = 0;
  for (const auto& device : site.devices) {
    if (device->is_replaced) continue;
    ++living;
    const std::string name = "at rest, node " + std::to_string(device->serial);
    const auto told = devices_.find(std::to_string(device->serial));
    if (told == devices_.end()) return name + " is not known to the host";
    const auto value = [&](const char* metric) {
      const auto found = told->second.values.find(metric);
      return found == told->second.values.end() ? std::string("none") : found->second;
    };
    const firmware::NodeRecord* const node =
        run.gateway().nodes().find(firmware::Serial{device->serial});
    const Position place = node->is_placed() ? node->placed : node->position;
    if (value("Position/X") != std::to_string(place.x) ||
        value("Position/Y") != std::to_string(place.y)) {
      return name + " is elsewhere at the host";
    }
    if (value("Position/Stale") != "false" || !told->second.qualities.empty()) {
      return name + " is stale at the host";
    }
    if (value("Mesh/In mesh") != (node->is_placed() ? "true" : "false")) {
      return name + " is and is not in the mesh at the host";
    }
  }
  if (devices_.size() != living) {
    return "at rest, the host knows " + std::to_string(devices_.size()) + " nodes, not " +
           std::to_string(living);
  }
  const auto nodes = edge_node_.values.find("Mesh/Nodes");
  const std::string count = std::to_string(run.gateway().snapshot().node_count);
  if (nodes == edge_node_.values.end() || nodes->second != count) {
    return "at rest, the mesh has another number of nodes at the host";
  }
  return {};
}

}  // namespace etcm::simulation
