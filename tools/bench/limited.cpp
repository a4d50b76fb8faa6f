#include "bench/limited.h"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>

namespace etcm::bench {
namespace {

bool write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

bool read_all(int file, std::chrono::milliseconds limit, std::span<std::byte> bytes) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!bytes.empty()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline - std::chrono::steady_clock::now());
    pollfd waited{file, POLLIN, 0};
    if (left.count() <= 0 || poll(&waited, 1, static_cast<int>(left.count())) <= 0) return false;
    const ssize_t got = read(file, bytes.data(), bytes.size());
    if (got <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

}  // namespace

bool run_in_child(std::chrono::milliseconds limit, std::span<std::byte> result,
                  const std::function<void(std::span<std::byte>)>& measure) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return false;
  // What is still buffered would be printed by both processes.
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    measure(result);
    _exit(write_all(ends[1], result) ? 0 : 1);
  }
  close(ends[1]);
  const bool done = child > 0 && read_all(ends[0], limit, result);
  close(ends[0]);
  if (child > 0) {
    if (!done) kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
  }
  return done;
}

}  // namespace etcm::bench
