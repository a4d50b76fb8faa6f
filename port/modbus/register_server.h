// MeshServer over Modbus TCP: FC 3 and FC 4 read the same image, FC 17 and FC 43/14 tell what
// serves it, nothing can be written.
#pragma once

#include <memory>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/mesh_server.h"
#include "modbus/identity.h"
#include "modbus/replies.h"
#include "modbus/tcp_listener.h"

namespace etcm::port {

class RegisterServer final : public MeshServer, private RequestHandler {
 public:
  // A client goes on with the image whose header it has read for so long after that, and after each
  // read that went beyond all before.
  static constexpr Duration keep_max = std::chrono::seconds(10);

  // Serves `first` until something is published. The texts of `identity` must outlive this.
  RegisterServer(EventLoop& loop, const SocketAddress& address, std::size_t clients_max,
                 const Identity& identity, std::shared_ptr<const RegisterImage> first);

  void publish(std::shared_ptr<const RegisterImage> image) override { image_ = std::move(image); }
  // As TcpListener has it. `log`, which must outlive this, is told which peers are rejected or hung
  // up on.
  void allow(std::vector<Network> networks, Log& log);
  void advance(Instant now);
  Instant next_deadline() const;
  const Acceptor& acceptor() const { return listener_.acceptor(); }
  SocketAddress address() const { return listener_.address(); }
  const ServiceCounters& counters() const { return listener_.counters(); }

 private:
  // What a client goes on with, so that all it reads belongs together.
  struct Pin {
    std::shared_ptr<const RegisterImage> image;  // null: whatever is the newest
    std::size_t read_to = 0;                     // no element from this one on was read
    bool has_read_on = false;                    // since the last advance()
    Instant ends_at = never;
  };

  void connected(std::size_t client) override { pins_[client] = {}; }
  void disconnected(std::size_t client) override { pins_[client] = {}; }
  void rejected(const SocketAddress& peer, NoPlace why) override;
  void displaced(const SocketAddress& peer) override;
  void exhausted(const char* why) override;
  std::size_t answer(std::size_t client, std::uint8_t address,
                     std::span<const std::uint8_t> request,
                     std::span<std::uint8_t> answer) override;

  const Identity identity_;
  std::shared_ptr<const RegisterImage> image_;
  std::vector<Pin> pins_;  // by client
  Log* log_ = nullptr;
  Replies replies_;
  TcpListener listener_;
};

}  // namespace etcm::port
