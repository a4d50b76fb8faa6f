#include "modbus/tcp_listener.h"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "posix/address_share.h"

namespace etcm::port {

class TcpListener::Client final : private EventHandler {
 public:
  Client(TcpListener& listener, std::size_t index) : listener_(listener), index_(index) {}

  bool is_free() const { return !socket_.is_open(); }
  const SocketAddress& peer() const { return peer_; }

  void open(FileDescriptor socket, const SocketAddress& peer) {
    peer_ = peer;
    socket_ = std::move(socket);
    reader_.clear();
    unsent_begin_ = unsent_end_ = 0;
    has_asked_ = true;
    ++listener_.counters_.clients;
    listener_.loop_.add(socket_.get(), *this, true, false);
    listener_.handler_.connected(index_);
  }

  void close() {
    if (is_free()) return;
    listener_.loop_.remove(socket_.get());
    socket_.close();
    --listener_.counters_.clients;
    listener_.handler_.disconnected(index_);
    listener_.acceptor_.resume();
  }

  void reply(std::uint16_t transaction, std::uint8_t address, std::span<const std::uint8_t> pdu) {
    if (!has_room()) return close();
    const bool waited = is_waiting();
    const std::span<std::uint8_t> out = std::span(unsent_).subspan(unsent_end_, frame_bytes_max);
    std::copy(pdu.begin(), pdu.end(), out.begin() + mbap_header_bytes);
    unsent_end_ += write_header(out, transaction, address, pdu.size());
    if (!waited && !send()) return close();
    watch(waited);
  }

  void advance(Instant now) {
    if (std::exchange(has_asked_, false)) asked_at_ = now;
  }
  // Bytes that are no whole request, and answers that it does not take, are no sign of life.
  Instant asked_at() const { return has_asked_ ? never : asked_at_; }

 private:
  void on_ready(bool can_read, bool can_write) override {
    const bool waited = is_waiting();
    if (can_write && !send()) return close();
    if (can_read && !is_waiting() && (!receive() || !answer_all() || !send())) return close();
    watch(waited);
  }

  // While answers wait, the client's further requests wait too, in its own socket.
  void watch(bool waited) {
    if (is_waiting() != waited) listener_.loop_.change(socket_.get(), !is_waiting(), is_waiting());
  }

  bool is_waiting() const { return unsent_end_ > 0; }
  bool has_room() const { return unsent_.size() - unsent_end_ >= frame_bytes_max; }

  bool receive() {
    const std::span<std::uint8_t> space = reader_.free_space();
    const ssize_t count = ::recv(socket_.get(), space.data(), space.size(), 0);
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    reader_.received(static_cast<std::size_t>(count));
    return count > 0;
  }

  // False when what the client sends is no Modbus TCP, or asks for more at once than there is room
  // for.
  bool answer_all() {
    Frame request;
    FrameReader::Next next = reader_.next(request);
    for (; next == FrameReader::Next::frame; next = reader_.next(request)) {
      ++listener_.counters_.requests;
      has_asked_ = true;
      listener_.transaction_ = request.transaction;
      if (!has_room()) return false;
      const std::span<std::uint8_t> out = std::span(unsent_).subspan(unsent_end_, frame_bytes_max);
      const std::size_t pdu = listener_.handler_.answer(index_, request.address, request.pdu,
                                                        out.subspan(mbap_header_bytes));
      if (pdu > 0) unsent_end_ += write_header(out, request.transaction, request.address, pdu);
    }
    if (next == FrameReader::Next::broken) ++listener_.counters_.rejected;
    return next != FrameReader::Next::broken;
  }

  bool send() {
    while (unsent_begin_ < unsent_end_) {
      const ssize_t sent = ::send(socket_.get(), unsent_.data() + unsent_begin_,
                                  unsent_end_ - unsent_begin_, MSG_NOSIGNAL);
      if (sent < 0) return errno == EAGAIN || errno == EINTR;
      unsent_begin_ += static_cast<std::size_t>(sent);
    }
    unsent_begin_ = unsent_end_ = 0;
    return true;
  }

  TcpListener& listener_;
  std::size_t index_;
  FileDescriptor socket_;
  SocketAddress peer_;
  bool has_asked_ = false;  // since asked_at_
  Instant asked_at_{};
  FrameReader reader_;
  // Room for the answers to all requests for registers that the reader can hold, each of 12 bytes;
  // an exception is hardly longer than its request. And for those that come later. Only of long
  // identities, which 8 bytes ask for, there can be more.
  static constexpr std::size_t answers_max = 4 * frame_bytes_max / 12 + 1 + replies_max;
  std::array<std::uint8_t, answers_max * frame_bytes_max> unsent_;
  std::size_t unsent_begin_ = 0;
  std::size_t unsent_end_ = 0;
};

TcpListener::TcpListener(EventLoop& loop, RequestHandler& handler, const SocketAddress& address,
                         std::size_t clients_max)
    : loop_(loop), handler_(handler), acceptor_(loop, *this, address) {
  for (std::size_t i = 0; i < clients_max; ++i) {
    clients_.push_back(std::make_unique<Client>(*this, i));
  }
  counters_.is_listening = acceptor_.is_listening();
}

TcpListener::~TcpListener() {
  for (const auto& client : clients_) client->close();
}

void TcpListener::accepted(FileDescriptor socket, const SocketAddress& peer) {
  NoPlace why = NoPlace::not_allowed;
  if (Client* const place = is_allowed(peer) ? find_place(peer, why) : nullptr) {
    place->open(std::move(socket), peer);
  } else {
    ++counters_.rejected;
    handler_.rejected(peer, why);
  }
}

// A free place, or that of the client that has been idle for too long; null where there is neither.
TcpListener::Client* TcpListener::find_place(const SocketAddress& peer, NoPlace& why) {
  Client* free = nullptr;
  Client* idlest = nullptr;
  Client* own_idlest = nullptr;
  std::size_t own_count = 0;
  const auto look_at = [](Client*& longest, Client& client) {
    if (longest == nullptr || client.asked_at() < longest->asked_at()) longest = &client;
  };
  for (const auto& client : clients_) {
    if (client->is_free()) {
      free = client.get();
      continue;
    }
    look_at(idlest, *client);
    if (client->peer().host != peer.host) continue;
    ++own_count;
    look_at(own_idlest, *client);
  }
  const bool has_its_share = own_count >= places_of_one_address(clients_.size());
  if (!has_its_share && free != nullptr) return free;
  // Where one address may have all, it has all.
  why = has_its_share && free != nullptr ? NoPlace::share_taken : NoPlace::all_taken;
  Client* const longest = has_its_share ? own_idlest : idlest;
  if (longest == nullptr || longest->asked_at() == never ||
      now_ - longest->asked_at() <= idle_max) {
    return nullptr;
  }
  handler_.displaced(longest->peer());
  longest->close();
  return longest;
}

void TcpListener::advance(Instant now) {
  now_ = now;
  for (const auto& client : clients_) client->advance(now);
  acceptor_.advance(now);
  counters_.is_listening = acceptor_.is_listening();
}

const SocketAddress& TcpListener::peer(std::size_t client) const {
  return clients_[client]->peer();
}

void TcpListener::reply(std::size_t client, std::uint16_t transaction, std::uint8_t address,
                        std::span<const std::uint8_t> pdu) {
  clients_[client]->reply(transaction, address, pdu);
}

void TcpListener::allow(std::vector<Network> networks) {
  allowed_ = std::move(networks);
  for (const auto& client : clients_) {
    if (!client->is_free() && !is_allowed(client->peer())) client->close();
  }
}

bool TcpListener::is_allowed(const SocketAddress& peer) const {
  return any_contains(allowed_, peer.host);
}

}  // namespace etcm::port
