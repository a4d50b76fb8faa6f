// RTU frames on a serial port of the system.
#pragma once

#include "etcm/port/serial_line.h"
#include "modbus/rtu_line.h"
#include "posix/event_loop.h"

namespace etcm::port {

class RtuSerialLine final : public RtuLine, private EventHandler {
 public:
  // `loop` must outlive the line.
  RtuSerialLine(EventLoop& loop, const SerialLine& line) : loop_(loop), settings_(line) {}
  ~RtuSerialLine() { close(); }
  RtuSerialLine(const RtuSerialLine&) = delete;
  RtuSerialLine& operator=(const RtuSerialLine&) = delete;

  bool open(Instant now, std::string& why) override;
  void close() override;
  const char* why_gone() const override { return is_gone_ ? "the port is gone" : nullptr; }
  void discard() override;
  bool is_sent() const override;

 private:
  bool write(std::span<const std::uint8_t> frame, std::string& why) override;
  void on_ready(bool can_read, bool can_write) override;
  bool receive();

  EventLoop& loop_;
  SerialLine settings_;
  FileDescriptor port_;
  bool is_gone_ = false;
};

}  // namespace etcm::port
