// A process that has no descriptors left.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

#include "posix/event_loop.h"
#include "support/sanitized.h"

namespace etcm::port {

// A sanitizer that meets a type for the first time looks at it through a pipe, and takes the type
// for a wrong one where it gets none: such a test is for the other builds.
inline constexpr bool needs_descriptors_itself = test::is_address_sanitized;

// Until the limit is lifted this process can open nothing.
class NoDescriptors {
 public:
  NoDescriptors() {
    EXPECT_EQ(::getrlimit(RLIMIT_NOFILE, &before_), 0);
    const int lowest_free = ::dup(STDERR_FILENO);
    EXPECT_EQ(::close(lowest_free), 0);
    rlimit none = before_;
    none.rlim_cur = static_cast<rlim_t>(lowest_free);
    EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;
  ~NoDescriptors() { EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &before_), 0); }

 private:
  rlimit before_{};
};

inline constexpr int turns_max = 1000;

// How often the loop turns in `time` with a server that has nothing to do but what it asks for:
// time passes only while nothing is ready. No more than turns_max are waited for.
template <class Server>
int turns_in(Duration time, EventLoop& loop, Server& server, Instant& now) {
  const Instant end = now + time;
  int turns = 0;
  for (; now < end && turns < turns_max; ++turns) {
    server.advance(now);
    if (!loop.wait(Duration{0})) now = std::max(now, std::min(server.next_deadline(), end));
  }
  return turns;
}

}  // namespace etcm::port
