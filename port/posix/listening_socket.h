// A socket that is listened on, of whichever kind, for as long as it takes.
//
// Nothing that is in the way of it is in anybody else's way: a place that somebody else has, or
// that is not there yet, is tried again; without descriptors it rests, for whoever waits to be
// accepted makes a listening socket ready all the time.
#pragma once

#include "posix/event_loop.h"
#include "posix/file_descriptor.h"

namespace etcm::port {

// Of which kind it is, and what becomes of who connects.
class ListeningHandler {
 public:
  // A socket that listens; not open where it cannot be had: errno tells.
  virtual FileDescriptor try_to_listen() = 0;
  // Takes one of those who wait. False where there is none, or none can be taken: errno tells.
  virtual bool accept_from(int listener) = 0;
  // Nobody more can connect for now: the system has no descriptor left, with its words for it. Said
  // once until somebody has connected.
  virtual void exhausted(const char* why) = 0;

 protected:
  ~ListeningHandler() = default;
};

class ListeningSocket final : private EventHandler {
 public:
  // It looks so often whether it can listen, and whether there are descriptors again.
  static constexpr Duration retry_interval = std::chrono::seconds(1);

  // Tries to listen at once. Both must outlive this.
  ListeningSocket(EventLoop& loop, ListeningHandler& handler);
  ~ListeningSocket();
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;

  void advance(Instant now);
  Instant next_deadline() const { return is_listening() && !is_resting_ ? never : retry_at_; }

  // Who connects waits until resume().
  void hold();
  // There may be a descriptor again, too.
  void resume();

  bool is_listening() const { return socket_.is_open(); }
  // Why it does not listen, as errno has it.
  int error() const { return error_; }
  // REQUIRES: it listens.
  int descriptor() const { return socket_.get(); }

 private:
  void on_ready(bool can_read, bool can_write) override;
  void try_to_listen();
  void watch();

  EventLoop& loop_;
  ListeningHandler& handler_;
  FileDescriptor socket_;
  int error_ = 0;
  bool is_held_ = false;
  bool is_resting_ = false;  // without descriptors
  bool is_exhaustion_told_ = false;
  Instant now_{};
  Instant retry_at_{};
};

}  // namespace etcm::port
