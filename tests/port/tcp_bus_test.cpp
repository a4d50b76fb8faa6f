// The bus against units that answer late, wrongly, or not at all. Time is the test's; the socket is
// real.
#include "modbus/tcp_bus.h"

#include <gtest/gtest.h>

#include "peer.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

class Bus : public testing::Test {
 protected:
  Bus() : listener_(listen_tcp({.host = 0x7f000001, .port = 0})) {}

  void make_bus() {
    bus_ =
        std::make_unique<TcpBus>(loop_, log_,
                                 TcpBusOptions{.name = "test",
                                               .end = endpoint_of(bound_address(listener_.get())),
                                               .outstanding_max = 2,
                                               .reconnect_interval = 100ms});
  }

  // The listener has room for one connection, and has it: further ones wait.
  void fill_queue() {
    ASSERT_EQ(::listen(listener_.get(), 0), 0);
    queued_ = connect_tcp(bound_address(listener_.get()));
    pollfd made{.fd = queued_.get(), .events = POLLOUT, .revents = 0};
    ASSERT_EQ(::poll(&made, 1, 20'000), 1);
  }

  void connect() {
    if (!bus_) make_bus();
    bus_->advance(now_);
    ASSERT_TRUE(turn_until(loop_, [&] {
      if (!peer_.is_open()) peer_ = accept_tcp(listener_.get());
      return bus_->ready() && peer_.is_open();
    }));
  }

  // The transaction number of the request that arrives next.
  std::uint16_t request(std::uint8_t unit, Duration at_most = 50ms) {
    bus_->start_read({.address = unit, .first = 0, .count = 2, .timeout = at_most}, now_);
    Bytes bytes;
    EXPECT_TRUE(turn_until(loop_, [&] {
      receive_available(peer_.get(), bytes);
      return bytes.size() >= 12;
    }));
    EXPECT_EQ(Bytes(bytes.begin() + 2, bytes.end()), (Bytes{0, 0, 0, 6, unit, 4, 0, 0, 0, 2}));
    return static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]);
  }

  // The transaction number of a write of 7 and 8 from register 258, which arrives whole.
  std::uint16_t write(std::uint8_t unit) {
    const std::array<std::uint16_t, 2> values{7, 8};
    bus_->start_write(
        {.address = unit, .first = 0x0102, .values = values, .timeout = 50ms, .ticket = 99}, now_);
    Bytes bytes;
    EXPECT_TRUE(turn_until(loop_, [&] {
      receive_available(peer_.get(), bytes);
      return bytes.size() >= 17;
    }));
    EXPECT_EQ(Bytes(bytes.begin() + 2, bytes.end()),
              (Bytes{0, 0, 0, 11, unit, 16, 1, 2, 0, 2, 4, 0, 7, 0, 8}));
    return static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]);
  }

  BusAnswer answer() {
    BusAnswer found;
    EXPECT_TRUE(turn_until(loop_, [&] { return bus_->take_answer(found); }));
    return found;
  }

  // Lets the loop take in what was sent; there must be no answer in it.
  void expect_no_answer() {
    BusAnswer found;
    for (int turn = 0; turn < 5; ++turn) loop_.wait(2ms);
    EXPECT_FALSE(bus_->take_answer(found));
  }

  // A request each second, until the bus takes none or it is time. None is cut short.
  void ask_in_vain_until(Instant end) {
    while (now_ < end && bus_->ready()) {
      request(7);
      now_ += 50ms;
      bus_->advance(now_);
      EXPECT_EQ(answer().result, BusResult::timeout);
      now_ += 950ms;
      bus_->advance(now_);
    }
  }

  // Whether the other side has thrown the connection away; before that came `rest`.
  static bool is_reset(int descriptor, Bytes& rest) {
    while (true) {
      pollfd readable{.fd = descriptor, .events = POLLIN, .revents = 0};
      if (::poll(&readable, 1, 20'000) != 1) return false;
      std::uint8_t chunk[4096];
      const ssize_t count = ::recv(descriptor, chunk, sizeof chunk, 0);
      if (count <= 0) return count < 0 && errno == ECONNRESET;
      rest.insert(rest.end(), chunk, chunk + count);
    }
  }

  void reply(std::uint16_t transaction, std::uint8_t unit, std::uint8_t value) {
    send_bytes(peer_.get(), frame_of(transaction, unit, {4, 4, 0, value, 0, value}));
  }

  EventLoop loop_;
  KeptLog log_;
  FileDescriptor listener_;
  FileDescriptor queued_;
  FileDescriptor peer_;
  Instant now_{1h};
  std::unique_ptr<TcpBus> bus_;
};

TEST_F(Bus, ReadsRegisters) {
  connect();
  reply(request(7), 7, 42);
  const BusAnswer found = answer();
  EXPECT_EQ(found.address, 7);
  EXPECT_EQ(found.result, BusResult::ok);
  ASSERT_EQ(found.registers.size(), 2u);
  EXPECT_EQ(found.registers[1], 42);
}

TEST_F(Bus, AsksForTheRegistersThatAreMeant) {
  connect();
  bus_->start_read(
      {.address = 7, .kind = RegisterKind::holding, .first = 0, .count = 2, .timeout = 50ms}, now_);
  Bytes bytes;
  EXPECT_TRUE(turn_until(loop_, [&] {
    receive_available(peer_.get(), bytes);
    return bytes.size() >= 12;
  }));
  EXPECT_EQ(Bytes(bytes.begin() + 6, bytes.end()), (Bytes{7, 3, 0, 0, 0, 2}));
  const auto transaction = static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]);
  send_bytes(peer_.get(), frame_of(transaction, 7, {3, 4, 0, 42, 0, 43}));
  const BusAnswer found = answer();
  EXPECT_EQ(found.result, BusResult::ok);
  ASSERT_EQ(found.registers.size(), 2u);
  EXPECT_EQ(found.registers[1], 43);
}

TEST_F(Bus, ALateAnswerNeverBecomesTheNextRequestsData) {
  connect();
  const std::uint16_t late = request(7);
  now_ += 50ms;
  bus_->advance(now_);
  EXPECT_EQ(answer().result, BusResult::timeout);
  const std::uint16_t next = request(7);
  reply(late, 7, 1);
  expect_no_answer();
  reply(next, 7, 2);
  EXPECT_EQ(answer().registers[0], 2);
}

TEST_F(Bus, ALateAnswerIsNotTakenForAnotherUnits) {
  connect();
  const std::uint16_t late = request(7);
  now_ += 50ms;
  bus_->advance(now_);
  EXPECT_EQ(answer().result, BusResult::timeout);
  const std::uint16_t next = request(8);
  reply(late, 7, 1);
  reply(next, 8, 2);
  const BusAnswer found = answer();
  EXPECT_EQ(found.address, 8);
  EXPECT_EQ(found.registers[0], 2);
}

TEST_F(Bus, HalfAnAnswerThatCameTooLateDoesNotSpoilTheNext) {
  connect();
  const std::uint16_t late = request(7);
  Bytes half = frame_of(late, 7, {4, 4, 0, 1, 0, 1});
  half.resize(9);
  send_bytes(peer_.get(), half);
  expect_no_answer();
  now_ += 50ms;
  bus_->advance(now_);
  EXPECT_EQ(answer().result, BusResult::timeout);
  reply(request(7), 7, 2);
  EXPECT_EQ(answer().registers[0], 2);
}

TEST_F(Bus, AnswersMayComeInAnyOrder) {
  connect();
  const std::uint16_t first = request(7);
  const std::uint16_t second = request(8);
  EXPECT_FALSE(bus_->ready()) << "as many as it may have under way";
  reply(second, 8, 2);
  EXPECT_EQ(answer().address, 8);
  EXPECT_TRUE(bus_->ready());
  reply(first, 7, 1);
  EXPECT_EQ(answer().address, 7);
}

TEST_F(Bus, TheWrongUnitIsABadAnswer) {
  connect();
  reply(request(7), 8, 1);
  const BusAnswer found = answer();
  EXPECT_EQ(found.address, 7);
  EXPECT_EQ(found.result, BusResult::bad_answer);
}

TEST_F(Bus, TheWrongLengthOrFunctionIsABadAnswer) {
  connect();
  for (const Bytes& pdu : {Bytes{4, 2, 0, 1}, Bytes{3, 4, 0, 1, 0, 1}, Bytes{4, 6, 0, 1, 0, 1}}) {
    send_bytes(peer_.get(), frame_of(request(7), 7, pdu));
    EXPECT_EQ(answer().result, BusResult::bad_answer);
  }
}

TEST_F(Bus, AnExceptionComesWithItsCode) {
  connect();
  send_bytes(peer_.get(), frame_of(request(7), 7, {0x84, 11}));
  const BusAnswer found = answer();
  EXPECT_EQ(found.result, BusResult::exception);
  EXPECT_EQ(found.exception, 11);
}

TEST_F(Bus, ALostLinkFailsWhatIsUnderWayAndComesBack) {
  connect();
  request(7);
  peer_.close();
  EXPECT_EQ(answer().result, BusResult::link_lost);
  EXPECT_FALSE(bus_->ready());
  now_ += 100ms;
  connect();
  reply(request(7), 7, 3);
  EXPECT_EQ(answer().registers[0], 3);
}

TEST_F(Bus, WhatIsNoModbusCostsTheConnection) {
  connect();
  request(7);
  send_bytes(peer_.get(), Bytes(64, 'x'));
  EXPECT_EQ(answer().result, BusResult::link_lost);
  EXPECT_EQ(log_.lines.back().find("no Modbus TCP") == std::string::npos, false);
}

TEST_F(Bus, ARefusedConnectionIsTriedAgainAndSaidOnce) {
  const SocketAddress address = bound_address(listener_.get());
  listener_.close();
  bus_ = std::make_unique<TcpBus>(loop_, log_,
                                  TcpBusOptions{.name = "test",
                                                .end = endpoint_of(address),
                                                .outstanding_max = 1,
                                                .reconnect_interval = 100ms});
  for (int attempt = 0; attempt < 3; ++attempt) {
    bus_->advance(now_);
    loop_.wait(5ms);
    EXPECT_FALSE(bus_->ready());
    now_ += 100ms;
  }
  EXPECT_EQ(log_.lines.size(), 1u);
  listener_ = listen_tcp(address);
  connect();
}

// Requests into the void, one each second, until the bus does not take them any more.
TEST_F(Bus, APeerThatFallsSilentIsConnectedAnew) {
  connect();
  reply(request(7), 7, 1);
  EXPECT_EQ(answer().result, BusResult::ok);
  const Instant asked_first = now_;
  ask_in_vain_until(asked_first + tcp_silence_max);
  EXPECT_EQ(now_, asked_first + tcp_silence_max);
  Bytes rest;
  EXPECT_TRUE(is_reset(peer_.get(), rest));
  EXPECT_TRUE(rest.empty());
  peer_.close();
  connect();
  EXPECT_EQ(log_.lines.size(), 2u) << "connected, silent";
  EXPECT_NE(log_.lines.back().find("nothing answers"), std::string::npos) << log_.lines.back();
  reply(request(7), 7, 3);
  EXPECT_EQ(answer().registers[0], 3);
  EXPECT_EQ(log_.lines.size(), 3u) << "connected";
}

TEST_F(Bus, UnitsThatNobodyHasHeardMakeNoSilentPeerBeforeTheyAreAskedAgain) {
  connect();
  for (std::uint8_t unit = 1; unit <= 8; ++unit) {
    request(unit);
    now_ += 1s;
    bus_->advance(now_);
    EXPECT_EQ(answer().result, BusResult::timeout);
    ASSERT_TRUE(bus_->ready()) << int{unit};
  }
  request(1);
  now_ += 50ms;
  bus_->advance(now_);
  EXPECT_EQ(answer().result, BusResult::timeout);
  EXPECT_FALSE(bus_->ready()) << "all had their turn";
}

TEST_F(Bus, WhatIsUnderWayHasItsTimeWhenThePeerIsSilent) {
  connect();
  reply(request(7), 7, 1);
  EXPECT_EQ(answer().result, BusResult::ok);
  const Instant asked_first = now_;
  request(7);
  now_ += 50ms;
  bus_->advance(now_);
  EXPECT_EQ(answer().result, BusResult::timeout);
  now_ = asked_first + tcp_silence_max - 10ms;
  bus_->advance(now_);
  const std::uint16_t last = request(8);
  now_ += 10ms;
  bus_->advance(now_);
  EXPECT_FALSE(bus_->ready());
  expect_no_answer();
  reply(last, 8, 5);
  EXPECT_EQ(answer().registers[0], 5);
  EXPECT_TRUE(bus_->ready()) << "it has spoken";
}

TEST_F(Bus, ASlowUnitIsNoSilentPeer) {
  connect();
  const std::uint16_t slow = request(7, 4s);
  now_ += tcp_silence_max - 2s;
  bus_->advance(now_);
  expect_no_answer();
  EXPECT_EQ(request(8, 50ms), slow + 1);
  now_ += 2s;
  bus_->advance(now_);
  EXPECT_EQ(answer().result, BusResult::timeout);
  expect_no_answer();  // the other may be behind it in a queue
  now_ += hold_at_first;
  bus_->advance(now_);
  now_ += 50ms;
  bus_->advance(now_);
  EXPECT_EQ(answer().result, BusResult::timeout);
  EXPECT_TRUE(bus_->ready()) << "three of its timeouts are not over";
}

// A converter with nobody alive behind it.
TEST_F(Bus, APeerThatStaysSilentIsConnectedEverMoreRarelyAndSaidOnce) {
  connect();
  int connections = 0;
  for (const Instant end = now_ + 10min; now_ < end; ++connections) {
    ask_in_vain_until(end);
    if (bus_->ready()) break;
    peer_.close();
    connect();
  }
  EXPECT_GE(connections, 10);
  EXPECT_LE(connections, 15);
  EXPECT_EQ(log_.lines.size(), 2u);
}

TEST_F(Bus, ABacklogIsNotWorkedOff) {
  connect();
  while (bus_->ready()) {
    bus_->start_read({.address = 7, .first = 0, .count = 2, .timeout = 50ms}, now_);
    now_ += 50ms;
    bus_->advance(now_);
    EXPECT_EQ(answer().result, BusResult::timeout);
  }
  const FileDescriptor frozen = std::move(peer_);
  connect();
  Bytes bytes;
  EXPECT_TRUE(is_reset(frozen.get(), bytes)) << "what has not got through is thrown away";
  EXPECT_LE(bytes.size(), 12 * (tcp_silence_max / 50ms));
  reply(request(7), 7, 3);
  EXPECT_EQ(answer().registers[0], 3);
}

// The first packet of the connection is lost; the system sends it again after a second.
TEST_F(Bus, ASlowConnectionIsWaitedFor) {
  fill_queue();
  make_bus();
  const Instant begun = now_;
  for (; now_ < begun + TcpConnector::connect_time_max; now_ += 100ms) {
    bus_->advance(now_);
    loop_.wait(Duration{});
    EXPECT_LE(bus_->next_deadline(), begun + TcpConnector::connect_time_max);
    ASSERT_TRUE(log_.lines.empty()) << log_.lines.back();
  }
  now_ -= 100ms;
  EXPECT_TRUE(accept_tcp(listener_.get()).is_open());
  connect();
  EXPECT_EQ(log_.lines.size(), 1u) << "connected";
}

TEST_F(Bus, AConnectionThatNeverComesIsTriedAgain) {
  fill_queue();
  make_bus();
  bus_->advance(now_);
  now_ += TcpConnector::connect_time_max;
  EXPECT_EQ(bus_->next_deadline(), now_);
  bus_->advance(now_);
  ASSERT_EQ(log_.lines.size(), 1u);
  EXPECT_NE(log_.lines[0].find("no answer to the attempt"), std::string::npos) << log_.lines[0];
  EXPECT_TRUE(bus_->why_down().ends_with("and the network between")) << bus_->why_down();
  EXPECT_EQ(bus_->next_deadline(), now_ + TcpConnector::connect_time_max);
}

TEST_F(Bus, WritesRegisters) {
  connect();
  send_bytes(peer_.get(), frame_of(write(7), 7, {16, 1, 2, 0, 2}));
  const BusAnswer found = answer();
  EXPECT_EQ(found.address, 7);
  EXPECT_EQ(found.ticket, 99u);
  EXPECT_EQ(found.result, BusResult::ok);
  EXPECT_TRUE(found.registers.empty());
}

TEST_F(Bus, ALateAnswerToAWriteIsNeverTheNextOnes) {
  connect();
  const std::uint16_t late = write(7);
  now_ += 50ms;
  bus_->advance(now_);
  EXPECT_EQ(answer().result, BusResult::timeout);
  const std::uint16_t next = write(7);
  send_bytes(peer_.get(), frame_of(late, 7, {16, 1, 2, 0, 2}));
  expect_no_answer();
  send_bytes(peer_.get(), frame_of(next, 7, {0x90, 4}));
  const BusAnswer found = answer();
  EXPECT_EQ(found.result, BusResult::exception);
  EXPECT_EQ(found.exception, 4);
}

TEST_F(Bus, AWriteAndAReadOfOneUnitKeepTheirAnswersApart) {
  connect();
  const std::uint16_t written = write(7);
  const std::uint16_t read = request(7);
  reply(read, 7, 42);
  BusAnswer found = answer();
  EXPECT_EQ(found.ticket, 0u);
  EXPECT_EQ(found.registers[0], 42);
  send_bytes(peer_.get(), frame_of(written, 7, {16, 1, 2, 0, 2}));
  found = answer();
  EXPECT_EQ(found.ticket, 99u);
  EXPECT_EQ(found.result, BusResult::ok);
}

TEST_F(Bus, AnAnswerToAnotherWriteIsABadAnswer) {
  connect();
  for (const Bytes& pdu : {Bytes{16, 1, 2, 0, 1}, Bytes{16, 1, 3, 0, 2}, Bytes{16, 1, 2, 0, 2, 0},
                           Bytes{6, 1, 2, 0, 2}, Bytes{4, 4, 0, 1, 0, 1}}) {
    send_bytes(peer_.get(), frame_of(write(7), 7, pdu));
    EXPECT_EQ(answer().result, BusResult::bad_answer);
  }
  send_bytes(peer_.get(), frame_of(write(7), 8, {16, 1, 2, 0, 2}));
  EXPECT_EQ(answer().result, BusResult::bad_answer);
  write(7);
  peer_.close();
  EXPECT_EQ(answer().result, BusResult::link_lost);
}

// A converter may answer on the new connection what was asked on the old one.
TEST_F(Bus, AnAnswerToTheRunBeforeIsNobodys) {
  connect();
  const std::uint16_t before = request(7);
  bus_.reset();
  peer_.close();
  now_ += 1s;
  connect();
  const std::uint16_t after = request(7);
  EXPECT_NE(before, after);
  reply(before, 7, 1);
  expect_no_answer();
  reply(after, 7, 2);
  EXPECT_EQ(answer().registers[0], 2);
}

// ---- Requests of those who share the bus.

TEST_F(Bus, ARequestOfAClientHasItsAnswerAsItCame) {
  connect();
  const std::pair<Bytes, Bytes> rows[] = {
      {{1, 0, 0, 0, 9}, {1, 2, 0x55, 1}}, {{6, 0, 1, 0, 7}, {6, 0, 1, 0, 7}},
      {{17}, {17, 3, 'E', 0xff, '!'}},    {{4, 0, 0, 0, 2}, {0x84, 2}},
      {{4, 0, 0, 0, 2}, {4, 2, 0, 1}},  // of another length: garbled
  };
  for (const auto& row : rows) {
    const Bytes &pdu = row.first, &answered = row.second;
    EXPECT_TRUE(bus_->is_up());
    bus_->start_request({.address = 7, .pdu = pdu, .timeout = 50ms, .ticket = 5}, now_);
    Bytes bytes;
    ASSERT_TRUE(turn_until(loop_, [&] {
      receive_available(peer_.get(), bytes);
      return bytes.size() >= 7 + pdu.size();
    }));
    const auto transaction = static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]);
    EXPECT_EQ(bytes, frame_of(transaction, 7, pdu));
    send_bytes(peer_.get(), frame_of(transaction, 7, answered));
    const BusAnswer found = answer();
    EXPECT_EQ(found.ticket, 5u);
    if (pdu[0] == 4 && answered[0] == 4) {
      EXPECT_EQ(found.result, BusResult::bad_answer);
      EXPECT_TRUE(found.pdu.empty());
      continue;
    }
    EXPECT_EQ(Bytes(found.pdu.begin(), found.pdu.end()), answered);
    EXPECT_EQ(found.result, (answered[0] & 0x80) != 0 ? BusResult::exception : BusResult::ok);
  }
}

TEST_F(Bus, ALateAnswerToAClientIsNobodys) {
  connect();
  const Bytes pdu{4, 0, 0, 0, 2};
  bus_->start_request({.address = 7, .pdu = pdu, .timeout = 50ms, .ticket = 5}, now_);
  Bytes bytes;
  ASSERT_TRUE(turn_until(loop_, [&] {
    receive_available(peer_.get(), bytes);
    return bytes.size() >= 12;
  }));
  now_ += 50ms;
  bus_->advance(now_);
  EXPECT_EQ(answer().result, BusResult::timeout);
  const std::uint16_t next = request(7);
  reply(static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]), 7, 1);
  expect_no_answer();
  reply(next, 7, 2);
  const BusAnswer found = answer();
  EXPECT_EQ(found.result, BusResult::ok);
  EXPECT_EQ(found.registers[0], 2);
}

// Is there as soon as it is wanted.
class MadeConnection : public FrameConnection {
 public:
  State state() const override { return state_; }
  void connect(const Endpoint&, Instant, Duration) override {
    state_ = State::up;
    listener().on_connected();
  }
  void advance(Instant) override {}
  Instant next_deadline() const override { return never; }
  void discard() override {}
  void close() override { state_ = State::down; }
  void abort() override { close(); }

 private:
  State state_ = State::down;
};

// Answers at once, but to one unit never.
class ReadyConnection final : public MadeConnection {
 public:
  static constexpr std::uint8_t dead = 9;
  void send(std::span<std::uint8_t>, std::uint16_t transaction, std::uint8_t address,
            std::size_t) override {
    constexpr std::array<std::uint8_t, 6> two_registers{4, 4, 0, 1, 0, 2};
    if (address == dead) return;
    listener().on_frame({.transaction = transaction, .address = address, .pdu = two_registers});
  }
};

// Is found to be lost when it is asked what has come.
class LostConnection final : public MadeConnection {
 public:
  void send(std::span<std::uint8_t>, std::uint16_t, std::uint8_t, std::size_t) override {
    ADD_FAILURE() << "it is down";
  }
  void discard() override {
    close();
    listener().on_lost("Connection reset by peer");
  }
};

TEST(TcpBusLoss, FoundBeforeAQuestionTellsWhyItWas) {
  LostConnection connection;
  KeptLog log;
  TcpBus bus(connection, log,
             {.name = "test", .end = {}, .outstanding_max = 1, .reconnect_interval = 1s});
  const Instant now{1h};
  bus.advance(now);
  ASSERT_TRUE(bus.ready());
  bus.start_read({.address = 4, .first = 0, .count = 2, .timeout = 50ms}, now);
  BusAnswer answer;
  ASSERT_TRUE(bus.take_answer(answer));
  EXPECT_EQ(answer.result, BusResult::link_lost);
  EXPECT_TRUE(bus.why_down().ends_with(": Connection reset by peer")) << bus.why_down();
}

TEST(TcpBusNumbers, OfRequestsThatNobodyAnsweredAreNotUsedAgain) {
  ReadyConnection connection;
  KeptLog log;
  TcpBus bus(connection, log,
             {.name = "test", .end = {}, .outstanding_max = 1, .reconnect_interval = 1s});
  Instant now{1h};
  const auto ask = [&](std::uint8_t unit) {
    bus.start_read({.address = unit, .first = 0, .count = 2, .timeout = 50ms}, now);
    BusAnswer answer;
    answer.result = BusResult::link_lost;
    for (int turn = 0; turn < 100 && !bus.take_answer(answer); ++turn) bus.advance(now += 10ms);
    do {
      bus.advance(now += 10ms);
    } while (!bus.ready());
    return answer.result;
  };
  bus.advance(now);
  ASSERT_EQ(ask(1), BusResult::ok);
  ASSERT_EQ(ask(ReadyConnection::dead), BusResult::timeout);
  for (int request = 0; request < 0x10000; ++request) {
    ASSERT_EQ(ask(1), BusResult::ok) << request;
  }
}

}  // namespace
}  // namespace etcm::port
