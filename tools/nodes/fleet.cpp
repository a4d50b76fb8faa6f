#include "fleet.h"

#include <algorithm>
#include <limits>

#include "modbus/frame.h"
#include "modbus/identity.h"

namespace etcm::nodes {

namespace {

// Modbus: the address is not one of the unit's.
constexpr std::uint8_t illegal_data_address = 2;

constexpr port::Identity identity{{"ETCM", "simulated node", "1"}};

}  // namespace

Fleet::Fleet(const Script& script) : events_(script.events) {
  for (const std::uint32_t serial : script.serials) {
    Node node;
    node.reading.serial = serial;
    nodes_.push_back(node);
  }
}

void Fleet::advance(std::uint32_t time_ms) {
  for (; next_event_ < events_.size() && next_event_ms() <= time_ms; ++next_event_) {
    const Event& event = events_[next_event_];
    Node& node = nodes_[event.node];
    if (is_fault(event.action)) {
      node.fault = {.action = event.action, .value = event.value};
      continue;
    }
    ++node.sequence;
    switch (event.action) {
      case Action::join:
        node.answers = true;
        node.reading.status = firmware::node_status::fix_valid;
        ++node.reading.boot_count;
        node.reading.position = event.position;
        break;
      case Action::move:
        node.reading.position = event.position;
        break;
      case Action::silent:
        node.answers = false;
        break;
      case Action::leave:
        node.reading.status |= firmware::node_status::leaving;
        break;
      default:
        break;
    }
  }
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

const Fleet::Node* Fleet::node_at(std::uint32_t port, std::uint8_t unit) const {
  if (unit < 1 || unit > unit_count(port)) return nullptr;
  return &nodes_[port * units_per_port + unit - 1u];
}

Fault Fleet::fault(std::uint32_t port, std::uint8_t unit) const {
  const Node* const node = node_at(port, unit);
  return node == nullptr ? Fault{} : node->fault;
}

std::size_t Fleet::answer(std::uint32_t port, std::uint8_t unit,
                          std::span<const std::uint8_t> request,
                          std::span<std::uint8_t> answer) const {
  const Node* const node = node_at(port, unit);
  if (node == nullptr || !node->answers) return 0;
  if (node->fault.action == Action::exception) {
    return port::write_exception(answer, request[0], static_cast<std::uint8_t>(node->fault.value));
  }
  if (const std::size_t size = port::write_identity_answer(answer, request, identity)) return size;
  std::uint8_t exception = 0;
  const auto range = port::parse_read_request(request, exception);
  if (!range) return port::write_exception(answer, request[0], exception);
  if (range->first + range->count > firmware::node_register_count) {
    return port::write_exception(answer, request[0], illegal_data_address);
  }
  firmware::NodeRegisters registers = firmware::encode_node(node->reading, node->sequence);
  if (node->fault.action == Action::torn) ++registers.back();
  return port::write_read_answer(answer, request[0],
                                 std::span(registers).subspan(range->first, range->count));
}

}  // namespace etcm::nodes
