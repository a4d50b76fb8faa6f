// SIGTERM and SIGINT as an event: the loop ends where it is safe to.
#pragma once

#include "posix/signal_watch.h"

namespace etcm::port {

class StopSignal {
 public:
  // As SignalWatch; and a client that hangs up is an error of write(), not the end of the process.
  explicit StopSignal(EventLoop& loop);

  bool received() const { return watch_.received(); }

 private:
  SignalWatch watch_;
};

}  // namespace etcm::port
