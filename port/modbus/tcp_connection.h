// A TCP connection that carries Modbus frames to a device and back. Nothing here waits; which
// answer belongs to which request is for its user.
#pragma once

#include <cstdint>
#include <span>

#include "etcm/port/socket_address.h"
#include "modbus/frame.h"
#include "posix/event_loop.h"

namespace etcm::port {

class TcpConnection final : private EventHandler {
 public:
  class Listener {
   public:
    virtual void on_connected() = 0;
    // The frame's PDU is valid during the call.
    virtual void on_frame(const Frame& frame) = 0;
    // It could not be made, or went away; it is down already.
    virtual void on_lost(const char* why) = 0;

   protected:
    ~Listener() = default;
  };

  enum class State : std::uint8_t { down, connecting, up };

  // Both must outlive the connection.
  TcpConnection(EventLoop& loop, Listener& listener) : loop_(loop), listener_(listener) {}
  ~TcpConnection() { close(); }
  TcpConnection(const TcpConnection&) = delete;
  TcpConnection& operator=(const TcpConnection&) = delete;

  State state() const { return state_; }

  // Starts to connect; on_lost() may be called at once. REQUIRES: down.
  void connect(const SocketAddress& address);

  // Sends a PDU that stands at frame[mbap_header_bytes]; on_lost() may be called at once. REQUIRES:
  // up.
  void send(std::span<std::uint8_t> frame, std::uint16_t transaction, std::uint8_t unit,
            std::size_t pdu_bytes);

  // With nothing under way: whatever has come is the start of an answer that is too late, and its
  // end would be taken for the start of the next one. Nobody hears of it.
  void discard();

  // Is down then, and says nothing.
  void close();
  // The same, and what was sent is thrown away as far as the other side has not taken it.
  void abort();

 private:
  void on_ready(bool can_read, bool can_write) override;
  void receive();
  void lose(const char* why);

  EventLoop& loop_;
  Listener& listener_;
  FileDescriptor socket_;
  State state_ = State::down;
  FrameReader reader_;
};

}  // namespace etcm::port
