#include "posix/stop_signal.h"

#include <csignal>

namespace etcm::port {

StopSignal::StopSignal(EventLoop& loop) : watch_(loop, {SIGTERM, SIGINT}) {
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace etcm::port
