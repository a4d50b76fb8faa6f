#include "posix/tcp_socket.h"

#include <netinet/in.h>
#include <netinet/tcp.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace etcm::port {

namespace {

// Requests and answers are single small packets: waiting to fill one only adds delay.
void send_at_once(int descriptor) {
  const int on = 1;
  ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

FileDescriptor open_socket(const SocketAddress& address) {
  const int family = address.host.is_ipv4() ? AF_INET : AF_INET6;
  return FileDescriptor(::socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

}  // namespace

NativeAddress to_native(const SocketAddress& address) {
  NativeAddress native;
  if (address.host.is_ipv4()) {
    sockaddr_in ipv4{};
    ipv4.sin_family = AF_INET;
    ipv4.sin_port = htons(address.port);
    std::memcpy(&ipv4.sin_addr, address.host.bytes.data() + 12, sizeof ipv4.sin_addr);
    std::memcpy(&native.storage, &ipv4, sizeof ipv4);
    native.size = sizeof ipv4;
  } else {
    sockaddr_in6 ipv6{};
    ipv6.sin6_family = AF_INET6;
    ipv6.sin6_port = htons(address.port);
    ipv6.sin6_scope_id = address.host.zone;
    std::memcpy(&ipv6.sin6_addr, address.host.bytes.data(), sizeof ipv6.sin6_addr);
    std::memcpy(&native.storage, &ipv6, sizeof ipv6);
    native.size = sizeof ipv6;
  }
  return native;
}

SocketAddress from_native(const sockaddr* native) {
  if (native->sa_family == AF_INET) {
    sockaddr_in ipv4{};
    std::memcpy(&ipv4, native, sizeof ipv4);
    return {.host = HostAddress{ntohl(ipv4.sin_addr.s_addr)}, .port = ntohs(ipv4.sin_port)};
  }
  sockaddr_in6 ipv6{};
  std::memcpy(&ipv6, native, sizeof ipv6);
  std::array<std::uint8_t, 16> bytes{};
  std::copy(std::begin(ipv6.sin6_addr.s6_addr), std::end(ipv6.sin6_addr.s6_addr), bytes.begin());
  return {.host = HostAddress{bytes, ipv6.sin6_scope_id}, .port = ntohs(ipv6.sin6_port)};
}

FileDescriptor try_listen_tcp(const SocketAddress& address) {
  FileDescriptor listener = open_socket(address);
  if (!listener.is_open()) return listener;
  const int on = 1;
  ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (address.host == any_ipv6) {
    const int off = 0;
    ::setsockopt(listener.get(), IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
  }
  const NativeAddress native = to_native(address);
  if (::bind(listener.get(), native.get(), native.size) != 0 ||
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
  NativeAddress native;
  ::getsockname(descriptor, native.get(), &native.size);
  return from_native(native.get());
}

FileDescriptor connect_tcp(const SocketAddress& address) {
  FileDescriptor socket = open_socket(address);
  if (!socket.is_open()) return socket;
  send_at_once(socket.get());
  const unsigned int unconfirmed_ms = 10'000;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_USER_TIMEOUT, &unconfirmed_ms, sizeof unconfirmed_ms);
  const NativeAddress native = to_native(address);
  if (::connect(socket.get(), native.get(), native.size) != 0 && errno != EINPROGRESS) {
    const int error = errno;
    socket.close();
    errno = error;
  }
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
  NativeAddress native;
  FileDescriptor socket(
      ::accept4(listener, native.get(), &native.size, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (socket.is_open()) {
    if (peer != nullptr) *peer = from_native(native.get());
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
