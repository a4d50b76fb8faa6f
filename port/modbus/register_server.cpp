#include "modbus/register_server.h"

#include <modbus/modbus.h>

#include <algorithm>
#include <string>
#include <utility>

#include "posix/address_share.h"
#include "posix/exhaustion.h"

namespace etcm::port {

RegisterServer::RegisterServer(EventLoop& loop, const SocketAddress& address,
                               std::size_t clients_max, const Identity& identity,
                               std::shared_ptr<const RegisterImage> first)
    : identity_(identity),
      image_(std::move(first)),
      pins_(clients_max),
      listener_(loop, *this, address, clients_max) {}

void RegisterServer::allow(std::vector<Network> networks, Log& log) {
  log_ = &log;
  listener_.allow(std::move(networks));
}

void RegisterServer::rejected(const SocketAddress& peer, NoPlace why) {
  if (log_ == nullptr) return;
  const auto words = [&]() -> std::string {
    switch (why) {
      case NoPlace::all_taken:
        return "all places are taken; raise clients_max in [server]";
      case NoPlace::share_taken:
        return "it has " + std::to_string(places_of_one_address(pins_.size())) +
               " connections, as many as one address may have of clients_max in [server]; have it "
               "close those that it does not use, or raise that";
      case NoPlace::not_allowed:
        break;
    }
    return "its network is not in allow of [server]; add it there if it may read the mesh";
  };
  log_->write(Level::warning, "a client at " + host_text(peer.host) + " is rejected: " + words());
}

void RegisterServer::displaced(const SocketAddress& peer) {
  if (log_ == nullptr) return;
  log_->write(Level::info,
              "a client at " + host_text(peer.host) +
                  " is hung up on: it has asked nothing for over a minute, and another "
                  "one wants its place; raise clients_max in [server] to keep both");
}

void RegisterServer::exhausted(const char* why) {
  if (log_ == nullptr) return;
  log_->write(Level::error, std::string("no further client can connect: ") + why + "; " +
                                descriptors_cure +
                                ", or lower clients_max in "
                                "[server] and [http]");
}

void RegisterServer::advance(Instant now) {
  listener_.advance(now);
  for (Pin& pin : pins_) {
    if (pin.image == nullptr) continue;
    if (std::exchange(pin.has_read_on, false)) pin.ends_at = now + keep_max;
    if (pin.ends_at <= now) pin = {};
  }
}

Instant RegisterServer::next_deadline() const {
  Instant first = listener_.next_deadline();
  for (const Pin& pin : pins_) first = std::min(first, pin.ends_at);
  return first;
}

std::size_t RegisterServer::answer(std::size_t client, std::uint8_t address,
                                   std::span<const std::uint8_t> request,
                                   std::span<std::uint8_t> answer) {
  if (const std::size_t size = write_identity_answer(answer, request, identity_)) return size;
  std::uint8_t exception = 0;
  const auto range = parse_read_request(request, exception);
  if (!range) return write_exception(answer, request[0], exception);

  // Masters address "the device itself" as 0 or 255 on TCP.
  const std::uint32_t page = address == 0 || address == MODBUS_TCP_SLAVE ? 0u : address - 1u;
  Pin& pin = pins_[client];
  if (page == 0 && range->first == 0) pin = {.image = image_};
  const RegisterImage& image = pin.image == nullptr ? *image_ : *pin.image;
  const std::size_t begin =
      std::min(std::size_t{page} * image.registers_per_unit, image.registers.size());
  const std::size_t end = begin + range->first + range->count;
  if (end > pin.read_to) {
    pin.read_to = end;
    pin.has_read_on = true;
  }
  const auto behind = std::span(image.registers).subspan(begin);
  return replies_.to_read(
      request, 0, behind.first(std::min<std::size_t>(behind.size(), image.registers_per_unit)),
      answer);
}

}  // namespace etcm::port
