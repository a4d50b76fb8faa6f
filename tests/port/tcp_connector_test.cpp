// Connections by name and by address, to real sockets; the resolver is the system's, and asked only
// for what needs no network: localhost, and names that end in .invalid.
#include "posix/tcp_connector.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <optional>
#include <string>

#include "modbus/rtu_bus.h"
#include "modbus/rtu_tcp_line.h"
#include "modbus/tcp_bus.h"
#include "no_descriptors.h"
#include "peer.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

class Connector : public testing::Test, public TcpConnector::Listener {
 protected:
  void on_socket(FileDescriptor socket) override { socket_ = std::move(socket); }
  void on_failure(const char* why) override { failures_.emplace_back(why); }

  // Starts, and lets the system do what it does while no time passes for the connector.
  void start(const std::string& text) {
    connector_.start(*parse_endpoint(text), now_);
    EXPECT_TRUE(turn_until(loop_, [&] {
      connector_.advance(now_);
      return socket_.is_open() || !failures_.empty();
    }));
  }
  static std::string at(const char* host, const FileDescriptor& listener) {
    return std::string(host) + ":" + std::to_string(bound_address(listener.get()).port);
  }

  EventLoop loop_;
  FileDescriptor socket_;
  std::vector<std::string> failures_;
  Instant now_{1h};
  TcpConnector connector_{loop_, *this};
};

TEST_F(Connector, ConnectsToAddressesOfBothKinds) {
  for (const HostAddress& host : {loopback_ipv4, loopback_ipv6}) {
    const FileDescriptor listener = listen_tcp({.host = host, .port = 0});
    start(to_string(bound_address(listener.get())));
    ASSERT_TRUE(socket_.is_open()) << failures_.back();
    SocketAddress peer;
    EXPECT_TRUE(accept_tcp(listener.get(), &peer).is_open());
    EXPECT_EQ(peer.host, host);
    EXPECT_EQ(connector_.next_deadline(), never);
    socket_.close();
  }
}

TEST_F(Connector, ConnectsToAName) {
  const FileDescriptor listener = listen_tcp({.host = any_ipv6, .port = 0});
  for (int time = 0; time < 3; ++time) {
    start(at("localhost", listener));
    EXPECT_TRUE(socket_.is_open()) << failures_.back();
    socket_.close();
  }
}

// Whichever address the name leads to first, the other one is tried too.
TEST_F(Connector, TriesAllAddressesOfAName) {
  const FoundHosts found = find_hosts("localhost", false);
  ASSERT_GT(found.count, 0u);
  for (const HostAddress& host : found.all()) {
    const FileDescriptor listener = listen_tcp({.host = host, .port = 0});
    start(at("localhost", listener));
    EXPECT_TRUE(socket_.is_open()) << host_text(host);
    socket_.close();
  }
}

TEST_F(Connector, ARefusalNamesTheAddressBehindAName) {
  FileDescriptor listener = listen_tcp({.host = any_ipv6, .port = 0});
  const std::string end = at("localhost", listener);
  listener.close();
  start(end);
  ASSERT_EQ(failures_.size(), 1u);
  EXPECT_NE(
      failures_[0].find(": Connection refused; nothing listens there: check address and port"),
      std::string::npos)
      << failures_[0];
  const auto hosts = find_hosts("localhost", false);
  EXPECT_TRUE(failures_[0].starts_with(host_text(hosts.all().back()))) << failures_[0];
}

TEST_F(Connector, ANameThatIsNotThereComesWithTheCure) {
  start("no-such-host.invalid:502");
  ASSERT_EQ(failures_.size(), 1u);
  EXPECT_NE(failures_[0].find("`getent hosts no-such-host.invalid`"), std::string::npos)
      << failures_[0];
  failures_.clear();
  start("no-such-host.invalid:502");
  EXPECT_EQ(failures_.size(), 1u) << "it is asked for again";
}

TEST_F(Connector, AnInterfaceThatIsNotThereComesWithTheCure) {
  start("[fe80::1%no-such]:502");
  ASSERT_EQ(failures_.size(), 1u);
  EXPECT_NE(failures_[0].find("`ip link`"), std::string::npos) << failures_[0];
}

// A resolver that does not answer: its time is over before the thread could say anything.
TEST_F(Connector, ALookupEndsInTime) {
  connector_.start(*parse_endpoint("localhost:502"), now_);
  EXPECT_EQ(connector_.next_deadline(), now_ + TcpConnector::lookup_time_max);
  connector_.advance(now_ + TcpConnector::lookup_time_max);
  ASSERT_EQ(failures_.size(), 1u);
  EXPECT_NE(failures_[0].find("longer than 20 s; look at the name server"), std::string::npos)
      << failures_[0];
  EXPECT_EQ(connector_.next_deadline(), never);
  // What that thread says later is the answer to the next attempt.
  const FileDescriptor listener = listen_tcp({.host = any_ipv6, .port = 0});
  failures_.clear();
  start(at("localhost", listener));
  EXPECT_TRUE(socket_.is_open());
}

// A full queue of connections: the attempt is neither taken nor refused.
TEST_F(Connector, AnAddressThatDoesNotAnswerHasItsTime) {
  const FileDescriptor listener = listen_tcp({.host = loopback_ipv4, .port = 0});
  ASSERT_EQ(::listen(listener.get(), 0), 0);
  const FileDescriptor queued = connect_tcp(bound_address(listener.get()));
  pollfd made{.fd = queued.get(), .events = POLLOUT, .revents = 0};
  ASSERT_EQ(::poll(&made, 1, 20'000), 1);
  connector_.start(endpoint_of(bound_address(listener.get())), now_);
  EXPECT_EQ(connector_.next_deadline(), now_ + TcpConnector::connect_time_max);
  connector_.advance(now_ + TcpConnector::connect_time_max - 1ms);
  EXPECT_TRUE(failures_.empty());
  connector_.advance(now_ + TcpConnector::connect_time_max);
  EXPECT_EQ(failures_, std::vector<std::string>{
                           "no answer to the attempt to connect; check its address, cable and "
                           "power, and the network between"});
}

TEST_F(Connector, WhoStopsHearsNothingMore) {
  const FileDescriptor listener = listen_tcp({.host = any_ipv6, .port = 0});
  for (const char* host : {"localhost", "[::1]", "no-such-host.invalid"}) {
    connector_.start(*parse_endpoint(at(host, listener)), now_);
    connector_.stop();
    EXPECT_EQ(connector_.next_deadline(), never);
  }
  for (int turn = 0; turn < 20; ++turn) loop_.wait(5ms);
  EXPECT_FALSE(socket_.is_open());
  EXPECT_TRUE(failures_.empty());
}

TEST_F(Connector, AnotherNameIsNotAnsweredForTheEarlierOne) {
  const FileDescriptor listener = listen_tcp({.host = any_ipv6, .port = 0});
  connector_.start(*parse_endpoint("no-such-host.invalid:502"), now_);
  start(at("localhost", listener));
  EXPECT_TRUE(socket_.is_open());
  EXPECT_TRUE(failures_.empty());
}

TEST_F(Connector, WithoutDescriptorsItSaysSo) {
  if (needs_descriptors_itself) GTEST_SKIP() << "the sanitizer needs descriptors";
  const FileDescriptor listener = listen_tcp({.host = loopback_ipv4, .port = 0});
  {
    const NoDescriptors none;
    for (const char* host : {"127.0.0.1", "localhost"}) {
      failures_.clear();
      start(at(host, listener));
      ASSERT_EQ(failures_.size(), 1u);
      EXPECT_NE(failures_[0].find("Too many open files"), std::string::npos) << failures_[0];
    }
  }
  failures_.clear();
  start(at("127.0.0.1", listener));
  EXPECT_TRUE(socket_.is_open());
}

// Both kinds of buses, by name, with one line of the log for a name that is not there.
class NamedBus : public testing::Test {
 protected:
  template <class Bus>
  void expect_connected(Bus& bus, const FileDescriptor& listener) {
    EXPECT_TRUE(turn_until(loop_, [&] {
      bus.advance(now_);
      if (!peer_.is_open()) peer_ = accept_tcp(listener.get());
      return bus.ready();
    }));
  }
  template <class Bus>
  void expect_told_once(Bus& bus) {
    for (int attempt = 0; attempt < 3; ++attempt) {
      EXPECT_TRUE(turn_until(loop_, [&] {
        bus.advance(now_);
        return !log_.lines.empty() && bus.next_deadline() > now_ &&
               bus.next_deadline() < now_ + TcpConnector::lookup_time_max;
      }));
      now_ += 100ms;
    }
    ASSERT_EQ(log_.lines.size(), 1u);
    EXPECT_NE(log_.lines[0].find("bus yard: no-such-host.invalid:502: "), std::string::npos);
    EXPECT_NE(log_.lines[0].find("; correct the name"), std::string::npos) << log_.lines[0];
    EXPECT_NE(log_.lines[0].find("; trying again"), std::string::npos) << log_.lines[0];
  }
  Endpoint named(const FileDescriptor& listener) const {
    return {.host = "localhost", .port = bound_address(listener.get()).port};
  }

  EventLoop loop_;
  KeptLog log_;
  Instant now_{1h};
  FileDescriptor listener_ = listen_tcp({.host = any_ipv6, .port = 0});
  FileDescriptor peer_;
  const Endpoint nowhere_{.host = "no-such-host.invalid", .port = 502};
};

TEST_F(NamedBus, OverModbusTcp) {
  TcpBus bus(
      loop_, log_,
      {.name = "yard", .end = named(listener_), .outstanding_max = 1, .reconnect_interval = 100ms});
  expect_connected(bus, listener_);
  log_.lines.clear();
  TcpBus lost(loop_, log_,
              {.name = "yard", .end = nowhere_, .outstanding_max = 1, .reconnect_interval = 100ms});
  expect_told_once(lost);
}

TEST_F(NamedBus, WithRtuFrames) {
  const auto options = [](const Endpoint& end) {
    return RtuBusOptions{.name = "yard",
                         .serial_line = {},
                         .address = to_string(end),
                         .quiet = 20ms,
                         .reopen_interval = 100ms};
  };
  RtuTcpLine line(loop_, named(listener_));
  RtuBus bus(line, log_, options(named(listener_)));
  expect_connected(bus, listener_);
  log_.lines.clear();
  RtuTcpLine lost_line(loop_, nowhere_);
  RtuBus lost(lost_line, log_, options(nowhere_));
  expect_told_once(lost);
}

}  // namespace
}  // namespace etcm::port
