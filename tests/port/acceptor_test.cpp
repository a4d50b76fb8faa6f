// Acceptor: a port that cannot be had is had as soon as it can be.
#include "posix/acceptor.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "no_descriptors.h"
#include "peer.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

class AcceptorTest : public testing::Test, public AcceptHandler {
 protected:
  void accepted(FileDescriptor socket, const SocketAddress&) override {
    clients_.push_back(std::move(socket));
  }
  void exhausted(const char*) override {}

  testing::AssertionResult comes_in(const SocketAddress& address) {
    const std::size_t before = clients_.size();
    const FileDescriptor client = connect_tcp(address);
    return turn_until(loop_, [&] { return clients_.size() > before; });
  }

  EventLoop loop_;
  std::vector<FileDescriptor> clients_;
};

TEST_F(AcceptorTest, ATakenPortIsHadAsSoonAsItIsFree) {
  FileDescriptor other = listen_tcp({.host = 0x7f000001, .port = 0});
  const SocketAddress address = bound_address(other.get());
  Acceptor acceptor(loop_, *this, address);
  EXPECT_FALSE(acceptor.is_listening());
  EXPECT_EQ(acceptor.failure(),
            "cannot listen on " + to_string(address) + " (Address already in use)");
  EXPECT_EQ(acceptor.cure("`listen` of [http]"),
            "end the program that has it (`ss -ltnp` names it), or change `listen` of [http]");
  EXPECT_EQ(to_string(acceptor.address()), to_string(address));
  Instant now{1h};
  for (int i = 0; i < 100; ++i) {
    acceptor.advance(now);
    ASSERT_EQ(acceptor.next_deadline(), now + ListeningSocket::retry_interval);
    now = acceptor.next_deadline();
  }
  EXPECT_FALSE(acceptor.is_listening());
  other.close();
  acceptor.advance(now);
  EXPECT_TRUE(acceptor.is_listening());
  EXPECT_EQ(acceptor.failure(), "");
  EXPECT_EQ(acceptor.next_deadline(), never);
  EXPECT_TRUE(comes_in(address));
}

TEST_F(AcceptorTest, AnAddressThatIsNotOfThisMachineIsSaid) {
  // Of documents alone (RFC 5737).
  Acceptor acceptor(loop_, *this, {.host = 0xc0000201, .port = 8080});
  if (acceptor.is_listening()) GTEST_SKIP() << "this system lets anybody listen on any address";
  EXPECT_EQ(acceptor.failure(),
            "cannot listen on 192.0.2.1:8080 (Cannot assign requested address)");
  EXPECT_EQ(acceptor.cure("`listen` of [server]"),
            "this machine has no such address now: look at its network, or change `listen` of "
            "[server]");
}

TEST_F(AcceptorTest, WithoutDescriptorsItListensLater) {
  if (needs_descriptors_itself) GTEST_SKIP() << "the sanitizer needs descriptors";
  std::unique_ptr<Acceptor> acceptor;
  {
    const NoDescriptors none;
    acceptor =
        std::make_unique<Acceptor>(loop_, *this, SocketAddress{.host = 0x7f000001, .port = 0});
    EXPECT_FALSE(acceptor->is_listening());
    EXPECT_NE(acceptor->failure().find("Too many open files"), std::string::npos);
    EXPECT_EQ(acceptor->cure("http"), "raise LimitNOFILE of the service");
  }
  acceptor->advance(Instant{1h});
  EXPECT_TRUE(acceptor->is_listening());
  EXPECT_TRUE(comes_in(acceptor->address()));
}

TEST_F(AcceptorTest, WhoConnectsWhileItIsHeldWaits) {
  Acceptor acceptor(loop_, *this, {.host = 0x7f000001, .port = 0});
  acceptor.hold();
  const FileDescriptor client = connect_tcp(acceptor.address());
  for (int i = 0; i < 10; ++i) loop_.wait(1ms);
  EXPECT_TRUE(clients_.empty());
  acceptor.resume();
  EXPECT_TRUE(turn_until(loop_, [&] { return clients_.size() == 1; }));
}

}  // namespace
}  // namespace etcm::port
