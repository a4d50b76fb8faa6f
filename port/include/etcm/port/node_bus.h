// A bus with units to read registers from: a Modbus TCP connection or a serial line.
//
// Nothing here blocks. start_read() sends a request, advance() lets time pass, take_answer() hands
// over what is complete; each read started gives exactly one answer, at the latest when its timeout
// has passed. Bytes arrive between the calls (the adapter waits for them with its own event loop).
#pragma once

#include <cstdint>
#include <span>

#include "etcm/port/clock.h"

namespace etcm::port {

// The most registers one read may ask for (Modbus: 125).
inline constexpr std::uint16_t read_registers_max = 125;

enum class BusResult : std::uint8_t {
  ok,
  timeout,     // no answer in time; one that comes later is never taken for another's
  exception,   // the unit answered with an exception code
  bad_answer,  // an answer of the wrong unit, function or length, or a garbled one
  link_lost,   // the connection or the line went away
};

struct RegisterRead {
  std::uint8_t unit = 0;
  std::uint16_t first = 0;  // input register, 0-based
  std::uint16_t count = 0;
  Duration
      timeout{};  // how long the unit may take; the time of bytes on a serial line is not counted
};

struct BusAnswer {
  std::uint8_t unit = 0;
  BusResult result = BusResult::ok;
  std::uint8_t exception = 0;                // the code, with BusResult::exception
  std::span<const std::uint16_t> registers;  // with BusResult::ok; valid until the next call
};

class NodeBus {
 public:
  // Whether start_read() would take a request now: the link is up and has room for one more.
  virtual bool ready() const = 0;

  // Sends a request for input registers (FC 4; a bus may take FC 3, where nodes serve the same).
  // REQUIRES: ready(), no read of this unit under way.
  virtual void start_read(const RegisterRead& read, Instant now) = 0;

  // Expires what is overdue and brings a lost link back.
  virtual void advance(Instant now) = 0;

  // The next complete answer, oldest first; false when there is none.
  virtual bool take_answer(BusAnswer& answer) = 0;

  // When advance() has something to do at the latest; `never` when only bytes can change anything.
  virtual Instant next_deadline() const = 0;

 protected:
  ~NodeBus() = default;
};

const char* to_string(BusResult result) noexcept;

}  // namespace etcm::port
