#include "bus_clients.h"

#include <algorithm>

namespace etcm::simulation {

namespace {

constexpr std::uint8_t who_are_you = 17;
constexpr std::uint8_t exception_bit = 0x80;
constexpr std::size_t waiting_max = 8;

}  // namespace

void BusClients::ask(std::size_t count) {
  for (std::size_t i = 0; i < count && waiting_.size() < waiting_max; ++i) {
    Request request{
        .unit = static_cast<std::uint8_t>(1 + random_.below(units_)), .pdu = {}, .since = now_};
    const std::uint64_t kind = random_.below(8);
    if (kind == 0) {
      request.pdu = {who_are_you};
    } else {
      // Of three one asks what the gateway asks.
      const bool is_same = kind < 3;
      const auto first = static_cast<std::uint8_t>(is_same ? 0 : random_.below(position_registers));
      const auto most = static_cast<std::uint8_t>(position_registers - first);
      const auto of_them = static_cast<std::uint8_t>(is_same ? most : 1 + random_.below(most));
      request.pdu = {random_.below(2) == 0 ? read_holding : read_input, 0, first, 0, of_them};
    }
    waiting_.push_back(request);
  }
}

void BusClients::pass_to(Instant now) {
  now_ = now;
  while (!waiting_.empty() && now - waiting_.front().since > wait_max) {
    waiting_.pop_front();
    ++counters_.busy;
  }
  if (is_flooding && waiting_.empty()) ask(waiting_max);
}

void BusClients::forget_all() {
  waiting_.clear();
  is_under_way_ = false;
}

bool BusClients::is_sending(std::uint8_t unit, std::span<const std::uint8_t> pdu) {
  if (!is_under_way_ || is_sent_ || unit != under_way_.unit) return false;
  if (!std::ranges::equal(pdu, under_way_.pdu)) return false;
  is_sent_ = true;
  return true;
}

bool BusClients::next(port::ClientRequest& request) {
  if (!is_waiting()) return false;
  under_way_ = waiting_.front();
  waiting_.pop_front();
  is_under_way_ = true;
  is_sent_ = false;
  taken_at_ = now_;
  request = {.address = under_way_.unit, .pdu = under_way_.pdu};
  return true;
}

void BusClients::answer(std::span<const std::uint8_t> pdu) {
  if (wrong_.empty()) wrong_ = is_under_way_ ? look_at(pdu) : "an answer comes to no question";
  is_under_way_ = false;
  ++counters_.answered;
}

void BusClients::refuse(port::ClientRefusal why) {
  if (wrong_.empty() && !is_under_way_) wrong_ = "a refusal comes to no question";
  is_under_way_ = false;
  if (why == port::ClientRefusal::no_answer) ++counters_.no_answer;
  if (why == port::ClientRefusal::no_path) ++counters_.no_path;
}

bool BusClients::is_doubled(std::uint8_t unit) const {
  std::size_t there = 0;
  for (const Device* const device : devices_) {
    if (device->unit != unit || device->is_replaced) continue;
    ++there;
    if (device->had_twin && device->undisturbed_since > now_) return true;
  }
  return there > 1;
}

std::string BusClients::look_at(std::span<const std::uint8_t> pdu) const {
  const std::uint8_t function = under_way_.pdu[0];
  if (pdu.size() == 2 && pdu[0] == (function | exception_bit)) return {};
  if (function == who_are_you || pdu.size() < 2 || pdu[0] != function) {
    return "an answer is of another function";
  }
  const std::uint8_t first = under_way_.pdu[2], count = under_way_.pdu[4];
  if (pdu[1] != 2 * count || pdu.size() != 2u + 2u * count) {
    return "an answer has " + std::to_string(pdu[1] / 2) + " registers, not " +
           std::to_string(count);
  }
  // Registers 2 and 3 tell whose they are. Of two at one address one may answer late what the other
  // has answered already: nobody waits for that any more.
  if (first > 2 || first + count < 4 || is_doubled(under_way_.unit)) return {};
  const std::size_t at = 2 + 2 * (2u - first);
  const std::uint32_t serial = std::uint32_t{pdu[at]} << 24 | std::uint32_t{pdu[at + 1]} << 16 |
                               std::uint32_t{pdu[at + 2]} << 8 | pdu[at + 3];
  const bool is_of_unit = std::ranges::any_of(devices_, [&](const Device* device) {
    return device->serial == serial && device->unit == under_way_.unit;
  });
  return is_of_unit ? std::string()
                    : "unit " + std::to_string(under_way_.unit) +
                          " was asked by another program, and node " + std::to_string(serial) +
                          " is in the answer";
}

}  // namespace etcm::simulation
