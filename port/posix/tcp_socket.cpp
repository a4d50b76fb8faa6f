#include "posix/tcp_socket.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <system_error>

namespace etcm::port {

namespace {

SocketAddress from_native(const sockaddr_in& native) {
  return {.host = ntohl(native.sin_addr.s_addr), .port = ntohs(native.sin_port)};
}

// Requests and answers are single small packets: waiting to fill one only adds delay.
void send_at_once(int descriptor) {
  const int on = 1;
  ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

FileDescriptor open_socket() {
  return FileDescriptor(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

}  // namespace

sockaddr_in to_native(const SocketAddress& address) {
  sockaddr_in native{};
  native.sin_family = AF_INET;
  native.sin_addr.s_addr = htonl(address.host);
  native.sin_port = htons(address.port);
  return native;
}

FileDescriptor try_listen_tcp(const SocketAddress& address) {
  FileDescriptor listener = open_socket();
  if (!listener.is_open()) return listener;
  const int on = 1;
  ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const sockaddr_in native = to_native(address);
  if (::bind(listener.get(), reinterpret_cast<const sockaddr*>(&native), sizeof native) != 0 ||
      ::listen(listener.get(), SOMAXCONN) != 0) {
    const int error = errno;
    listener.close();
    errno = error;
  }
  return listener;
}

FileDescriptor listen_tcp(const SocketAddress& address) {
  FileDescriptor listener = try_listen_tcp(address);
  if (!listener.is_open()) {
    throw std::system_error(errno, std::generic_category(),
                            "cannot listen on " + to_string(address));
  }
  return listener;
}

SocketAddress bound_address(int descriptor) {
  sockaddr_in native{};
  socklen_t size = sizeof native;
  ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&native), &size);
  return from_native(native);
}

FileDescriptor connect_tcp(const SocketAddress& address) {
  FileDescriptor socket = open_socket();
  if (!socket.is_open()) return socket;
  send_at_once(socket.get());
  const unsigned int unconfirmed_ms = 10'000;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_USER_TIMEOUT, &unconfirmed_ms, sizeof unconfirmed_ms);
  const sockaddr_in native = to_native(address);
  const int result =
      ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&native), sizeof native);
  if (result != 0 && errno != EINPROGRESS) return FileDescriptor{};
  return socket;
}

int connect_error(int descriptor) {
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

void reset_on_close(int descriptor) {
  const linger at_once{.l_onoff = 1, .l_linger = 0};
  ::setsockopt(descriptor, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
}

FileDescriptor accept_tcp(int listener, SocketAddress* peer) {
  sockaddr_in native{};
  socklen_t size = sizeof native;
  FileDescriptor socket(::accept4(listener, reinterpret_cast<sockaddr*>(&native), &size,
                                  SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (socket.is_open()) {
    if (peer != nullptr) *peer = from_native(native);
    send_at_once(socket.get());
    const int on = 1;
    const int idle_s = 60;
    ::setsockopt(socket.get(), SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    ::setsockopt(socket.get(), IPPROTO_TCP, TCP_KEEPIDLE, &idle_s, sizeof idle_s);
    ::setsockopt(socket.get(), IPPROTO_TCP, TCP_KEEPINTVL, &idle_s, sizeof idle_s);
  }
  return socket;
}

}  // namespace etcm::port
