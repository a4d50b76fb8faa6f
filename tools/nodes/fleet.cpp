#include "fleet.h"

#include <algorithm>
#include <limits>

#include "modbus/frame.h"
#include "modbus/identity.h"

namespace etcm::nodes {

namespace {

constexpr port::Identity identity{{"ETCM", "simulated node", "1"}};

// A node that jitters is elsewhere so often.
constexpr std::uint32_t jitter_ms = 100;

// A well-mixed number from two: the same in every run.
constexpr std::uint32_t mix(std::uint32_t a, std::uint32_t b) {
  std::uint32_t value = a * 0x9e3779b9u + b * 0x85ebca6bu;
  value = (value ^ value >> 16) * 0x7feb352du;
  value = (value ^ value >> 15) * 0x846ca68bu;
  return value ^ value >> 16;
}

}  // namespace

Fleet::Fleet(const Script& script) : events_(script.events) {
  for (const std::uint32_t serial : script.serials) {
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    Node node;
    node.reading.serial = firmware::Serial{serial};
    node.port = number / units_per_port;
    node.address = static_cast<std::uint8_t>(number % units_per_port + 1);
    nodes_.push_back(node);
  }
  addresses_.resize(std::size_t{port_count()} * (units_per_port + 1));
  for (std::uint32_t number = 0; number < nodes_.size(); ++number) {
    at(nodes_[number].port, nodes_[number].address).nodes.push_back(number);
  }
}

void Fleet::advance(std::uint32_t time_ms) {
  for (; next_event_ < events_.size() && next_event_ms() <= time_ms; ++next_event_) {
    const Event& event = events_[next_event_];
    time_ms_ = event.time_ms;
    happen(nodes_[event.node], event);
  }
  time_ms_ = time_ms;
}

void Fleet::happen(Node& node, const Event& event) {
  if (is_fault(event.action)) {
    node.fault = {.action = event.action, .value = event.value};
    return;
  }
  ++node.sequence;
  switch (event.action) {
    case Action::join:
    case Action::twin:
      node.answers = true;
      node.reading.status = firmware::node_status::fix_valid;
      ++node.reading.boot_count;
      node.reading.position = event.position;
      node.drift = {};
      break;
    case Action::move:
      node.reading.position = event.position;
      node.drift = {};
      break;
    case Action::silent:
      node.answers = false;
      break;
    case Action::leave:
      node.reading.status |= firmware::node_status::leaving;
      break;
    case Action::unit:
      move_to(event.node, static_cast<std::uint8_t>(event.value));
      break;
    case Action::jitter:
      node.jitter = event.value;
      break;
    case Action::drift:
      node.reading.position = position_of(node);
      node.drift = event.position;
      node.drift_ms = event.time_ms;
      break;
    case Action::no_fix:
      node.reading.status &= static_cast<std::uint16_t>(~firmware::node_status::fix_valid);
      break;
    case Action::low_battery:
      node.reading.status |= firmware::node_status::low_battery;
      break;
    case Action::boot:
      ++node.reading.boot_count;
      node.configuration = {};
      break;
    default:
      break;
  }
}

void Fleet::move_to(std::uint32_t number, std::uint8_t unit) {
  Node& node = nodes_[number];
  std::erase(at(node.port, node.address).nodes, number);
  node.address = unit;
  at(node.port, unit).nodes.push_back(number);
}

// Where it says it is, at this moment.
Position Fleet::position_of(const Node& node) const {
  Position position = node.reading.position;
  const std::int64_t ms = std::int64_t{time_ms_} - node.drift_ms;
  position.x += static_cast<std::int32_t>(node.drift.x * ms / 1000);
  position.y += static_cast<std::int32_t>(node.drift.y * ms / 1000);
  if (node.jitter > 0) {
    const std::uint32_t chance = mix(node.reading.serial.value, time_ms_ / jitter_ms);
    const std::uint32_t width = 2u * node.jitter + 1u;
    position.x += static_cast<std::int32_t>((chance & 0xffff) % width) - node.jitter;
    position.y += static_cast<std::int32_t>((chance >> 16) % width) - node.jitter;
  }
  return position;
}

std::uint32_t Fleet::next_event_ms() const {
  return next_event_ < events_.size() ? events_[next_event_].time_ms
                                      : std::numeric_limits<std::uint32_t>::max();
}

std::uint32_t Fleet::port_count() const {
  return static_cast<std::uint32_t>((nodes_.size() + units_per_port - 1) / units_per_port);
}

std::uint32_t Fleet::unit_count(std::uint32_t port) const {
  return std::min(units_per_port,
                  static_cast<std::uint32_t>(nodes_.size()) - port * units_per_port);
}

Fault Fleet::fault(std::uint32_t port, std::uint8_t unit) const {
  const Address& there = addresses_[port * (units_per_port + 1) + unit];
  return there.nodes.empty() ? Fault{} : nodes_[there.last].fault;
}

std::size_t Fleet::answer(std::uint32_t port, std::uint8_t unit,
                          std::span<const std::uint8_t> request, std::span<std::uint8_t> answer) {
  if (unit < 1 || unit > units_per_port) return 0;
  Address& there = at(port, unit);
  ++there.questions;
  const std::vector<std::uint32_t> nodes = there.nodes;  // one may go elsewhere by what it is told
  const auto present = std::count_if(nodes.begin(), nodes.end(),
                                     [&](std::uint32_t node) { return nodes_[node].answers; });
  const bool is_write = request[0] == port::write_holding_registers;
  std::size_t size = 0;
  std::uint32_t speakers = 0;
  for (const std::uint32_t node : nodes) {
    if (!nodes_[node].answers) continue;
    const bool is_heard = present == 1 || is_write ||
                          mix(nodes_[node].reading.serial.value, there.questions) % 2 == 0;
    if (!is_heard) continue;
    std::array<std::uint8_t, port::pdu_bytes_max> bytes;
    const std::size_t count = answer_of(node, request, bytes);
    if (count == 0) continue;
    std::copy_n(bytes.begin(), count, answer.begin());
    size = count;
    there.last = node;
    ++speakers;
  }
  return speakers == 1 ? size : 0;
}

std::size_t Fleet::answer_of(std::uint32_t number, std::span<const std::uint8_t> request,
                             std::span<std::uint8_t> answer) {
  const Node& node = nodes_[number];
  if (node.fault.action == Action::exception) {
    return port::write_exception(answer, request[0], static_cast<std::uint8_t>(node.fault.value));
  }
  if (const std::size_t size = port::write_identity_answer(answer, request, identity)) return size;
  if (request[0] == port::write_holding_registers) return take_write(number, request, answer);
  return answer_read(node, request, answer);
}

std::size_t Fleet::take_write(std::uint32_t number, std::span<const std::uint8_t> request,
                              std::span<std::uint8_t> answer) {
  using firmware::configuration_register_first;
  Node& node = nodes_[number];
  std::uint8_t exception = 0;
  const auto range = port::parse_write_request(request, exception);
  if (!range) return port::write_exception(answer, request[0], exception);
  if (range->first != firmware::assignment_register_first ||
      range->count != firmware::assignment_register_count) {
    return replies_.to_write(request, configuration_register_first, node.configuration, answer);
  }
  std::array<std::uint16_t, firmware::assignment_register_count> values{};
  const std::size_t size = replies_.to_write(request, range->first, values, answer);
  const auto unit = firmware::decode_assignment(values, node.reading.serial);
  if (!unit) return 0;  // it is for another node
  move_to(number, unit->value);
  return size;
}

std::size_t Fleet::answer_read(const Node& node, std::span<const std::uint8_t> request,
                               std::span<std::uint8_t> answer) {
  using firmware::configuration_register_first;
  std::uint8_t exception = 0;
  const auto range = port::parse_read_request(request, exception);
  if (!range) return port::write_exception(answer, request[0], exception);
  if (request[0] == port::read_holding_registers && range->first >= configuration_register_first) {
    return replies_.to_read(request, configuration_register_first, node.configuration, answer);
  }
  firmware::NodeReading reading = node.reading;
  reading.position = position_of(node);
  firmware::NodeRegisters registers = firmware::encode_node(reading, node.sequence);
  if (node.fault.action == Action::torn) ++registers.back();
  return replies_.to_read(request, firmware::node_register_first, registers, answer);
}

}  // namespace etcm::nodes
