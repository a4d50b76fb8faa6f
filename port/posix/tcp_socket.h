// Non-blocking TCP sockets by numeric address.
#pragma once

#include "etcm/port/socket_address.h"
#include "posix/file_descriptor.h"

struct sockaddr_in;

namespace etcm::port {

// As the system has it.
sockaddr_in to_native(const SocketAddress& address);

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
