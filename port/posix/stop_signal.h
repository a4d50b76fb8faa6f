// SIGTERM and SIGINT as an event: the loop ends where it is safe to.
#pragma once

#include "posix/event_loop.h"

namespace etcm::port {

class StopSignal final : private EventHandler {
 public:
  // Blocks the two signals for the whole process and watches for them in `loop`, which must outlive
  // this.
  explicit StopSignal(EventLoop& loop);
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  bool received() const { return received_; }

 private:
  void on_ready(bool can_read, bool can_write) override;

  EventLoop& loop_;
  FileDescriptor descriptor_;
  bool received_ = false;
};

}  // namespace etcm::port
