#include "posix/name_resolver.h"

#include <netdb.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <system_error>
#include <utility>

#include "posix/file_descriptor.h"
#include "posix/tcp_socket.h"

namespace etcm::port {

namespace {

// What the thread has left to do once its answer is there: to return.
constexpr Duration return_time_max = std::chrono::seconds(1);

}  // namespace

FoundHosts find_hosts(const char* host, bool is_address) {
  addrinfo wanted{};
  wanted.ai_flags = is_address ? AI_NUMERICHOST : 0;
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  const int error = ::getaddrinfo(host, nullptr, &wanted, &list);
  FoundHosts found;
  if (error != 0) {
    found.why_none = error == EAI_SYSTEM ? std::strerror(errno) : ::gai_strerror(error);
    return found;
  }
  for (const addrinfo* at = list; at != nullptr && found.count < FoundHosts::hosts_max;
       at = at->ai_next) {
    found.hosts[found.count++] = from_native(at->ai_addr).host;
  }
  ::freeaddrinfo(list);
  return found;
}

struct NameResolver::Shared {
  explicit Shared(std::string of) : name(std::move(of)) {
    if (!ready.is_open()) throw std::system_error(errno, std::generic_category(), "eventfd");
  }
  const std::string name;
  const FileDescriptor ready{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  std::mutex mutex;
  FoundHosts found;
};

NameResolver::NameResolver(std::string name)
    : shared_(std::make_shared<Shared>(std::move(name))), worker_("resolver", [shared = shared_] {
        const FoundHosts found = find_hosts(shared->name.c_str(), false);
        const std::lock_guard lock(shared->mutex);
        shared->found = found;
        const std::uint64_t one = 1;
        static_cast<void>(::write(shared->ready.get(), &one, sizeof one));
      }) {}

void NameResolver::start() {
  if (is_asked_) return;
  // Where that thread gets no time at all, the next attempt finds it ready.
  if (!worker_.wait(return_time_max)) return;
  is_asked_ = true;
  worker_.start();
}

int NameResolver::descriptor() const { return shared_->ready.get(); }

std::optional<FoundHosts> NameResolver::take() {
  const std::lock_guard lock(shared_->mutex);
  std::uint64_t count = 0;
  if (::read(shared_->ready.get(), &count, sizeof count) != sizeof count) return std::nullopt;
  is_asked_ = false;
  return shared_->found;
}

}  // namespace etcm::port
