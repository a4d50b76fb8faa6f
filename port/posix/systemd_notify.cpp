#include "posix/systemd_notify.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cinttypes>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <optional>
#include <string>

#include "etcm/port/utf8.h"

namespace etcm::port {

namespace {

std::string take_variable(const char* name) {
  const char* const value = std::getenv(name);
  std::string taken = value != nullptr ? value : "";
  ::unsetenv(name);
  return taken;
}

std::optional<std::int64_t> number_of(const std::string& text) {
  std::int64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || rest != end) return std::nullopt;
  return number;
}

// A day.
constexpr std::int64_t watchdog_us_max = 86'400'000'000;

}  // namespace

SystemdNotify::SystemdNotify() {
  const std::string path = take_variable("NOTIFY_SOCKET");
  const std::string watched = take_variable("WATCHDOG_PID");
  const auto timeout = number_of(take_variable("WATCHDOG_USEC"));
  // A path, or a name in the abstract space, which "@" stands for.
  if (path.size() < 2 || path.size() >= sizeof address_.sun_path) return;
  if (path[0] != '/' && path[0] != '@') return;
  address_.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), address_.sun_path);
  if (path[0] == '@') address_.sun_path[0] = '\0';
  address_size_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  socket_ = FileDescriptor(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const bool is_for_us = watched.empty() || number_of(watched) == std::int64_t{::getpid()};
  if (is_for_us && timeout && *timeout > 0) {
    watchdog_timeout_ = std::chrono::microseconds(std::min(*timeout, watchdog_us_max));
  }
}

void SystemdNotify::tell(ServiceEvent event) {
  switch (event) {
    case ServiceEvent::ready:
      return send("READY=1");
    case ServiceEvent::reloading: {
      // Type=notify-reload asks since when, to tell this reload from an earlier one.
      timespec now{};
      ::clock_gettime(CLOCK_MONOTONIC, &now);
      const std::int64_t us = std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1000;
      std::array<char, 64> text{};
      const int size =
          std::snprintf(text.data(), text.size(), "RELOADING=1\nMONOTONIC_USEC=%" PRId64, us);
      return send({text.data(), static_cast<std::size_t>(size)});
    }
    case ServiceEvent::stopping:
      return send("STOPPING=1");
    case ServiceEvent::alive:
      return send("WATCHDOG=1");
  }
}

void SystemdNotify::tell_status(std::string_view line) {
  std::array<char, 256> text;
  constexpr std::string_view head = "STATUS=";
  line = cut_utf8(line, text.size() - head.size());
  char* const start = std::copy(head.begin(), head.end(), text.begin());
  char* const end = std::copy(line.begin(), line.end(), start);
  // A line end would begin another assignment.
  std::replace_if(
      start, end, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  send({text.data(), static_cast<std::size_t>(end - text.data())});
}

void SystemdNotify::send(std::string_view message) {
  if (!socket_.is_open()) return;
  // What a full socket does not take is lost; the next one comes.
  static_cast<void>(::sendto(socket_.get(), message.data(), message.size(), MSG_NOSIGNAL,
                             reinterpret_cast<const sockaddr*>(&address_), address_size_));
}

}  // namespace etcm::port
