#include "modbus/client_request.h"

#include <modbus/modbus.h>

#include <optional>

#include "etcm/port/node_bus.h"
#include "modbus/identity.h"
#include "modbus/question.h"

namespace etcm::port {

namespace {

static_assert(read_coils == MODBUS_FC_READ_COILS);
static_assert(read_discrete_inputs == MODBUS_FC_READ_DISCRETE_INPUTS);
static_assert(write_single_coil == MODBUS_FC_WRITE_SINGLE_COIL);
static_assert(write_single_register == MODBUS_FC_WRITE_SINGLE_REGISTER);
static_assert(write_coils == MODBUS_FC_WRITE_MULTIPLE_COILS);
static_assert(mask_write_register == MODBUS_FC_MASK_WRITE_REGISTER);
static_assert(write_and_read_registers == MODBUS_FC_WRITE_AND_READ_REGISTERS);

constexpr std::uint16_t coil_on = 0xff00;
// Before the values of a write of several, and of FC 23.
constexpr std::size_t write_head = 6;
constexpr std::size_t write_and_read_head = 10;

std::uint16_t number_at(std::span<const std::uint8_t> pdu, std::size_t at) {
  return static_cast<std::uint16_t>(pdu[at] << 8 | pdu[at + 1]);
}

bool is_count(std::uint32_t count, std::uint32_t most) { return count >= 1 && count <= most; }

// Of a function that writes several values: their bytes are counted once more before them.
bool has_values(std::span<const std::uint8_t> pdu, std::size_t head, std::size_t bytes) {
  return pdu.size() == head + bytes && pdu[head - 1] == bytes;
}

// Whether lengths and counts are those of the function; nothing where it is not known.
std::optional<bool> is_well_formed(std::span<const std::uint8_t> pdu) {
  constexpr std::size_t range_bytes = 5;
  const auto second = [&] { return number_at(pdu, 3); };
  switch (pdu[0]) {
    case read_coils:
    case read_discrete_inputs:
      return pdu.size() == range_bytes && is_count(second(), MODBUS_MAX_READ_BITS);
    case read_holding_registers:
    case read_input_registers:
      return pdu.size() == range_bytes && is_count(second(), read_registers_max);
    case write_single_coil:
      return pdu.size() == range_bytes && (second() == 0 || second() == coil_on);
    case write_single_register:
      return pdu.size() == range_bytes;
    case write_coils:
      return pdu.size() > write_head && is_count(second(), MODBUS_MAX_WRITE_BITS) &&
             has_values(pdu, write_head, (second() + 7u) / 8u);
    case write_holding_registers: {
      std::uint8_t ignored = 0;
      return parse_write_request(pdu, ignored).has_value();
    }
    case mask_write_register:
      return pdu.size() == range_bytes + 2;
    case write_and_read_registers:
      return pdu.size() > write_and_read_head && is_count(second(), MODBUS_MAX_WR_READ_REGISTERS) &&
             is_count(number_at(pdu, 7), MODBUS_MAX_WR_WRITE_REGISTERS) &&
             has_values(pdu, write_and_read_head, std::size_t{2} * number_at(pdu, 7));
    case report_server_id:
      return pdu.size() == 1;
    case encapsulated_interface:
      if (pdu.size() > 1 && pdu[1] != read_device_identification) return std::nullopt;
      return pdu.size() == 4;
    default:
      return std::nullopt;
  }
}

}  // namespace

bool is_write_request(std::span<const std::uint8_t> pdu) {
  switch (pdu[0]) {
    case write_single_coil:
    case write_single_register:
    case write_coils:
    case write_holding_registers:
    case mask_write_register:
    case write_and_read_registers:
      return true;
    default:
      return false;
  }
}

std::uint8_t judge(std::uint8_t address, std::span<const std::uint8_t> pdu,
                   const ClientRules& rules) {
  if (address == MODBUS_BROADCAST_ADDRESS || !rules.units[address]) {
    return MODBUS_EXCEPTION_GATEWAY_PATH;
  }
  const std::optional<bool> is_good = is_well_formed(pdu);
  if (!is_good || (is_write_request(pdu) && !rules.may_write)) {
    return MODBUS_EXCEPTION_ILLEGAL_FUNCTION;
  }
  return *is_good ? 0 : MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
}

}  // namespace etcm::port
