// A line that carries RTU frames: one is sent, and what comes is heard. Nothing here waits; when to
// send and what an answer means is for its user.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "etcm/port/clock.h"
#include "modbus/rtu_frame.h"

namespace etcm::port {

class RtuLine {
 public:
  // So many bytes are kept of what was heard: of more, the last ones.
  static constexpr std::size_t heard_bytes_max = 2 * rtu_frame_bytes_max;

  // False where that failed, with the reason, and the cure where there is one.
  virtual bool open(Instant now, std::string& why) = 0;
  virtual void close() = 0;
  // Once it is open, whether it takes frames: a connection takes its time. REQUIRES: open.
  virtual bool is_ready() const { return true; }
  // Lets time pass while it is not.
  virtual void advance(Instant) {}
  virtual Instant next_deadline() const { return never; }
  // Why it went away, which was found while hearing: there is nothing left but to close it. Null
  // while it is there.
  virtual const char* why_gone() const = 0;

  // Throws away what has arrived, what was heard, and what was sent and is not on the line yet.
  virtual void discard() = 0;

  // Whether the last bit of what was sent is on the line. True where the driver cannot tell.
  virtual bool is_sent() const = 0;

  // Sends a PDU that stands at frame[rtu_unit_bytes]. False where the line does not take it, with
  // the reason.
  bool send(std::span<std::uint8_t> frame, std::uint8_t address, std::size_t pdu_bytes,
            std::string& why);

  // Whether bytes came since the last call.
  bool take_news();
  // The first whole answer in what was heard; its PDU is valid until more is heard.
  std::optional<RtuAnswer> next_answer() const;
  // Forgets it, and what stands before it.
  void drop(const RtuAnswer& answer);
  bool has_heard() const { return heard_count_ > 0; }
  // The bytes of it; until more is heard or some is dropped.
  std::span<const std::uint8_t> heard() const { return std::span(heard_).first(heard_count_); }
  void forget() { heard_count_ = 0; }

 protected:
  ~RtuLine() = default;

  // Puts a whole frame on the line; as send().
  virtual bool write(std::span<const std::uint8_t> frame, std::string& why) = 0;

  void hear(std::span<const std::uint8_t> bytes);
  // Nothing was heard.
  void forget_all();

 private:
  bool has_news_ = false;
  std::array<std::uint8_t, heard_bytes_max> heard_;
  std::size_t heard_count_ = 0;
};

}  // namespace etcm::port
