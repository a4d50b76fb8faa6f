#include "modbus/line_share.h"

#include <algorithm>
#include <string>
#include <utility>

#include "posix/address_share.h"
#include "posix/exhaustion.h"

namespace etcm::port {

LineShare::LineShare(EventLoop& loop, Log& log, std::string name)
    : loop_(loop), log_(log), name_(std::move(name)) {
  update_counters();
}

void LineShare::update(const LineShareSettings& settings) {
  const bool moves = settings.listen != settings_.listen;
  settings_ = settings;
  if (moves && listener_) {
    update_counters();
    earlier_.requests = counters_.service.requests;
    earlier_.rejected += listener_->counters().rejected;
    listener_.reset();
  }
  RequestHandler& handler = *this;
  if (moves && settings.listen) listener_.emplace(loop_, handler, *settings.listen, clients_max);
  if (listener_) listener_->allow(settings.allow);
  update_counters();
}

void LineShare::advance(Instant now) {
  if (listener_) listener_->advance(now);
  for (std::size_t i = 0; i < requests_.size(); ++i) {
    Waiting& request = requests_[i];
    if (!request.is_used || i == under_way_) continue;
    if (!request.since) request.since = now;
    if (*request.since + settings_.wait_max > now) continue;
    count(ClientRefusal::busy);
    const std::array<std::uint8_t, 2> exception{
        static_cast<std::uint8_t>(request.pdu[0] | exception_bit),
        static_cast<std::uint8_t>(ClientRefusal::busy)};
    reply(request, exception);
  }
  update_counters();
}

Instant LineShare::next_deadline() const {
  Instant deadline = listener_ ? listener_->next_deadline() : never;
  for (std::size_t i = 0; i < requests_.size(); ++i) {
    const Waiting& request = requests_[i];
    if (!request.is_used || i == under_way_) continue;
    deadline = std::min(deadline, request.since ? *request.since + settings_.wait_max : Instant{});
  }
  return deadline;
}

bool LineShare::is_waiting() const {
  return under_way_ == nobody &&
         std::any_of(requests_.begin(), requests_.end(),
                     [](const Waiting& request) { return request.is_used; });
}

// Of the client whose turn it is, and of its requests the oldest.
bool LineShare::is_ahead(const Waiting& a, const Waiting& b) const {
  const auto turn = [&](const Waiting& request) {
    return (request.client + clients_max - last_client_ - 1) % clients_max;
  };
  return std::pair(turn(a), a.number) < std::pair(turn(b), b.number);
}

bool LineShare::next(ClientRequest& request) {
  if (!is_waiting()) return false;
  for (std::size_t i = 0; i < requests_.size(); ++i) {
    if (!requests_[i].is_used) continue;
    if (under_way_ == nobody || is_ahead(requests_[i], requests_[under_way_])) under_way_ = i;
  }
  const Waiting& first = requests_[under_way_];
  last_client_ = first.client;
  request = {.address = first.address, .pdu = std::span(first.pdu).first(first.pdu_bytes)};
  return true;
}

void LineShare::answer(std::span<const std::uint8_t> pdu) {
  ++counters_.answered;
  reply(requests_[std::exchange(under_way_, nobody)], pdu);
}

void LineShare::refuse(ClientRefusal why) {
  count(why);
  Waiting& request = requests_[std::exchange(under_way_, nobody)];
  const std::array<std::uint8_t, 2> exception{
      static_cast<std::uint8_t>(request.pdu[0] | exception_bit), static_cast<std::uint8_t>(why)};
  reply(request, exception);
}

void LineShare::reply(Waiting& request, std::span<const std::uint8_t> pdu) {
  request.is_used = false;
  if (request.is_orphan) return;
  // This may hang up on the client, which forgets its other requests.
  listener_->reply(request.client, request.transaction, request.address, pdu);
}

void LineShare::count(ClientRefusal why) {
  switch (why) {
    case ClientRefusal::busy:
      ++counters_.busy;
      return;
    case ClientRefusal::no_path:
      ++counters_.no_path;
      return;
    case ClientRefusal::no_answer:
      ++counters_.no_answer;
      return;
  }
}

void LineShare::update_counters() {
  ServiceCounters& service = counters_.service;
  const ServiceCounters now = listener_ ? listener_->counters() : ServiceCounters{};
  service.is_listening = now.is_listening;
  service.clients = now.clients;
  service.requests = earlier_.requests + now.requests;
  service.rejected = earlier_.rejected + refused_ + now.rejected;
}

std::size_t LineShare::answer(std::size_t client, std::uint8_t address,
                              std::span<const std::uint8_t> request,
                              std::span<std::uint8_t> answer) {
  if (const std::uint8_t exception = judge(address, request, settings_.rules)) {
    ++refused_;
    return write_exception(answer, request[0], exception);
  }
  const auto of_client =
      std::count_if(requests_.begin(), requests_.end(), [client](const Waiting& waiting) {
        return waiting.is_used && !waiting.is_orphan && waiting.client == client;
      });
  const auto place = std::find_if(requests_.begin(), requests_.end(),
                                  [](const Waiting& waiting) { return !waiting.is_used; });
  if (static_cast<std::size_t>(of_client) == TcpListener::replies_max || place == requests_.end()) {
    count(ClientRefusal::busy);
    return write_exception(answer, request[0], static_cast<std::uint8_t>(ClientRefusal::busy));
  }
  if (is_write_request(request) && !std::exchange(has_written_[client], true)) {
    log_.write(Level::info, "bus " + name_ + ": a client at " +
                                host_text(listener_->peer(client).host) + " writes to unit " +
                                std::to_string(address) + ", and perhaps to more");
  }
  place->is_used = true;
  place->is_orphan = false;
  place->client = client;
  place->transaction = listener_->transaction();
  place->address = address;
  place->number = ++last_number_;
  place->since.reset();
  place->pdu_bytes = request.size();
  std::copy(request.begin(), request.end(), place->pdu.begin());
  return 0;
}

void LineShare::connected(std::size_t client) { has_written_[client] = false; }

void LineShare::disconnected(std::size_t client) {
  for (std::size_t i = 0; i < requests_.size(); ++i) {
    Waiting& request = requests_[i];
    if (!request.is_used || request.is_orphan || request.client != client) continue;
    request.is_orphan = true;
    request.is_used = i == under_way_;
  }
}

void LineShare::rejected(const SocketAddress& peer, NoPlace why) {
  const auto words = [&]() -> std::string {
    switch (why) {
      case NoPlace::all_taken:
        return "all " + std::to_string(clients_max) + " places are taken";
      case NoPlace::share_taken:
        return "it has " + std::to_string(places_of_one_address(clients_max)) + " of " +
               std::to_string(clients_max) +
               " places, as many as one address may have; have it close those that it does not use";
      case NoPlace::not_allowed:
        break;
    }
    return "its network is not in share_allow; add it there if it may use the line";
  };
  log_.write(Level::warning,
             "bus " + name_ + ": a client at " + host_text(peer.host) + " is rejected: " + words());
}

void LineShare::displaced(const SocketAddress& peer) {
  log_.write(Level::info, "bus " + name_ + ": a client at " + host_text(peer.host) +
                              " is hung up on: it has asked nothing for over a minute, and "
                              "another one wants its place");
}

void LineShare::exhausted(const char* why) {
  log_.write(Level::error,
             "bus " + name_ + ": no further client can connect: " + why + "; " + descriptors_cure);
}

}  // namespace etcm::port
