// RTU frames on a TCP connection, as most serial servers pass them on.
#pragma once

#include <string>

#include "modbus/rtu_line.h"
#include "posix/event_loop.h"
#include "posix/tcp_connector.h"

namespace etcm::port {

class RtuTcpLine final : public RtuLine, private EventHandler, private TcpConnector::Listener {
 public:
  // `loop` must outlive the line.
  RtuTcpLine(EventLoop& loop, const Endpoint& end) : loop_(loop), end_(end) {}
  ~RtuTcpLine() { close(); }
  RtuTcpLine(const RtuTcpLine&) = delete;
  RtuTcpLine& operator=(const RtuTcpLine&) = delete;

  // Starts to connect. That this failed is found while hearing, too.
  bool open(Instant now, std::string& why) override;
  void close() override;
  bool is_ready() const override { return socket_.is_open() && why_gone_.empty(); }
  void advance(Instant now) override { connector_.advance(now); }
  Instant next_deadline() const override { return connector_.next_deadline(); }
  const char* why_gone() const override { return why_gone_.empty() ? nullptr : why_gone_.c_str(); }
  void discard() override;
  bool is_sent() const override { return true; }

 private:
  bool write(std::span<const std::uint8_t> frame, std::string& why) override;
  void on_socket(FileDescriptor socket) override;
  void on_failure(const char* why) override { why_gone_ = why; }
  void on_ready(bool can_read, bool can_write) override;
  void receive();
  void lose(const char* why);

  EventLoop& loop_;
  TcpConnector connector_{loop_, *this};
  Endpoint end_;
  FileDescriptor socket_;
  std::string why_gone_;
};

}  // namespace etcm::port
