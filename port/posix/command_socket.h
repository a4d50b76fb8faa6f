// Takes commands at a Unix socket, which nobody reaches over a network: one line from each client,
// and one answer.
//
// Only root and the user of this program may connect. A client that neither says nor takes anything
// for client_patience is hung up on; while all places are taken, and while the system has no
// descriptor left, others wait.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "etcm/port/commands.h"
#include "etcm/port/log.h"
#include "posix/event_loop.h"
#include "posix/listening_socket.h"

namespace etcm::port {

inline constexpr std::size_t command_bytes_max = 4096;

class CommandSocket final : private ListeningHandler {
 public:
  static constexpr Duration client_patience = std::chrono::seconds(10);

  // All must outlive this. A socket that a dead program left at `path` is replaced; what else is in
  // the way is said to the log once, and tried again.
  CommandSocket(EventLoop& loop, std::string path, CommandHandler& handler, Log& log);
  ~CommandSocket();
  CommandSocket(const CommandSocket&) = delete;
  CommandSocket& operator=(const CommandSocket&) = delete;

  void advance(Instant now);
  Instant next_deadline() const;

  bool is_listening() const { return socket_.is_listening(); }

 private:
  class Client final : public EventHandler {
   public:
    void open(CommandSocket& owner, std::size_t number, FileDescriptor socket);
    void close();
    bool is_open() const { return socket_.is_open(); }
    Instant active_at() const { return active_at_; }

   private:
    void on_ready(bool can_read, bool can_write) override;
    void take();
    void give();

    CommandSocket* owner_ = nullptr;
    std::size_t number_ = 0;
    FileDescriptor socket_;
    Instant active_at_{};
    bool is_answering_ = false;
    std::size_t begin_ = 0;  // of what waits to be sent
    std::size_t size_ = 0;   // of what is in the buffer
    std::array<char, command_bytes_max> buffer_;
  };

  FileDescriptor try_to_listen() override;
  bool accept_from(int listener) override;
  void exhausted(const char* why) override;
  Client* free_place();
  // Not open where it does not listen: `failed` then tells at what, and errno why.
  FileDescriptor listen(const char*& failed) const;

  EventLoop& loop_;
  const std::string path_;
  CommandHandler& handler_;
  Log& log_;
  std::array<Client, command_clients_max> clients_;
  Instant now_{};
  bool is_told_ = false;  // that it does not listen
  ListeningSocket socket_;
};

}  // namespace etcm::port
