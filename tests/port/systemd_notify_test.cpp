// SystemdNotify against a real socket of the kind systemd has.
#include "posix/systemd_notify.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <string>

#include "support/allocation_watch.h"
#include "support/scratch_folder.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

class SystemdNotifyTest : public testing::Test {
 protected:
  SystemdNotifyTest() { clear(); }
  ~SystemdNotifyTest() override { clear(); }
  static void clear() {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) ::unsetenv(name);
  }
  // "@name" is in the abstract space.
  void listen(const std::string& path) {
    socket_ = FileDescriptor(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    if (path[0] == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
    ASSERT_EQ(::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), size), 0);
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
  }
  std::string received() {
    std::array<char, 4096> text{};
    const ssize_t size = ::recv(socket_.get(), text.data(), text.size(), 0);
    return size < 0 ? "nothing" : std::string(text.data(), static_cast<std::size_t>(size));
  }
  const test::ScratchFolder scratch_;
  FileDescriptor socket_;
};

TEST_F(SystemdNotifyTest, TellsSystemd) {
  listen(scratch_.path("notify"));
  SystemdNotify manager;
  manager.tell(ServiceEvent::ready);
  EXPECT_EQ(received(), "READY=1");
  manager.tell(ServiceEvent::alive);
  EXPECT_EQ(received(), "WATCHDOG=1");
  manager.tell(ServiceEvent::stopping);
  EXPECT_EQ(received(), "STOPPING=1");
  manager.tell(ServiceEvent::reloading);
  EXPECT_EQ(received().substr(0, 27), "RELOADING=1\nMONOTONIC_USEC=");
  manager.tell_status("3 nodes");
  EXPECT_EQ(received(), "STATUS=3 nodes");
  EXPECT_EQ(received(), "nothing");
}

TEST_F(SystemdNotifyTest, ReachesASocketWithoutAFile) {
  listen("@etcm-notify-" + std::to_string(::getpid()));
  SystemdNotify manager;
  manager.tell(ServiceEvent::ready);
  EXPECT_EQ(received(), "READY=1");
}

TEST_F(SystemdNotifyTest, KeepsAStatusALine) {
  listen(scratch_.path("notify"));
  SystemdNotify manager;
  manager.tell_status("a\nMAINPID=1\0b");
  EXPECT_EQ(received(), "STATUS=a MAINPID=1");
  manager.tell_status(std::string(10'000, 'x'));
  EXPECT_EQ(received().size(), 256u);
  manager.tell_status("a" + std::string(246, 'x') + "\u20ac");
  EXPECT_EQ(received(), "STATUS=a" + std::string(246, 'x'));
  manager.tell_status("");
  EXPECT_EQ(received(), "STATUS=");
}

TEST_F(SystemdNotifyTest, TellsNobodyWhereNobodyAsked) {
  for (const char* const path : {"", "@", "/", "relative", "/no/such/socket"}) {
    ::setenv("NOTIFY_SOCKET", path, 1);
    SystemdNotify manager;
    manager.tell(ServiceEvent::ready);
    manager.tell_status("x");
  }
  ::setenv("NOTIFY_SOCKET", ("/" + std::string(200, 'x')).c_str(), 1);
  SystemdNotify manager;
  manager.tell(ServiceEvent::ready);
  EXPECT_EQ(manager.watchdog_timeout(), 0s);
}

TEST_F(SystemdNotifyTest, KnowsItsWatchdog) {
  listen(scratch_.path("notify"));
  const auto timeout = [&](const char* usec, const std::string& pid) {
    ::setenv("NOTIFY_SOCKET", scratch_.path("notify").c_str(), 1);
    ::setenv("WATCHDOG_USEC", usec, 1);
    if (!pid.empty()) ::setenv("WATCHDOG_PID", pid.c_str(), 1);
    return SystemdNotify().watchdog_timeout();
  };
  EXPECT_EQ(timeout("30000000", ""), 30s);
  EXPECT_EQ(timeout("30000000", std::to_string(::getpid())), 30s);
  EXPECT_EQ(timeout("30000000", "1"), 0s) << "another process is watched";
  EXPECT_EQ(timeout("30000000", "x"), 0s);
  for (const char* const bad : {"", "0", "-1", "x", "1x", "99999999999999999999"}) {
    EXPECT_EQ(timeout(bad, ""), 0s) << bad;
  }
  EXPECT_EQ(timeout("9223372036854775807", ""), 24h);
}

TEST_F(SystemdNotifyTest, LeavesNothingForChildren) {
  listen(scratch_.path("notify"));
  ::setenv("WATCHDOG_USEC", "1000000", 1);
  const SystemdNotify manager;
  EXPECT_EQ(std::getenv("NOTIFY_SOCKET"), nullptr);
  EXPECT_EQ(std::getenv("WATCHDOG_USEC"), nullptr);
}

TEST_F(SystemdNotifyTest, DoesNotWaitForSystemdAndAllocatesNothing) {
  listen(scratch_.path("notify"));
  SystemdNotify manager;
  const test::AllocationWatch watch;
  for (int i = 0; i < 10'000; ++i) {
    manager.tell(ServiceEvent::alive);
    manager.tell_status("3 nodes");
  }
  EXPECT_EQ(watch.allocations(), 0u);
  EXPECT_EQ(received(), "WATCHDOG=1");
}

}  // namespace
}  // namespace etcm::port
