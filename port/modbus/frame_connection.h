// A connection that carries Modbus frames to a device and back. Nothing here waits; which answer
// belongs to which request is for its user.
#pragma once

#include <cstdint>
#include <span>

#include "etcm/port/clock.h"
#include "etcm/port/endpoint.h"
#include "modbus/frame.h"

namespace etcm::port {

class FrameConnection {
 public:
  class Listener {
   public:
    virtual void on_connected() = 0;
    // The frame's PDU is valid during the call.
    virtual void on_frame(const Frame& frame) = 0;
    // It could not be made, or went away; it is down already. `why` is valid during the call.
    virtual void on_lost(const char* why) = 0;

   protected:
    ~Listener() = default;
  };

  enum class State : std::uint8_t { down, connecting, up };

  // Before anything else. `listener` must outlive the connection.
  void report_to(Listener& listener) { listener_ = &listener; }

  virtual State state() const = 0;

  // Starts to connect, and tries each address for so long; on_lost() may be called at once.
  // REQUIRES: down.
  virtual void connect(const Endpoint& end, Instant now, Duration time_max) = 0;
  // Ends attempts to connect that take too long, and begins others.
  virtual void advance(Instant now) = 0;
  virtual Instant next_deadline() const = 0;

  // Sends a PDU that stands at frame[mbap_header_bytes]; on_lost() may be called at once. REQUIRES:
  // up.
  virtual void send(std::span<std::uint8_t> frame, std::uint16_t transaction, std::uint8_t address,
                    std::size_t pdu_bytes) = 0;

  // With nothing under way: takes what has come; on_frame() and on_lost() may be called. What is no
  // whole frame then is thrown away: it is the start of an answer that is too late.
  virtual void discard() = 0;

  // Is down then, and says nothing.
  virtual void close() = 0;
  // The same, and what was sent is thrown away as far as the other side has not taken it.
  virtual void abort() = 0;

 protected:
  ~FrameConnection() = default;
  Listener& listener() { return *listener_; }

 private:
  Listener* listener_ = nullptr;
};

}  // namespace etcm::port
