#include "posix/event_loop.h"

#include <poll.h>
#include <sys/epoll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <system_error>

namespace etcm::port {

EventLoop::EventLoop() : epoll_(::epoll_create1(EPOLL_CLOEXEC)) {
  if (!epoll_.is_open()) throw std::system_error(errno, std::generic_category(), "epoll_create1");
}

void EventLoop::add(int descriptor, EventHandler& handler, bool want_read, bool want_write) {
  const auto index = static_cast<std::size_t>(descriptor);
  if (index >= entries_.size()) entries_.resize(index + 1);
  entries_[index] = {&handler, ++registrations_};
  control(EPOLL_CTL_ADD, descriptor, want_read, want_write);
}

void EventLoop::change(int descriptor, bool want_read, bool want_write) {
  control(EPOLL_CTL_MOD, descriptor, want_read, want_write);
}

void EventLoop::remove(int descriptor) {
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, descriptor, nullptr);
  entries_[static_cast<std::size_t>(descriptor)].handler = nullptr;
}

void EventLoop::control(int operation, int descriptor, bool want_read, bool want_write) {
  const Entry& entry = entries_[static_cast<std::size_t>(descriptor)];
  epoll_event event{};
  event.events =
      (want_read ? std::uint32_t{EPOLLIN} : 0u) | (want_write ? std::uint32_t{EPOLLOUT} : 0u);
  event.data.u64 = std::uint64_t{entry.registration} << 32 | static_cast<std::uint32_t>(descriptor);
  if (::epoll_ctl(epoll_.get(), operation, descriptor, &event) != 0) {
    throw std::system_error(errno, std::generic_category(), "epoll_ctl");
  }
}

bool EventLoop::wait(Duration at_most) {
  // ppoll and not the timeout of epoll_wait: that has whole milliseconds, and half a frame of a
  // fast serial line passes in one.
  const auto pause = std::clamp<Duration>(at_most, Duration{0}, std::chrono::hours(24));
  const auto seconds = std::chrono::floor<std::chrono::seconds>(pause);
  const timespec timeout{.tv_sec = static_cast<time_t>(seconds.count()),
                         .tv_nsec = static_cast<long>((pause - seconds).count())};
  pollfd waiting{.fd = epoll_.get(), .events = POLLIN, .revents = 0};
  if (::ppoll(&waiting, 1, &timeout, nullptr) <= 0) return false;
  std::array<epoll_event, 256> events;
  const int count = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), 0);
  for (int i = 0; i < count; ++i) {
    const epoll_event& event = events[static_cast<std::size_t>(i)];
    const auto index = static_cast<std::size_t>(event.data.u64 & 0xffffffffu);
    const Entry entry = entries_[index];
    if (entry.handler == nullptr || entry.registration != event.data.u64 >> 32) continue;
    entry.handler->on_ready((event.events & ~std::uint32_t{EPOLLOUT}) != 0,
                            (event.events & EPOLLOUT) != 0);
  }
  return count > 0;
}

}  // namespace etcm::port
