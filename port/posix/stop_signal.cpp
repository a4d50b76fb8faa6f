#include "posix/stop_signal.h"

#include <sys/signalfd.h>

#include <cerrno>
#include <csignal>
#include <system_error>

namespace etcm::port {

StopSignal::StopSignal(EventLoop& loop) : loop_(loop) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  // A client that hangs up is an error of write(), not the end of the process.
  std::signal(SIGPIPE, SIG_IGN);
  descriptor_ = FileDescriptor(::signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC));
  if (!descriptor_.is_open()) throw std::system_error(errno, std::generic_category(), "signalfd");
  loop_.add(descriptor_.get(), *this, true, false);
}

StopSignal::~StopSignal() { loop_.remove(descriptor_.get()); }

void StopSignal::on_ready(bool, bool) {
  signalfd_siginfo info;
  while (::read(descriptor_.get(), &info, sizeof info) == sizeof info) received_ = true;
}

}  // namespace etcm::port
