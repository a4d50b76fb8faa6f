// Single requests to the units of a bus that are not polls: they wait until
// the polls leave time.
#pragma once

#include <cstdint>
#include <span>

#include "etcm/port/clock.h"
#include "etcm/port/node_bus.h"
#include "firmware/polling/indices.h"
#include "firmware/protocol/modbus_address.h"

namespace etcm::firmware {

struct BusRequest {
  ModbusAddress address;
  std::uint16_t first = 0;                // register
  std::uint16_t read_count = 0;           // of registers to read; 0: it is a write
  std::uint16_t spare = 0;                // as RegisterRead has it
  std::span<const std::uint16_t> values;  // to write; needed during the call only
};

class RequestSource {
 public:
  // When there may be a request for this bus; `never` where nothing but time or an answer can bring
  // one.
  virtual port::Instant request_due(BusIndex bus) const = 0;
  // Sets the next request, if there is one at this moment. It will be sent.
  virtual bool next_request(BusIndex bus, port::Instant now, BusRequest& request) = 0;
  // What came of it: the next call for this bus after next_request() gave one.
  virtual void on_request_done(BusIndex bus, const port::BusAnswer& answer, port::Instant now) = 0;

 protected:
  ~RequestSource() = default;
};

}  // namespace etcm::firmware
