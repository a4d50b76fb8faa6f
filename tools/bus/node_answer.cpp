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

}  // namespace

NodeAnswer ask_node(Master& master, std::uint8_t unit, firmware::WordOrder order) {
  NodeAnswer answer;
  for (int reads = 0; reads < torn_reads_max; ++reads) {
    firmware::NodeRegisters registers{};
    answer.trouble =
        master.read(unit, port::read_input_registers, firmware::node_register_first, registers);
    if (answer.trouble) return answer;
    answer.fault = decode_node(registers, order, answer.reading);
    if (answer.fault != firmware::ReadingFault::torn) break;
  }
  return answer;
}

std::string trouble_text(const NodeAnswer& answer) {
  if (answer.trouble) return to_string(*answer.trouble);
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
