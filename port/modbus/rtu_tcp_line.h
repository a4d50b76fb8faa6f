// RTU frames on a TCP connection, as most serial servers pass them on.
#pragma once

#include "etcm/port/socket_address.h"
#include "modbus/rtu_line.h"
#include "posix/event_loop.h"
#include "posix/file_descriptor.h"

namespace etcm::port {

class RtuTcpLine final : public RtuLine, private EventHandler {
 public:
  // `loop` must outlive the line.
  RtuTcpLine(EventLoop& loop, const SocketAddress& address) : loop_(loop), address_(address) {}
  ~RtuTcpLine() { close(); }
  RtuTcpLine(const RtuTcpLine&) = delete;
  RtuTcpLine& operator=(const RtuTcpLine&) = delete;

  // Starts to connect.
  bool open(std::string& why) override;
  void close() override;
  bool is_ready() const override { return is_connected_; }
  const char* why_gone() const override { return why_gone_; }
  void discard() override;
  bool is_sent() const override { return true; }

 private:
  bool write(std::span<const std::uint8_t> frame, std::string& why) override;
  void on_ready(bool can_read, bool can_write) override;
  void receive();
  void lose(const char* why);

  EventLoop& loop_;
  SocketAddress address_;
  FileDescriptor socket_;
  bool is_connected_ = false;
  const char* why_gone_ = nullptr;
};

}  // namespace etcm::port
