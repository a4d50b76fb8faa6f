// The units of the fleet's first port on a serial line, byte by byte at the pace of the line.
//
// A terminal moves bytes at once; here they take the time they would take on a cable. A request has
// arrived when its last byte would have, its answer begins after the silence that ends a frame, and
// each of its bytes goes out when it would be complete. What is said into an answer garbles it.
#pragma once

#include <cstdint>
#include <vector>

#include "etcm/port/serial_line.h"
#include "fleet.h"
#include "modbus/rtu_frame.h"
#include "posix/event_loop.h"

namespace etcm::nodes {

class SerialUnits final : private port::EventHandler {
 public:
  // `descriptor` is our end of a line set to `line`; it, `loop` and `fleet` must outlive this.
  SerialUnits(port::EventLoop& loop, Fleet& fleet, int descriptor, const port::SerialLine& line);
  ~SerialUnits();
  SerialUnits(const SerialUnits&) = delete;
  SerialUnits& operator=(const SerialUnits&) = delete;

  void advance(port::Instant now);
  port::Instant next_deadline() const;

  // How often both ends spoke at a time.
  std::uint32_t collision_count() const { return collisions_; }

 private:
  void on_ready(bool can_read, bool can_write) override;
  void answer(port::Instant heard_at);
  void misbehave(const Fault& fault);
  void send(port::Instant now);
  bool is_sending() const { return sent_ < answer_.size(); }

  port::EventLoop& loop_;
  Fleet& fleet_;
  int descriptor_;
  port::Duration character_;
  port::Duration silence_;

  std::vector<std::uint8_t> heard_;
  std::size_t timed_ = 0;  // of heard_, those that line_busy_until_ counts
  port::Instant line_busy_until_{};

  std::vector<std::uint8_t> answer_;  // a frame, with what its fault makes of it
  std::size_t sent_ = 0;
  port::Instant answer_begin_{};
  std::uint32_t collisions_ = 0;
};

}  // namespace etcm::nodes
