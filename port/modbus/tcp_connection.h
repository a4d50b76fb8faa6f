// Modbus frames over a TCP connection.
#pragma once

#include "modbus/frame_connection.h"
#include "posix/event_loop.h"
#include "posix/tcp_connector.h"

namespace etcm::port {

class TcpConnection final : public FrameConnection,
                            private EventHandler,
                            private TcpConnector::Listener {
 public:
  // `loop` must outlive the connection.
  explicit TcpConnection(EventLoop& loop) : loop_(loop) {}
  TcpConnection(EventLoop& loop, FrameConnection::Listener& listener) : loop_(loop) {
    report_to(listener);
  }
  ~TcpConnection() { close(); }
  TcpConnection(const TcpConnection&) = delete;
  TcpConnection& operator=(const TcpConnection&) = delete;

  State state() const override { return state_; }
  void connect(const Endpoint& end, Instant now, Duration time_max) override;
  void advance(Instant now) override { connector_.advance(now); }
  Instant next_deadline() const override { return connector_.next_deadline(); }
  void send(std::span<std::uint8_t> frame, std::uint16_t transaction, std::uint8_t address,
            std::size_t pdu_bytes) override;
  void discard() override;
  void close() override;
  void abort() override;

 private:
  void on_socket(FileDescriptor socket) override;
  void on_failure(const char* why) override;
  void on_ready(bool can_read, bool can_write) override;
  void receive();
  void lose(const char* why);

  EventLoop& loop_;
  TcpConnector connector_{loop_, *this};
  FileDescriptor socket_;
  State state_ = State::down;
  FrameReader reader_;
};

}  // namespace etcm::port
