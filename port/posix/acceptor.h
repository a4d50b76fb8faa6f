// Listens on a port of TCP and hands over who connects.
#pragma once

#include <string>

#include "posix/listening_socket.h"
#include "posix/tcp_socket.h"

namespace etcm::port {

class AcceptHandler {
 public:
  virtual void accepted(FileDescriptor socket, const SocketAddress& peer) = 0;
  // As ListeningHandler has it.
  virtual void exhausted(const char* why) = 0;

 protected:
  ~AcceptHandler() = default;
};

class Acceptor final : private ListeningHandler {
 public:
  // Tries to listen at once. `loop` and `handler` must outlive this.
  Acceptor(EventLoop& loop, AcceptHandler& handler, const SocketAddress& address)
      : handler_(handler), wanted_(address), socket_(loop, *this) {}

  void advance(Instant now) { socket_.advance(now); }
  Instant next_deadline() const { return socket_.next_deadline(); }

  // As ListeningSocket has them.
  void hold() { socket_.hold(); }
  void resume() { socket_.resume(); }

  bool is_listening() const { return socket_.is_listening(); }
  // "cannot listen on 127.0.0.1:80 (Permission denied)"; empty while it listens.
  std::string failure() const;
  // What to do about it, where `listen` is the key that has the address: "`listen` of [http]".
  std::string cure(const std::string& listen) const;
  // While it does not listen, what it would listen on.
  SocketAddress address() const;

 private:
  FileDescriptor try_to_listen() override { return try_listen_tcp(wanted_); }
  bool accept_from(int listener) override;
  void exhausted(const char* why) override { handler_.exhausted(why); }

  AcceptHandler& handler_;
  const SocketAddress wanted_;
  ListeningSocket socket_;
};

}  // namespace etcm::port
