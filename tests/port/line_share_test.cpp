// Others on a bus: real connections, and the test in the gateway's place.
#include "modbus/line_share.h"

#include <gtest/gtest.h>

#include <random>

#include "mutation.h"
#include "peer.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

constexpr Duration wait_max = 500ms;

class SharedLine : public testing::Test {
 protected:
  SharedLine() { share_.update(settings_); }

  FileDescriptor connect() {
    FileDescriptor client = connect_tcp(share_.acceptor()->address());
    pollfd writable{.fd = client.get(), .events = POLLOUT, .revents = 0};
    EXPECT_EQ(::poll(&writable, 1, 20'000), 1);
    return client;
  }

  // Takes the next request, which must be this; it is under way then.
  void expect_next(std::uint8_t unit, const Bytes& pdu) {
    ClientRequest request;
    ASSERT_TRUE(turn_until(loop_, [&] { return share_.is_waiting(); }));
    ASSERT_TRUE(share_.next(request));
    EXPECT_EQ(request.address, unit);
    EXPECT_EQ(Bytes(request.pdu.begin(), request.pdu.end()), pdu);
    EXPECT_FALSE(share_.is_waiting()) << "one is under way";
  }

  void expect_bytes(const FileDescriptor& client, const Bytes& expected) {
    Bytes bytes;
    EXPECT_TRUE(turn_until(loop_, [&] {
      receive_available(client.get(), bytes);
      return bytes.size() >= expected.size();
    }));
    EXPECT_EQ(bytes, expected);
  }

  // Until all that was sent has been taken in.
  void turn_for_requests(std::uint64_t requests) {
    EXPECT_TRUE(turn_until(loop_, [&] {
      share_.advance(now_);
      return share_.counters().service.requests >= requests;
    }));
  }

  static Bytes question(std::uint8_t first) { return {4, 0, first, 0, 1}; }
  static Bytes answer_of(std::uint8_t value) { return {4, 2, 0, value}; }

  EventLoop loop_;
  KeptLog log_;
  Instant now_{1h};
  LineShareSettings settings_{
      .listen = SocketAddress{.host = loopback_ipv4, .port = 0},
      .allow = {this_machine},
      .rules = {.units = std::bitset<256>().set().reset(0).reset(9), .may_write = false},
      .wait_max = wait_max};
  LineShare share_{loop_, log_, "yard"};
};

TEST_F(SharedLine, HandsOverARequestAndItsAnswer) {
  const FileDescriptor client = connect();
  EXPECT_FALSE(share_.is_waiting());
  send_bytes(client.get(), frame_of(7, 3, question(5)));
  expect_next(3, question(5));
  share_.answer(answer_of(42));
  expect_bytes(client, frame_of(7, 3, answer_of(42)));
  EXPECT_EQ(share_.counters().answered, 1u);
}

TEST_F(SharedLine, RefusalsAreExceptionsOfTheProtocol) {
  const FileDescriptor client = connect();
  for (const ClientRefusal why :
       {ClientRefusal::no_answer, ClientRefusal::no_path, ClientRefusal::busy}) {
    send_bytes(client.get(), frame_of(8, 3, question(0)));
    expect_next(3, question(0));
    share_.refuse(why);
    expect_bytes(client, frame_of(8, 3, {0x84, static_cast<std::uint8_t>(why)}));
  }
  EXPECT_EQ(share_.counters().no_answer, 1u);
  EXPECT_EQ(share_.counters().no_path, 1u);
  EXPECT_EQ(share_.counters().busy, 1u);
}

TEST_F(SharedLine, WhatMayNotBeSentIsAnsweredAtOnce) {
  const FileDescriptor client = connect();
  send_bytes(client.get(), frame_of(1, 3, {6, 0, 1, 0, 7}));
  expect_bytes(client, frame_of(1, 3, {0x86, 1}));
  send_bytes(client.get(), frame_of(2, 9, question(0)));
  expect_bytes(client, frame_of(2, 9, {0x84, 0x0a}));
  send_bytes(client.get(), frame_of(3, 0, {16, 0, 0, 0, 1, 2, 0, 1}));
  expect_bytes(client, frame_of(3, 0, {0x90, 0x0a}));
  EXPECT_FALSE(share_.is_waiting());
  share_.advance(now_);
  EXPECT_EQ(share_.counters().service.rejected, 3u);
}

TEST_F(SharedLine, AWriteIsSentWhereItMayBeAndTheLogSaysWhose) {
  settings_.rules.may_write = true;
  share_.update(settings_);
  const FileDescriptor client = connect();
  for (int turn = 0; turn < 3; ++turn) {
    send_bytes(client.get(), frame_of(1, 3, {6, 0, 1, 0, 7}));
    expect_next(3, {6, 0, 1, 0, 7});
    share_.answer(Bytes{6, 0, 1, 0, 7});
    expect_bytes(client, frame_of(1, 3, {6, 0, 1, 0, 7}));
  }
  EXPECT_EQ(log_.lines.size(), 1u);
  EXPECT_NE(log_.lines[0].find("a client at 127.0.0.1 writes to unit 3"), std::string::npos);
}

TEST_F(SharedLine, ClientsHaveTurnsAndEachItsOldestRequest) {
  const FileDescriptor first = connect();
  const FileDescriptor second = connect();
  Bytes pipelined;
  for (std::uint8_t i = 1; i <= 4; ++i) {
    const Bytes frame = frame_of(i, 3, question(i));
    pipelined.insert(pipelined.end(), frame.begin(), frame.end());
  }
  send_bytes(first.get(), pipelined);
  send_bytes(second.get(), frame_of(1, 4, question(9)));
  turn_for_requests(5);
  // Whoever comes first, the other comes next.
  std::vector<int> units;
  ClientRequest request;
  Bytes order;
  while (share_.next(request)) {
    units.push_back(request.address);
    if (request.address == 3) order.push_back(request.pdu[2]);
    share_.answer(answer_of(request.pdu[2]));
  }
  ASSERT_EQ(units.size(), 5u);
  EXPECT_TRUE(units[0] == 4 || units[1] == 4);
  EXPECT_EQ(order, (Bytes{1, 2, 3, 4}));
}

TEST_F(SharedLine, OneTooManyOfAClientIsBusyAndOthersAreNot) {
  const FileDescriptor flood = connect();
  const FileDescriptor other = connect();
  Bytes pipelined;
  for (std::uint8_t i = 0; i < 100; ++i) {
    const Bytes frame = frame_of(i, 3, question(i));
    pipelined.insert(pipelined.end(), frame.begin(), frame.end());
  }
  send_bytes(flood.get(), pipelined);
  send_bytes(other.get(), frame_of(1, 4, question(9)));
  turn_for_requests(101);
  EXPECT_EQ(share_.counters().busy, 100u - TcpListener::replies_max);
  int of_other = 0;
  ClientRequest request;
  while (share_.next(request)) {
    of_other += request.address == 4;
    share_.answer(answer_of(1));
  }
  EXPECT_EQ(of_other, 1);
}

TEST_F(SharedLine, WhatHasWaitedTooLongIsBusy) {
  const FileDescriptor client = connect();
  send_bytes(client.get(), frame_of(7, 3, question(5)));
  turn_for_requests(1);
  EXPECT_EQ(share_.next_deadline(), now_ + wait_max);
  now_ += wait_max - 1us;
  share_.advance(now_);
  EXPECT_TRUE(share_.is_waiting());
  now_ += 1us;
  share_.advance(now_);
  EXPECT_FALSE(share_.is_waiting());
  expect_bytes(client, frame_of(7, 3, {0x84, 6}));
}

TEST_F(SharedLine, WhatIsUnderWayIsNotCutShort) {
  const FileDescriptor client = connect();
  send_bytes(client.get(), frame_of(7, 3, question(5)));
  expect_next(3, question(5));
  now_ += 10 * wait_max;
  share_.advance(now_);
  EXPECT_EQ(share_.counters().busy, 0u);
  share_.answer(answer_of(1));
  expect_bytes(client, frame_of(7, 3, answer_of(1)));
}

TEST_F(SharedLine, AnAnswerNeverGoesToTheNextWhoHasThatPlace) {
  FileDescriptor client = connect();
  send_bytes(client.get(), frame_of(7, 3, question(5)));
  expect_next(3, question(5));
  send_bytes(client.get(), frame_of(8, 3, question(6)));
  turn_for_requests(2);
  client.close();
  EXPECT_TRUE(turn_until(loop_, [&] {
    share_.advance(now_);
    return share_.counters().service.clients == 0;
  }));
  const FileDescriptor next = connect();
  send_bytes(next.get(), frame_of(9, 3, question(1)));
  turn_for_requests(3);
  share_.answer(answer_of(5));
  expect_next(3, question(1));
  share_.answer(answer_of(1));
  expect_bytes(next, frame_of(9, 3, answer_of(1)));
}

TEST_F(SharedLine, WhoNeverReadsHoldsUpNobodyAndIsNotReadFrom) {
  const FileDescriptor silent = connect();
  const int small = 4096;
  ::setsockopt(silent.get(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
  const FileDescriptor other = connect();
  // It asks for as long as it is read from: until both buffers of its connection are full.
  const Bytes frame = frame_of(1, 9, question(0));
  std::size_t taken = 0;
  for (int idle = 0; idle < 20;) {
    const ssize_t sent =
        ::send(silent.get(), frame.data(), frame.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent > 0) taken += static_cast<std::size_t>(sent);
    idle = sent > 0 || loop_.wait(1ms) ? 0 : idle + 1;
  }
  EXPECT_GT(taken, 0u);
  send_bytes(other.get(), frame_of(7, 3, question(5)));
  expect_next(3, question(5));
  share_.answer(answer_of(2));
  expect_bytes(other, frame_of(7, 3, answer_of(2)));
}

TEST_F(SharedLine, NoMutationOfAStreamHoldsUpAnybody) {
  std::mt19937 chance(3);
  const FileDescriptor good = connect();
  for (int round = 0; round < 300; ++round) {
    const FileDescriptor hostile = connect();
    Bytes bytes;
    for (std::uint8_t i = 0; i < 6; ++i) {
      const Bytes frame = frame_of(i, static_cast<std::uint8_t>(chance()), question(i));
      bytes.insert(bytes.end(), frame.begin(), frame.end());
    }
    mutate(bytes, chance() % 8, chance);
    bytes.resize(chance() % bytes.size() + 1);
    send_bytes(hostile.get(), bytes);
    const auto number = static_cast<std::uint16_t>(round);
    send_bytes(good.get(), frame_of(number, 200, question(7)));
    // All that comes is answered; that of the good client is its own.
    Bytes answered;
    const Bytes expected = frame_of(number, 200, answer_of(7));
    ASSERT_TRUE(turn_until(loop_, [&] {
      share_.advance(now_);
      for (ClientRequest request; share_.next(request);) {
        share_.answer(answer_of(request.pdu.size() > 2 ? request.pdu[2] : std::uint8_t{0}));
      }
      receive_available(good.get(), answered);
      return answered.size() >= expected.size();
    }));
    ASSERT_EQ(answered, expected);
  }
}

TEST_F(SharedLine, WhoMayNotConnectIsRejectedAndTheLogSaysHow) {
  settings_.allow = {*parse_network("10.0.0.0/8")};
  share_.update(settings_);
  const FileDescriptor client = connect_tcp(share_.acceptor()->address());
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(client.get()); }));
  EXPECT_NE(log_.lines.at(0).find("bus yard: a client at 127.0.0.1 is rejected: its network is not "
                                  "in share_allow"),
            std::string::npos);
}

TEST_F(SharedLine, AnotherAddressHangsUpAndNoneEndsIt) {
  const FileDescriptor client = connect();
  send_bytes(client.get(), frame_of(7, 3, question(5)));
  expect_next(3, question(5));
  settings_.listen.reset();
  share_.update(settings_);
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(client.get()); }));
  share_.answer(answer_of(1));
  EXPECT_FALSE(share_.is_shared());
  EXPECT_FALSE(share_.is_waiting());
  EXPECT_EQ(share_.next_deadline(), never);
  settings_.listen = SocketAddress{.host = loopback_ipv4, .port = 0};
  share_.update(settings_);
  const FileDescriptor again = connect();
  EXPECT_EQ(share_.counters().service.requests, 1u) << "what was counted before stays";
}

}  // namespace
}  // namespace etcm::port
