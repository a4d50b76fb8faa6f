// Listens on a port and hands over who connects, for as long as it takes.
//
// Nothing that is in the way of it is in anybody else's way: a port that another program has, and
// an address that this machine does not have yet, are tried again; without descriptors it rests,
// for whoever waits to be accepted makes a listening socket ready all the time.
#pragma once

#include <string>

#include "posix/event_loop.h"
#include "posix/tcp_socket.h"

namespace etcm::port {

class AcceptHandler {
 public:
  virtual void accepted(FileDescriptor socket, const SocketAddress& peer) = 0;
  // Nobody more can connect for now: the system has no descriptor left, with its words for it. Said
  // once until somebody has connected.
  virtual void exhausted(const char* why) = 0;

 protected:
  ~AcceptHandler() = default;
};

class Acceptor final : private EventHandler {
 public:
  // It looks so often whether it can listen, and whether there are descriptors again.
  static constexpr Duration retry_interval = std::chrono::seconds(1);

  // Tries to listen at once. `loop` and `handler` must outlive this.
  Acceptor(EventLoop& loop, AcceptHandler& handler, const SocketAddress& address);
  ~Acceptor();
  Acceptor(const Acceptor&) = delete;
  Acceptor& operator=(const Acceptor&) = delete;

  void advance(Instant now);
  Instant next_deadline() const { return is_listening() && !is_resting_ ? never : retry_at_; }

  // Who connects waits until resume().
  void hold();
  // There may be a descriptor again, too.
  void resume();

  bool is_listening() const { return socket_.is_open(); }
  // "cannot listen on 127.0.0.1:80 (Permission denied)"; empty while it listens.
  std::string failure() const;
  // What to do about it, where `listen` is the key that has the address: "`listen` of [http]".
  std::string cure(const std::string& listen) const;
  // While it does not listen, what it would listen on.
  SocketAddress address() const;

 private:
  void on_ready(bool can_read, bool can_write) override;
  void try_to_listen();
  void watch();

  EventLoop& loop_;
  AcceptHandler& handler_;
  const SocketAddress wanted_;
  FileDescriptor socket_;
  int error_ = 0;  // why it does not listen
  bool is_held_ = false;
  bool is_resting_ = false;  // without descriptors
  bool is_exhaustion_told_ = false;
  Instant now_{};
  Instant retry_at_{};
};

}  // namespace etcm::port
