// Waits for sockets and lines: one thread, epoll, level-triggered.
#pragma once

#include <cstdint>
#include <vector>

#include "etcm/port/clock.h"
#include "posix/file_descriptor.h"

namespace etcm::port {

class EventHandler {
 public:
  // `can_read` is also set on an error or a hang-up: the next read() or write() tells which.
  virtual void on_ready(bool can_read, bool can_write) = 0;

 protected:
  ~EventHandler() = default;
};

class EventLoop {
 public:
  EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  // The handler must stay until remove(). A handler may remove any descriptor, its own included.
  void add(int descriptor, EventHandler& handler, bool want_read, bool want_write);
  void change(int descriptor, bool want_read, bool want_write);
  void remove(int descriptor);

  // Waits until something is ready, or for `at_most` (to the microsecond, as far as the system
  // can), and calls the handlers of all that is ready. False where nothing was.
  bool wait(Duration at_most);

 private:
  struct Entry {
    EventHandler* handler = nullptr;
    std::uint32_t registration = 0;  // tells a reused descriptor number from its predecessor
  };

  void control(int operation, int descriptor, bool want_read, bool want_write);

  FileDescriptor epoll_;
  std::vector<Entry> entries_;  // by descriptor number
  std::uint32_t registrations_ = 0;
};

}  // namespace etcm::port
