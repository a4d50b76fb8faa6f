// Non-blocking TCP sockets by numeric address.
#pragma once

#include <sys/socket.h>

#include "etcm/port/socket_address.h"
#include "posix/file_descriptor.h"

namespace etcm::port {

// As the system has it.
struct NativeAddress {
  sockaddr_storage storage{};
  socklen_t size = sizeof(sockaddr_storage);

  sockaddr* get() { return reinterpret_cast<sockaddr*>(&storage); }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};
NativeAddress to_native(const SocketAddress& address);
// REQUIRES: an address of IPv4 or IPv6.
SocketAddress from_native(const sockaddr* native);

// A listening socket; not open where it cannot be had: errno tells. Port 0 lets the system choose;
// bound_address() tells.
FileDescriptor try_listen_tcp(const SocketAddress& address);
// The same; throws std::system_error that names the address.
FileDescriptor listen_tcp(const SocketAddress& address);
SocketAddress bound_address(int descriptor);

// Starts to connect. The socket is writable once that ended; connect_error() then tells how.
// Not open when it failed at once. A connection whose peer does not confirm for 10 s what was sent
// fails.
FileDescriptor connect_tcp(const SocketAddress& address);
int connect_error(int descriptor);

// Closing it then ends the connection at once, without what waits to be sent.
void reset_on_close(int descriptor);

// Not open when there is nobody to accept, or nobody can be accepted: errno tells. Sets `peer` to
// who connected. A peer that vanishes without a word is found out within minutes.
FileDescriptor accept_tcp(int listener, SocketAddress* peer = nullptr);

}  // namespace etcm::port
