#include "posix/acceptor.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include "posix/exhaustion.h"

namespace etcm::port {

bool Acceptor::accept_from(int listener) {
  SocketAddress peer;
  FileDescriptor socket = accept_tcp(listener, &peer);
  if (!socket.is_open()) return false;
  handler_.accepted(std::move(socket), peer);
  return true;
}

std::string Acceptor::failure() const {
  if (is_listening()) return "";
  return "cannot listen on " + to_string(wanted_) + " (" + std::strerror(socket_.error()) + ")";
}

std::string Acceptor::cure(const std::string& listen) const {
  switch (socket_.error()) {
    case EADDRINUSE:
      return "end the program that has it (`ss -ltnp` names it), or change " + listen;
    case EADDRNOTAVAIL:
      return "this machine has no such address now: look at its network, or change " + listen;
    case EAFNOSUPPORT:
      return "this system has no IPv6: give an IPv4 address in " + listen;
    case EACCES:
      return "ports below 1024 are the system's: grant CAP_NET_BIND_SERVICE, or change " + listen;
    default:
      return is_exhaustion(socket_.error()) ? descriptors_cure : "look at " + listen;
  }
}

SocketAddress Acceptor::address() const {
  return is_listening() ? bound_address(socket_.descriptor()) : wanted_;
}

}  // namespace etcm::port
