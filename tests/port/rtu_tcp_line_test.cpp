// RTU frames over TCP, against a real socket, with time in the test's hand.
#include "modbus/rtu_tcp_line.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "modbus/rtu_bus.h"
#include "peer.h"
#include "posix/tcp_socket.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

Bytes framed(std::uint8_t address, const Bytes& pdu) {
  Bytes bytes(rtu_frame_bytes_max);
  std::copy(pdu.begin(), pdu.end(), bytes.begin() + rtu_unit_bytes);
  bytes.resize(wrap_rtu(bytes, address, pdu.size()));
  return bytes;
}

class RtuOverTcp : public testing::Test {
 protected:
  RtuOverTcp() : listener_(listen_tcp({0x7f000001, 0})), address_(bound_address(listener_.get())) {}

  void open() {
    line_.emplace(loop_, endpoint_of(address_));
    bus_ = std::make_unique<RtuBus>(*line_, log_,
                                    RtuBusOptions{.name = "yard",
                                                  .serial_line = {},
                                                  .address = to_string(address_),
                                                  .quiet = 20ms,
                                                  .reopen_interval = 100ms});
  }
  void connect() {
    if (!bus_) open();
    EXPECT_TRUE(turn_until(loop_, [&] {
      bus_->advance(now_);
      if (!peer_.is_open()) peer_ = accept_tcp(listener_.get());
      return peer_.is_open() && bus_->ready();
    }));
  }
  // What arrives at the other end for a read of two registers of this unit.
  void request(std::uint8_t address) {
    bus_->start_read({.address = address, .first = 0, .count = 2, .timeout = 50ms}, now_);
    const Bytes expected = framed(address, {4, 0, 0, 0, 2});
    Bytes bytes;
    EXPECT_TRUE(turn_until(loop_, [&] {
      receive_available(peer_.get(), bytes);
      return bytes.size() >= expected.size();
    }));
    EXPECT_EQ(bytes, expected);
  }
  std::optional<BusResult> result() {
    BusAnswer answer;
    bus_->advance(now_);
    if (!bus_->take_answer(answer)) return std::nullopt;
    value_ = answer.registers.empty() ? -1 : answer.registers[0];
    return answer.result;
  }
  std::ptrdiff_t count_of(const std::string& part) const {
    return std::count_if(log_.lines.begin(), log_.lines.end(), [&](const std::string& line) {
      return line.find(part) != std::string::npos;
    });
  }
  BusResult wait_for_result() {
    std::optional<BusResult> found;
    EXPECT_TRUE(turn_until(loop_, [&] { return (found = result()).has_value(); }));
    return found.value_or(BusResult::bad_answer);
  }

  EventLoop loop_;
  KeptLog log_;
  FileDescriptor listener_;
  SocketAddress address_;
  FileDescriptor peer_;
  std::optional<RtuTcpLine> line_;
  std::unique_ptr<RtuBus> bus_;
  Instant now_{1h};
  int value_ = -1;
};

TEST_F(RtuOverTcp, ReadsRegisters) {
  connect();
  request(7);
  send_bytes(peer_.get(), framed(7, {4, 4, 0, 42, 0, 43}));
  EXPECT_EQ(wait_for_result(), BusResult::ok);
  EXPECT_EQ(value_, 42);
  EXPECT_EQ(count_of("bus yard: opened " + to_string(address_)), 1);
}

TEST_F(RtuOverTcp, AnAnswerMayComeInPieces) {
  connect();
  request(7);
  const Bytes answer = framed(7, {4, 4, 0, 42, 0, 43});
  for (std::size_t i = 0; i + 1 < answer.size(); ++i) {
    send_bytes(peer_.get(), {answer[i]});
    loop_.wait(1ms);
    EXPECT_EQ(result(), std::nullopt);
  }
  send_bytes(peer_.get(), {answer.back()});
  EXPECT_EQ(wait_for_result(), BusResult::ok);
}

TEST_F(RtuOverTcp, WhatIsOfAnotherUnitOrGarbledIsNotBelieved) {
  connect();
  request(7);
  send_bytes(peer_.get(), framed(8, {4, 4, 0, 1, 0, 1}));
  Bytes garbled = framed(7, {4, 4, 0, 2, 0, 2});
  garbled[4] ^= 1;
  send_bytes(peer_.get(), garbled);
  EXPECT_TRUE(turn_until(loop_, [&] {
    EXPECT_EQ(result(), std::nullopt);
    return line_->has_heard();
  }));
  now_ += 51ms;
  EXPECT_EQ(wait_for_result(), BusResult::bad_answer);
}

TEST_F(RtuOverTcp, ALateAnswerNeverBecomesTheNextUnits) {
  connect();
  request(7);
  now_ += 51ms;
  EXPECT_EQ(wait_for_result(), BusResult::timeout);
  now_ += 1s;
  connect();
  send_bytes(peer_.get(), framed(7, {4, 4, 0, 1, 0, 1}));
  EXPECT_TRUE(turn_until(loop_, [&] { return line_->has_heard(); }));
  connect();
  request(8);
  send_bytes(peer_.get(), framed(8, {4, 4, 0, 9, 0, 9}));
  EXPECT_EQ(wait_for_result(), BusResult::ok);
  EXPECT_EQ(value_, 9);
}

TEST_F(RtuOverTcp, AConnectionThatIsClosedIsMadeAgain) {
  connect();
  request(7);
  peer_.close();
  EXPECT_EQ(wait_for_result(), BusResult::link_lost);
  EXPECT_EQ(count_of("connection closed by the other side; trying again"), 1);
  now_ += 100ms;
  connect();
  request(8);
  send_bytes(peer_.get(), framed(8, {4, 4, 0, 5, 0, 5}));
  EXPECT_EQ(wait_for_result(), BusResult::ok);
}

TEST_F(RtuOverTcp, AConnectionThatTakesTooLongIsGivenUp) {
  open();
  bus_->advance(now_);
  ASSERT_NE(bus_->next_deadline(), never);
  // Nobody has looked meanwhile whether it was made.
  now_ = bus_->next_deadline();
  bus_->advance(now_);
  now_ = bus_->next_deadline();
  bus_->advance(now_);
  EXPECT_EQ(count_of("trying again"), 1) << testing::PrintToString(log_.lines);
}

TEST_F(RtuOverTcp, AConnectionThatIsBeingMadeIsGivenUpByClosing) {
  line_.emplace(loop_, endpoint_of(address_));
  std::string why;
  ASSERT_TRUE(line_->open(now_, why));
  ASSERT_NE(line_->next_deadline(), never);
  line_->close();
  EXPECT_EQ(line_->next_deadline(), never);
  for (int turns = 0; turns < 3; ++turns) loop_.wait(1ms);
  EXPECT_FALSE(line_->is_ready());
}

TEST_F(RtuOverTcp, AServerThatIsNotThereIsTriedAgainAndSaidOnce) {
  listener_.close();
  open();
  for (int attempt = 0; attempt < 3; ++attempt) {
    EXPECT_TRUE(turn_until(loop_, [&] {
      bus_->advance(now_);
      EXPECT_FALSE(bus_->ready());
      return bus_->next_deadline() == now_ + 100ms && count_of("trying again") > 0;
    }));
    now_ += 100ms;
  }
  EXPECT_EQ(count_of("trying again"), 1);
  listener_ = listen_tcp(address_);
  connect();
}

}  // namespace
}  // namespace etcm::port
