// The server side of Modbus TCP: connections and frames; what to answer is the handler's business.
//
// One client never holds up another: bytes are taken as they come, an answer that does not fit the
// socket waits in the client's own buffer, and while that is full nothing more is read from it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "etcm/port/service_counters.h"
#include "modbus/frame.h"
#include "posix/acceptor.h"
#include "posix/event_loop.h"

namespace etcm::port {

// Why a client has no place.
enum class NoPlace : std::uint8_t {
  not_allowed,  // its network may not connect
  all_taken,
  share_taken,  // its address has as many as one may have
};

class RequestHandler {
 public:
  // A client took place `client`, below clients_max; whoever had it before is gone.
  virtual void connected(std::size_t client) = 0;
  virtual void disconnected(std::size_t client) = 0;
  // `peer` was rejected.
  virtual void rejected(const SocketAddress& peer, NoPlace why) {
    static_cast<void>(peer);
    static_cast<void>(why);
  }

  // `peer` was hung up on: it had been idle longest, and another one wants its place.
  virtual void displaced(const SocketAddress& peer) { static_cast<void>(peer); }
  // As AcceptHandler has it.
  virtual void exhausted(const char* why) { static_cast<void>(why); }

  // Writes the answer to a request of at least one byte into `answer` (pdu_bytes_max bytes) and
  // returns its length; 0 to stay silent, as a unit that is not there does, or to answer later with
  // TcpListener::reply().
  virtual std::size_t answer(std::size_t client, std::uint8_t address,
                             std::span<const std::uint8_t> request,
                             std::span<std::uint8_t> answer) = 0;

 protected:
  ~RequestHandler() = default;
};

class TcpListener final : private AcceptHandler {
 public:
  // A client that has asked nothing for so long makes room for another, where all places are taken.
  static constexpr Duration idle_max = std::chrono::minutes(1);
  static constexpr std::size_t replies_max = 4;

  // Listens at once; where it cannot, it tries again (posix/acceptor.h). `loop` and `handler` must
  // outlive this. A client beyond clients_max takes the place of the one that has been idle
  // longest, if that is over idle_max; else it is rejected. So does one beyond the share of its
  // address (posix/address_share.h), of those of that address.
  TcpListener(EventLoop& loop, RequestHandler& handler, const SocketAddress& address,
              std::size_t clients_max);
  ~TcpListener();
  TcpListener(const TcpListener&) = delete;
  TcpListener& operator=(const TcpListener&) = delete;

  // From now on only clients in these networks may connect, and others are hung up on. Until this
  // is called everybody may.
  void allow(std::vector<Network> networks);

  // Of the request that is being answered, during RequestHandler::answer().
  std::uint16_t transaction() const { return transaction_; }
  // REQUIRES: the client is connected.
  const SocketAddress& peer(std::size_t client) const;
  // Answers a request that was met with silence; at most replies_max of a client may be waiting for
  // it. The handler hears of a client that hangs up meanwhile. Not from within answer().
  void reply(std::size_t client, std::uint16_t transaction, std::uint8_t address,
             std::span<const std::uint8_t> pdu);

  // Lets time pass; without it no client is idle.
  void advance(Instant now);
  Instant next_deadline() const { return acceptor_.next_deadline(); }

  const Acceptor& acceptor() const { return acceptor_; }
  SocketAddress address() const { return acceptor_.address(); }
  const ServiceCounters& counters() const { return counters_; }

 private:
  class Client;

  void accepted(FileDescriptor socket, const SocketAddress& peer) override;
  void exhausted(const char* why) override { handler_.exhausted(why); }
  bool is_allowed(const SocketAddress& peer) const;
  Client* find_place(const SocketAddress& peer, NoPlace& why);

  EventLoop& loop_;
  RequestHandler& handler_;
  std::vector<std::unique_ptr<Client>> clients_;
  std::vector<Network> allowed_{everybody};
  ServiceCounters counters_;
  Instant now_{};
  std::uint16_t transaction_ = 0;
  Acceptor acceptor_;
};

}  // namespace etcm::port
