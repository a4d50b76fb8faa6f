// The addresses of a host by its name. The system's resolver waits for name servers, so it is asked
// in a thread of its own; an answer that never comes holds up nobody.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "etcm/port/socket_address.h"
#include "posix/worker.h"

namespace etcm::port {

// What is found for a name: its addresses, or why there are none.
struct FoundHosts {
  // Of more, the first ones.
  static constexpr std::size_t hosts_max = 8;

  std::array<HostAddress, hosts_max> hosts;  // in the order in which to try them (RFC 6724)
  std::size_t count = 0;
  const char* why_none = nullptr;  // the system's words

  std::span<const HostAddress> all() const { return std::span(hosts).first(count); }
};

// Asks the resolver of the system, and waits for it. With `is_address` no one else is asked:
// nothing is found for a name, and there is no waiting.
FoundHosts find_hosts(const char* host, bool is_address);

class NameResolver {
 public:
  // Throws std::system_error where there is no descriptor or no thread for it.
  explicit NameResolver(std::string name);
  NameResolver(const NameResolver&) = delete;
  NameResolver& operator=(const NameResolver&) = delete;

  // Asks, unless an answer is still waited for: then that one is awaited.
  void start();
  // Readable when there is an answer. It stays the same.
  int descriptor() const;
  // The answer, once.
  std::optional<FoundHosts> take();

 private:
  struct Shared;

  std::shared_ptr<Shared> shared_;
  Worker worker_;
  bool is_asked_ = false;
};

}  // namespace etcm::port
