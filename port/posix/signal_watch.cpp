#include "posix/signal_watch.h"

#include <sys/signalfd.h>

#include <cerrno>
#include <csignal>
#include <system_error>

namespace etcm::port {

SignalWatch::SignalWatch(EventLoop& loop, std::initializer_list<int> signals) : loop_(loop) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals) sigaddset(&set, signal);
  sigprocmask(SIG_BLOCK, &set, nullptr);
  descriptor_ = FileDescriptor(::signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC));
  if (!descriptor_.is_open()) throw std::system_error(errno, std::generic_category(), "no signals");
  loop_.add(descriptor_.get(), *this, true, false);
}

SignalWatch::~SignalWatch() { loop_.remove(descriptor_.get()); }

void SignalWatch::on_ready(bool, bool) {
  signalfd_siginfo info;
  while (::read(descriptor_.get(), &info, sizeof info) == sizeof info) received_ = true;
}

}  // namespace etcm::port
