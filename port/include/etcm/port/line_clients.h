// Programs on the network that share a bus with the gateway: what they want to ask of its units.
// Nothing here waits; one request is under way at a time.
#pragma once

#include <cstdint>
#include <span>

#include "etcm/port/clock.h"
#include "etcm/port/service_counters.h"

namespace etcm::port {

// A request that may be sent: what it may be was decided before.
struct ClientRequest {
  std::uint8_t address = 0;
  std::span<const std::uint8_t> pdu;  // until it is answered
};

// Why a client has no answer of a unit; the exceptions of the protocol for it.
enum class ClientRefusal : std::uint8_t {
  busy = 0x06,       // no time for it; later there may be
  no_path = 0x0a,    // the bus has no connection, or no such unit
  no_answer = 0x0b,  // the unit did not answer
};

struct ClientCounters {
  ServiceCounters service;  // rejected are clients, and requests that may not be sent
  // Requests by what became of them; these only ever grow.
  std::uint64_t answered = 0;   // by a unit, with an exception too
  std::uint64_t no_answer = 0;  // by any
  std::uint64_t no_path = 0;
  std::uint64_t busy = 0;
};

class LineClients {
 public:
  // Whether next() has one.
  virtual bool is_waiting() const = 0;
  // Takes the next request; false where there is none, or one is under way.
  virtual bool next(ClientRequest& request) = 0;
  // What became of the one that is under way: the PDU of its unit's answer, or none.
  virtual void answer(std::span<const std::uint8_t> pdu) = 0;
  virtual void refuse(ClientRefusal why) = 0;
  // Whether it can be reached, or could be but for its port.
  virtual bool is_shared() const = 0;
  virtual const ClientCounters& counters() const = 0;

 protected:
  ~LineClients() = default;
};

}  // namespace etcm::port
