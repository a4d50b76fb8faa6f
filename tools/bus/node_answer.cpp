#include "node_answer.h"

#include <array>
#include <utility>

#include "modbus/frame.h"

namespace etcm::bus {

namespace {

constexpr int torn_reads_max = 4;

constexpr std::array<std::pair<std::uint16_t, const char*>, 5> status_words{{
    {firmware::node_status::moving, "moving"},
    {firmware::node_status::join_request, "wants to join"},
    {firmware::node_status::low_battery, "low battery"},
    {firmware::node_status::relay, "relay"},
    {firmware::node_status::leaving, "leaving"},
}};

// A way to ask a stranger, as the gateway has them.
struct Way {
  std::uint8_t function = port::read_input_registers;
  std::uint16_t left_out = 0;
};

// The first that is free; else the first of all, which waits.
Way free_way(const Master& master, std::uint8_t unit) {
  for (std::uint16_t left_out = 0; left_out <= firmware::stranger_register_spare; ++left_out) {
    const port::RegisterRange range{
        .first = static_cast<std::uint16_t>(firmware::node_register_first + left_out),
        .count = static_cast<std::uint16_t>(firmware::node_register_count - left_out)};
    for (const std::uint8_t function : {port::read_input_registers, port::read_holding_registers}) {
      if (master.may_read(unit, function, range)) {
        return {.function = function, .left_out = left_out};
      }
    }
  }
  return {};
}

}  // namespace

NodeAnswer ask_node(Master& master, std::uint8_t unit, firmware::WordOrder order) {
  NodeAnswer answer;
  for (int reads = 0; reads < torn_reads_max; ++reads) {
    const Way way = free_way(master, unit);
    firmware::NodeRegisters buffer{};
    const auto registers = std::span(buffer).subspan(way.left_out);
    answer.error_detail = master.read(
        unit, way.function,
        static_cast<std::uint16_t>(firmware::node_register_first + way.left_out), registers);
    if (answer.error_detail) return answer;
    answer.fault = decode_node(registers, order, answer.reading, way.left_out);
    if (answer.fault != firmware::ReadingFault::torn) break;
  }
  return answer;
}

std::string trouble_text(const NodeAnswer& answer) {
  if (answer.error_detail) return to_string(*answer.error_detail);
  return answer.fault == firmware::ReadingFault::none ? "" : explain(answer.fault);
}

std::string status_text(std::uint16_t status) {
  std::string text = (status & firmware::node_status::fix_valid) != 0 ? "fix" : "no fix";
  for (const auto& [bit, word] : status_words) {
    if ((status & bit) != 0) text += std::string(", ") + word;
  }
  return text;
}

}  // namespace etcm::bus
