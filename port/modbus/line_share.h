// A Modbus TCP server by which others ask the units of a bus, one request after the other, when the
// gateway lets them (etcm/port/line_clients.h).
//
// What may not be sent is answered at once (client_request.h). Of each client so many requests wait
// as TcpListener::replies_max says, one more is refused as busy; clients have turns, each its
// oldest request. One that has waited for `wait_max` is refused as busy too, and one whose client
// has hung up is forgotten; if it is on the line already, its answer is dropped. No memory is taken
// but when it begins to listen.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "etcm/port/line_clients.h"
#include "etcm/port/log.h"
#include "modbus/client_request.h"
#include "modbus/tcp_listener.h"

namespace etcm::port {

struct LineShareSettings {
  std::optional<SocketAddress> listen;  // none: the bus is not shared
  std::vector<Network> allow{};
  ClientRules rules{};
  Duration wait_max{};
};

class LineShare final : public LineClients, private RequestHandler {
 public:
  static constexpr std::size_t clients_max = 8;

  // Does not listen yet. `loop` and `log` must outlive this; `name` is the bus, for the log.
  LineShare(EventLoop& loop, Log& log, std::string name);

  // Listens there, or no more; those who may no longer connect are hung up on. What waits stays,
  // unless the address is another.
  void update(const LineShareSettings& settings);

  void advance(Instant now);
  Instant next_deadline() const;

  // Null while it is not shared.
  const Acceptor* acceptor() const { return listener_ ? &listener_->acceptor() : nullptr; }

  bool is_shared() const override { return listener_.has_value(); }
  bool is_waiting() const override;
  bool next(ClientRequest& request) override;
  void answer(std::span<const std::uint8_t> pdu) override;
  void refuse(ClientRefusal why) override;
  const ClientCounters& counters() const override { return counters_; }

 private:
  static constexpr std::size_t requests_max = clients_max * TcpListener::replies_max;
  static constexpr std::size_t nobody = requests_max;

  struct Waiting {
    bool is_used = false;
    bool is_orphan = false;  // its client has hung up
    std::size_t client = 0;
    std::uint16_t transaction = 0;
    std::uint8_t address = 0;
    std::uint64_t number = 0;      // by age
    std::optional<Instant> since;  // none before the next advance()
    std::size_t pdu_bytes = 0;
    std::array<std::uint8_t, pdu_bytes_max> pdu;
  };

  void connected(std::size_t client) override;
  void disconnected(std::size_t client) override;
  void rejected(const SocketAddress& peer, NoPlace why) override;
  void displaced(const SocketAddress& peer) override;
  void exhausted(const char* why) override;
  std::size_t answer(std::size_t client, std::uint8_t address,
                     std::span<const std::uint8_t> request,
                     std::span<std::uint8_t> answer) override;

  bool is_ahead(const Waiting& a, const Waiting& b) const;
  void reply(Waiting& request, std::span<const std::uint8_t> pdu);
  void count(ClientRefusal why);
  void update_counters();

  EventLoop& loop_;
  Log& log_;
  const std::string name_;
  LineShareSettings settings_;
  ServiceCounters earlier_;  // of listeners before it
  std::uint64_t refused_ = 0;
  ClientCounters counters_;
  std::array<Waiting, requests_max> requests_{};
  std::size_t under_way_ = nobody;
  std::size_t last_client_ = 0;
  std::uint64_t last_number_ = 0;
  std::array<bool, clients_max> has_written_{};  // and the log says so
  std::optional<TcpListener> listener_;          // the last one: its end is told to this
};

}  // namespace etcm::port
