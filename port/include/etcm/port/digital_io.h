// Digital lines: an alert input, a join button, a status LED.
#pragma once

#include <cstdint>

namespace etcm::port {

// A line of the board, by the number the adapter gave it when it was requested at start.
struct Line {
  std::uint8_t index = 0;
};

class DigitalIo {
 public:
  // The level now. An alert is a level, not a count of edges: edges get lost.
  virtual bool is_active(Line input) const = 0;

  virtual void set_active(Line output, bool active) = 0;

 protected:
  ~DigitalIo() = default;
};

}  // namespace etcm::port
