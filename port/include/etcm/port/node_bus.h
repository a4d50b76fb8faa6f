// A bus with units whose registers are read and written: a Modbus TCP connection or a serial line.
//
// Nothing here blocks. start_read() and start_write() send a request, advance() lets time pass,
// take_answer() hands over what is complete; each request started gives exactly one answer, at the
// latest when its timeout has passed. Bytes arrive between the calls (the adapter waits for them
// with its own event loop).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "etcm/port/clock.h"

namespace etcm::port {

// The most registers one read may ask for (Modbus: 125).
inline constexpr std::uint16_t read_registers_max = 125;
// The most registers one write may carry (Modbus: 123).
inline constexpr std::uint16_t write_registers_max = 123;

enum class BusResult : std::uint8_t {
  ok,
  timeout,     // no answer in time; one that comes later is never taken for another's
  exception,   // the unit answered with an exception code
  bad_answer,  // an answer of the wrong unit, function or length, or a garbled one
  link_lost,   // the connection or the line went away
};
inline constexpr std::size_t bus_result_count = 5;

// Which registers of a unit. A unit that serves the same as input and as holding registers may be
// asked in either way, and a bus whose answers carry no number tells late ones apart by it.
enum class RegisterKind : std::uint8_t { input_or_holding, input, holding };

struct RegisterRead {
  std::uint8_t address = 0;
  RegisterKind kind = RegisterKind::input_or_holding;
  std::uint16_t first = 0;  // 0-based
  std::uint16_t count = 0;
  Duration
      timeout{};  // how long the unit may take; the time of bytes on a serial line is not counted
  std::uint32_t ticket = 0;  // comes back with the answer
  // So many of them, from the first on, may be left out: they are known. A bus whose answers carry
  // no number tells them apart by their length where it has to.
  std::uint16_t spare = 0;
};

struct RegisterWrite {
  std::uint8_t address = 0;
  std::uint16_t first = 0;                // holding register, 0-based
  std::span<const std::uint16_t> values;  // 1 to write_registers_max; needed during the call only
  Duration timeout{};                     // as above
  std::uint32_t ticket = 0;               // comes back with the answer
};

// A request of any function that question.h knows, of somebody who shares the bus; it is sent as it
// stands.
struct UnitRequest {
  std::uint8_t address = 0;           // not 0: a broadcast is not answered
  std::span<const std::uint8_t> pdu;  // needed during the call only
  Duration timeout{};                 // as above
  std::uint32_t ticket = 0;           // comes back with the answer
};

struct BusAnswer {
  std::uint8_t address = 0;
  std::uint32_t ticket = 0;  // of the request
  BusResult result = BusResult::ok;
  std::uint8_t exception = 0;  // the code, with BusResult::exception
  // After a wait in vain: for so long at the most the bus takes no request because of it.
  Duration silence{};
  std::uint16_t left_out = 0;  // of the registers of a read, from the first on
  // Of a read, with BusResult::ok; valid until the next call.
  std::span<const std::uint16_t> registers;
  // Of a UnitRequest, with BusResult::ok or exception: as the unit has sent it; valid as long.
  std::span<const std::uint8_t> pdu{};
};

// Whether it is a converter that says that no unit is there.
constexpr bool is_of_converter(BusResult result, std::uint8_t exception) {
  constexpr std::uint8_t path_unavailable = 0x0a;
  constexpr std::uint8_t no_response = 0x0b;
  return result == BusResult::exception &&
         (exception == path_unavailable || exception == no_response);
}
// No unit is there: silence, or a converter that says so.
constexpr bool is_absence(const BusAnswer& answer) {
  return answer.result == BusResult::timeout || is_of_converter(answer.result, answer.exception);
}

class NodeBus {
 public:
  // Whether a request would be taken now: the link is up and has room for one more.
  virtual bool ready() const = 0;
  // Why there is no link: where, what, and the cure. Empty while there is one, and before it is
  // known. Valid until the next call that is not const.
  virtual std::string_view why_down() const { return {}; }

  // From when on this may be asked, whatever else is: while a late answer may be under way that
  // would look like the answer to it, it is not. What is started earlier is not sent, and times out
  // at once.
  virtual Instant read_free_at(const RegisterRead&, Instant) const { return {}; }
  // Of any write to this unit.
  virtual Instant write_free_at(std::uint8_t) const { return {}; }

  // Of such a request. It cannot be asked in another way, and an exception that may be an earlier
  // question's is not its answer; and so that those who share a bus cannot keep its units from
  // being read, few that are not answered are sent to one unit.
  virtual Instant request_free_at(const UnitRequest&, Instant) const { return {}; }

  // Whether there is a connection or a line to the units, as far as is known.
  virtual bool is_up() const { return true; }
  // Whether it asks nothing yet, so that no answer to an earlier run is taken for one of this: no
  // unit can have answered.
  virtual bool is_clearing(Instant) const { return false; }
  // Whether a request that is not answered holds up all others, as far as that was found out.
  virtual bool is_one_line() const { return false; }
  // For how much longer than its timeout a request may be under way.
  virtual Duration delay_max() const { return {}; }

  // Sends a request for registers: FC 4, or FC 3.
  // REQUIRES: ready().
  virtual void start_read(const RegisterRead& read, Instant now) = 0;

  // Sends a request to write holding registers (FC 16). BusResult::ok: the unit says it has them.
  // REQUIRES: ready().
  virtual void start_write(const RegisterWrite& write, Instant now) = 0;

  // Sends a request as it is. REQUIRES: ready().
  virtual void start_request(const UnitRequest& request, Instant now) = 0;

  // Expires what is overdue and brings a lost link back.
  virtual void advance(Instant now) = 0;

  // A unit that was waited for in vain because others held up its answer, which has come since: the
  // bus knows now to wait for it. Each once.
  virtual std::optional<std::uint8_t> take_held_up() { return std::nullopt; }

  // The next complete answer, oldest first; false when there is none.
  virtual bool take_answer(BusAnswer& answer) = 0;

  // When advance() has something to do at the latest; `never` when only bytes can change anything.
  virtual Instant next_deadline() const = 0;

 protected:
  ~NodeBus() = default;
};

const char* to_string(BusResult result) noexcept;

}  // namespace etcm::port
