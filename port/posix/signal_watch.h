// Signals as events of the loop.
#pragma once

#include <initializer_list>
#include <utility>

#include "posix/event_loop.h"

namespace etcm::port {

class SignalWatch final : private EventHandler {
 public:
  // Blocks the signals for the whole process and watches for them in `loop`, which must outlive
  // this.
  SignalWatch(EventLoop& loop, std::initializer_list<int> signals);
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  bool received() const { return received_; }
  // Whether one came since the last call; several in a row count once.
  bool take_received() { return std::exchange(received_, false); }

 private:
  void on_ready(bool can_read, bool can_write) override;

  EventLoop& loop_;
  FileDescriptor descriptor_;
  bool received_ = false;
};

}  // namespace etcm::port
