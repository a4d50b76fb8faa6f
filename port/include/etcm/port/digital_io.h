// Digital lines: an alert input, a join button, a status LED.
#pragma once

#include <cstdint>

#include "etcm/port/clock.h"

namespace etcm::port {

// A line of the board, by the number the adapter gave it when it was requested at start.
struct DigitalLine {
  std::uint8_t index = 0;
};

class DigitalIo {
 public:
  // The level, free of bounce. An alert is a level, not a count of edges: edges get lost.
  virtual bool is_active(DigitalLine input) const = 0;

  virtual void set_active(DigitalLine output, bool active) = 0;

  // Lets time pass, for inputs that bounce; next_deadline() tells when at the latest.
  virtual void advance(Instant now) = 0;
  virtual Instant next_deadline() const = 0;

 protected:
  ~DigitalIo() = default;
};

}  // namespace etcm::port
