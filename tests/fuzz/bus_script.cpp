#include "bus_script.h"

#include <algorithm>
#include <vector>

#include "modbus/client_request.h"
#include "modbus/frame.h"

namespace etcm::fuzz {

using namespace std::chrono_literals;

// Few units, so that answers of one are met by questions to it.
void BusScript::start_read(Input& input) {
  const std::uint8_t address = static_cast<std::uint8_t>(1 + input.below(3));
  const auto count = static_cast<std::uint16_t>(1 + input.below(port::read_registers_max));
  const auto first = static_cast<std::uint16_t>(input.byte() * 255);
  const auto spare = static_cast<std::uint16_t>(input.below(count));
  const auto kind = static_cast<port::RegisterKind>(input.below(3));
  asked_[++last_ticket_] = {.address = address, .count = count, .spare = spare};
  bus_.start_read({.address = address,
                   .kind = kind,
                   .first = first,
                   .count = count,
                   .timeout = 300ms,
                   .ticket = last_ticket_,
                   .spare = spare},
                  now_);
}

void BusScript::start_write(Input& input) {
  const std::uint8_t address = static_cast<std::uint8_t>(1 + input.below(3));
  std::vector<std::uint16_t> values(1 + input.below(port::write_registers_max));
  for (std::uint16_t& value : values) value = input.byte();
  asked_[++last_ticket_] = {.address = address};
  bus_.start_write({.address = address,
                    .first = static_cast<std::uint16_t>(input.byte() * 255),
                    .values = values,
                    .timeout = 300ms,
                    .ticket = last_ticket_},
                   now_);
}

// Only what may be sent gets so far.
void BusScript::start_request(Input& input) {
  const std::uint8_t address = static_cast<std::uint8_t>(1 + input.below(3));
  const std::span<const std::uint8_t> pdu = input.take(1 + input.below(port::pdu_bytes_max));
  if (pdu.empty()) return;
  port::ClientRules rules{.units = {}, .may_write = true};
  rules.units.set();
  if (port::judge(address, pdu, rules) != 0) return;
  asked_[++last_ticket_] = {.address = address, .is_of_client = true};
  bus_.start_request({.address = address, .pdu = pdu, .timeout = 300ms, .ticket = last_ticket_},
                     now_);
}

void BusScript::ask(Input& input) {
  if (!bus_.ready()) return;
  const std::uint8_t kind = input.byte() % 4;
  if (kind < 2) start_read(input);
  if (kind == 2) start_write(input);
  if (kind == 3) start_request(input);
  take_answers();
}

void BusScript::take_answers() {
  port::BusAnswer answer;
  while (bus_.take_answer(answer)) {
    const auto found = asked_.find(answer.ticket);
    require(found != asked_.end(), "an answer to no question, or a second one");
    const Asked asked = found->second;
    asked_.erase(found);
    require(answer.address == asked.address, "an answer of another unit");
    require(answer.left_out <= asked.spare, "more is left out than may be");
    if (answer.result != port::BusResult::ok) continue;
    if (asked.is_of_client) require(!answer.pdu.empty(), "an answer without bytes");
    const std::size_t registers = asked.is_of_client ? 0u : asked.count - answer.left_out;
    require(answer.registers.size() == registers, "another count of registers");
  }
}

void BusScript::pass(port::Duration time) {
  now_ += time;
  bus_.advance(now_);
  take_answers();
}

void BusScript::finish() {
  for (int i = 0; i < 4000 && !asked_.empty(); ++i) {
    const port::Instant next = bus_.next_deadline();
    pass(std::clamp<port::Duration>(next == port::never ? 1s : next - now_, 1ms, 1s));
  }
  require(asked_.empty(), "a request without an answer");
}

}  // namespace etcm::fuzz
