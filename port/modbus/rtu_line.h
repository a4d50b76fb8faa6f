// A serial port that carries RTU frames: one is sent, and what comes is heard. Nothing here waits;
// when to send and what an answer means is for its user.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "etcm/port/serial_line.h"
#include "modbus/rtu_frame.h"
#include "posix/event_loop.h"

namespace etcm::port {

class RtuLine final : private EventHandler {
 public:
  // So many bytes are kept of what was heard: of more, the last ones.
  static constexpr std::size_t heard_bytes_max = 2 * rtu_frame_bytes_max;

  // `loop` must outlive the line.
  RtuLine(EventLoop& loop, const SerialLine& line) : loop_(loop), line_(line) {}
  ~RtuLine() { close(); }
  RtuLine(const RtuLine&) = delete;
  RtuLine& operator=(const RtuLine&) = delete;

  // False where that failed, with the reason, and the cure where there is one.
  bool open(std::string& why);
  void close();
  bool is_open() const { return port_.is_open(); }
  // The port went away, which was found while hearing: there is nothing left but to close it.
  bool is_gone() const { return is_gone_; }

  // Throws away what has arrived, what was heard, and what was sent and is not on the line yet.
  void discard();

  // Sends a PDU that stands at frame[rtu_unit_bytes]. False where the port does not take it, with
  // the reason.
  bool send(std::span<std::uint8_t> frame, std::uint8_t unit, std::size_t pdu_bytes,
            std::string& why);
  // Whether the last bit of it is on the line. True where the driver cannot tell.
  bool is_sent() const;

  // Whether bytes came since the last call.
  bool take_news();
  // The first whole answer in what was heard; its PDU is valid until more is heard.
  std::optional<RtuAnswer> next_answer() const;
  // Forgets it, and what stands before it.
  void drop(const RtuAnswer& answer);
  bool has_heard() const { return heard_count_ > 0; }
  void forget() { heard_count_ = 0; }

 private:
  void on_ready(bool can_read, bool can_write) override;
  bool receive();

  EventLoop& loop_;
  SerialLine line_;
  FileDescriptor port_;
  bool is_gone_ = false;
  bool has_news_ = false;
  std::array<std::uint8_t, heard_bytes_max> heard_;
  std::size_t heard_count_ = 0;
};

}  // namespace etcm::port
