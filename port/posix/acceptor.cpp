#include "posix/acceptor.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include "posix/exhaustion.h"

namespace etcm::port {

Acceptor::Acceptor(EventLoop& loop, AcceptHandler& handler, const SocketAddress& address)
    : loop_(loop), handler_(handler), wanted_(address) {
  try_to_listen();
}

Acceptor::~Acceptor() {
  if (is_listening()) loop_.remove(socket_.get());
}

void Acceptor::try_to_listen() {
  socket_ = try_listen_tcp(wanted_);
  error_ = is_listening() ? 0 : errno;
  if (is_listening()) loop_.add(socket_.get(), *this, !is_held_, false);
}

void Acceptor::on_ready(bool, bool) {
  while (!is_held_) {
    SocketAddress peer;
    FileDescriptor socket = accept_tcp(socket_.get(), &peer);
    if (!socket.is_open()) {
      const int error = errno;
      if (!is_exhaustion(error)) return;
      is_resting_ = true;
      retry_at_ = now_ + retry_interval;
      watch();
      if (!std::exchange(is_exhaustion_told_, true)) handler_.exhausted(std::strerror(error));
      return;
    }
    is_exhaustion_told_ = false;
    handler_.accepted(std::move(socket), peer);
  }
}

void Acceptor::watch() {
  if (is_listening()) loop_.change(socket_.get(), !is_held_ && !is_resting_, false);
}

void Acceptor::hold() {
  is_held_ = true;
  watch();
}

void Acceptor::resume() {
  if (!is_held_ && !is_resting_) return;
  is_held_ = is_resting_ = false;
  watch();
}

void Acceptor::advance(Instant now) {
  now_ = now;
  if (now < next_deadline()) return;
  retry_at_ = now + retry_interval;
  if (!is_listening()) return try_to_listen();
  is_resting_ = false;
  watch();
}

std::string Acceptor::failure() const {
  if (is_listening()) return "";
  return "cannot listen on " + to_string(wanted_) + " (" + std::strerror(error_) + ")";
}

std::string Acceptor::cure(const std::string& listen) const {
  switch (error_) {
    case EADDRINUSE:
      return "end the program that has it (`ss -ltnp` names it), or change " + listen;
    case EADDRNOTAVAIL:
      return "this machine has no such address now: look at its network, or change " + listen;
    case EAFNOSUPPORT:
      return "this system has no IPv6: give an IPv4 address in " + listen;
    case EACCES:
      return "ports below 1024 are the system's: grant CAP_NET_BIND_SERVICE, or change " + listen;
    default:
      return is_exhaustion(error_) ? descriptors_cure : "look at " + listen;
  }
}

SocketAddress Acceptor::address() const {
  return is_listening() ? bound_address(socket_.get()) : wanted_;
}

}  // namespace etcm::port
