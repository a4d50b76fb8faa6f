// The server with several clients, some of them rude, and libmodbus as an independent one.
#include "modbus/register_server.h"

#include <gtest/gtest.h>
#include <modbus/modbus.h>

#include <atomic>
#include <memory>
#include <thread>

#include "mutation.h"
#include "no_descriptors.h"
#include "peer.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

std::shared_ptr<const RegisterImage> image_of(std::uint16_t value) {
  return std::make_shared<const RegisterImage>(RegisterImage{
      .registers_per_unit = 600, .registers = std::vector<std::uint16_t>(900, value)});
}

class Server : public testing::Test {
 protected:
  FileDescriptor connect() {
    FileDescriptor client = connect_tcp(server_.address());
    EXPECT_TRUE(client.is_open());
    // Accepted once it is answered; nothing else tells a client so.
    EXPECT_EQ(ask(client, 1, 0), 1);
    return client;
  }

  Bytes exchange(const FileDescriptor& client, const Bytes& request, std::size_t size) {
    pollfd writable{.fd = client.get(), .events = POLLOUT, .revents = 0};
    ::poll(&writable, 1, 1000);
    send_bytes(client.get(), request);
    Bytes answer;
    EXPECT_TRUE(turn_until(loop_, [&] {
      receive_available(client.get(), answer);
      return answer.size() >= size;
    }));
    return answer;
  }

  // The value of one register; the exception code as a negative number.
  int ask(const FileDescriptor& client, std::uint8_t unit, std::uint16_t first) {
    const Bytes answer = exchange(client, read_request(9, unit, first, 1), 9);
    if (answer[7] == 0x84) return -answer[8];
    return answer[9] << 8 | answer[10];
  }

  static constexpr Instant start{1h};

  EventLoop loop_;
  RegisterServer server_{
      loop_, {.host = 0x7f000001, .port = 0}, 3, {{"Maker", "mesh server", "1.2"}}, image_of(1)};
};

TEST_F(Server, UnitsAreStretchesOfOneImage) {
  const FileDescriptor client = connect();
  EXPECT_EQ(ask(client, 1, 599), 1);
  EXPECT_EQ(ask(client, 1, 600), -2);
  EXPECT_EQ(ask(client, 2, 299), 1);
  EXPECT_EQ(ask(client, 2, 300), -2);
  EXPECT_EQ(ask(client, 3, 0), -2);
  EXPECT_EQ(ask(client, 0, 0), 1) << "the device itself";
  EXPECT_EQ(ask(client, 255, 0), 1) << "the device itself";
}

TEST_F(Server, AClientSeesOneImageUntilItReadsTheHeaderAgain) {
  const FileDescriptor first = connect();
  const FileDescriptor second = connect();
  server_.publish(image_of(2));
  EXPECT_EQ(ask(first, 1, 5), 1);
  EXPECT_EQ(ask(first, 2, 0), 1) << "register 0 of another unit is no header";
  EXPECT_EQ(ask(second, 1, 0), 2);
  EXPECT_EQ(ask(second, 1, 5), 2);
  EXPECT_EQ(ask(first, 1, 5), 1);
  EXPECT_EQ(ask(first, 1, 0), 2);
  EXPECT_EQ(ask(first, 1, 5), 2);
}

// Of 8 bytes each, which is less than a request for registers has.
TEST(ServerOfLongTexts, HasRoomForNoMoreAnswersThanItHas) {
  EventLoop loop;
  const std::string text(240, 'x');
  RegisterServer server(loop, {.host = 0x7f000001, .port = 0}, 1, {{text, text, text}},
                        image_of(1));
  const FileDescriptor client = connect_tcp(server.address());
  Bytes requests;
  for (std::uint8_t i = 0; i < 130; ++i) {
    const Bytes request = frame_of(i, 1, {report_server_id});
    requests.insert(requests.end(), request.begin(), request.end());
  }
  send_bytes(client.get(), requests);
  Bytes answers;
  EXPECT_TRUE(turn_until(loop, [&] {
    receive_available(client.get(), answers);
    std::uint8_t next = 0;
    const ssize_t count = ::recv(client.get(), &next, 1, MSG_PEEK | MSG_DONTWAIT);
    return count == 0 || (count < 0 && errno == ECONNRESET);
  }));
  EXPECT_EQ(server.counters().clients, 0u);
}

TEST_F(Server, AClientThatNeverReadsTheHeaderSeesTheNewestImage) {
  const FileDescriptor client = connect_tcp(server_.address());
  for (std::uint16_t value = 1; value < 10; ++value) {
    server_.publish(image_of(value));
    EXPECT_EQ(ask(client, 1, 10), value);
    EXPECT_EQ(ask(client, 2, 7), value);
  }
}

// A master that has looked at the header once, and then polls one register for ever.
TEST_F(Server, AnImageIsNotKeptForWhoReadsTheSameAgainAndAgain) {
  const FileDescriptor client = connect();
  server_.publish(image_of(2));
  for (const std::uint16_t first : {std::uint16_t{10}, std::uint16_t{500}}) {
    EXPECT_EQ(ask(client, 1, 0), 2);
    EXPECT_EQ(ask(client, 1, first), 2);
    server_.publish(image_of(3));
    server_.advance(start);
    for (Duration passed = 0s; passed < RegisterServer::keep_max; passed += 500ms) {
      server_.advance(start + passed);
      EXPECT_EQ(ask(client, 1, first), 2) << passed.count();
    }
    EXPECT_EQ(server_.next_deadline(), start + RegisterServer::keep_max);
    server_.advance(start + RegisterServer::keep_max);
    EXPECT_EQ(ask(client, 1, first), 3);
    server_.publish(image_of(4));
    EXPECT_EQ(ask(client, 1, first), 4);
    server_.publish(image_of(2));
  }
  EXPECT_EQ(server_.next_deadline(), never);
}

TEST_F(Server, AnImageIsKeptForWhoReadsOnHoweverLongItTakes) {
  const FileDescriptor client = connect();
  server_.publish(image_of(2));
  Instant now = start;
  for (std::uint16_t first = 1; first < 600; first += 50) {
    now += RegisterServer::keep_max - 1ms;
    EXPECT_EQ(ask(client, 1, first), 1);
    server_.advance(now);
  }
  for (std::uint16_t first = 0; first < 300; first += 50) {
    now += RegisterServer::keep_max - 1ms;
    EXPECT_EQ(ask(client, 2, first), 1);
    server_.advance(now);
  }
  EXPECT_EQ(ask(client, 1, 0), 2);
}

TEST_F(Server, NothingCanBeWritten) {
  const FileDescriptor client = connect();
  for (const int number : {5, 6, 15, 16, 22, 23, 43, 99}) {
    const auto function = static_cast<std::uint8_t>(number);
    const Bytes answer = exchange(client, frame_of(3, 1, {function, 0, 0, 0, 1}), 9);
    EXPECT_EQ(answer, frame_of(3, 1, {static_cast<std::uint8_t>(function | 0x80), 1}));
  }
}

TEST_F(Server, TellsWhoItIs) {
  const FileDescriptor client = connect();
  Bytes pdu(pdu_bytes_max);
  pdu.resize(write_identification_request(pdu, 0));
  const Bytes answer = exchange(client, frame_of(3, 1, pdu), 7 + 7 + 3 * 2 + 5 + 11 + 3);
  Identity identity;
  EXPECT_EQ(parse_identification_answer(std::span(answer).subspan(mbap_header_bytes), identity), 3);
  EXPECT_EQ(identity.product(), "mesh server");
}

TEST_F(Server, UnknownFunctionsHoldUpNobody) {
  const FileDescriptor rude = connect();
  const FileDescriptor polite = connect();
  for (int function = 0; function < 256; ++function) {
    send_bytes(rude.get(), frame_of(3, 1, {static_cast<std::uint8_t>(function), 1, 2, 3}));
    EXPECT_EQ(ask(polite, 1, 0), 1);
  }
}

TEST_F(Server, StrayBytesAndDrippedRequestsHoldUpNobody) {
  const FileDescriptor rude = connect();
  const FileDescriptor polite = connect();
  send_bytes(rude.get(), {0, 1, 0});
  EXPECT_EQ(ask(polite, 1, 0), 1);
  const Bytes request = read_request(1, 1, 0, 1);
  for (std::size_t i = 3; i < request.size(); ++i) {
    send_bytes(rude.get(), {request[i]});
    EXPECT_EQ(ask(polite, 1, 0), 1);
  }
  Bytes answer;
  EXPECT_TRUE(turn_until(loop_, [&] {
    receive_available(rude.get(), answer);
    return answer.size() == 11;
  }));
}

TEST_F(Server, NoMutationOfAStreamHoldsUpAnybody) {
  const FileDescriptor polite = connect();
  std::mt19937 chance(3);
  for (int round = 0; round < 300; ++round) {
    const FileDescriptor rude = connect();
    Bytes stream = request_stream(1 + chance() % 10, chance);
    mutate(stream, chance() % 5, chance);
    send_bytes(rude.get(), stream);
    ASSERT_EQ(ask(polite, 1, 0), 1) << "round " << round;
  }
}

TEST_F(Server, WhatIsNoModbusIsHungUpOn) {
  const FileDescriptor rude = connect();
  send_bytes(rude.get(), Bytes(20, 'x'));
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(rude.get()); }));
  EXPECT_EQ(ask(connect(), 1, 0), 1);
}

TEST_F(Server, AClientThatNeverReadsHoldsUpNobodyAndGetsAllItsAnswersInTheEnd) {
  const FileDescriptor greedy = connect();
  // A little room is filled soon.
  const int room = 4096;
  ::setsockopt(greedy.get(), SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
  ::setsockopt(greedy.get(), SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
  const FileDescriptor polite = connect();
  const Bytes request = read_request(1, 1, 0, 125);
  std::size_t requests = 0;
  std::size_t begun = 0;  // bytes of the next request that the connection has taken already
  const auto send_on = [&] {
    const ssize_t sent = ::send(greedy.get(), request.data() + begun, request.size() - begun,
                                MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent <= 0) return false;
    begun += static_cast<std::size_t>(sent);
    if (begun == request.size()) {
      ++requests;
      begun = 0;
    }
    return true;
  };
  std::size_t received = 0;
  for (int round = 0; round < 20; ++round) {
    // Until its requests pile up at both ends: then no more are taken.
    for (int rejected = 0; rejected < 20;) {
      rejected = send_on() ? 0 : rejected + 1;
      loop_.wait(Duration{});
      ASSERT_LT(requests, 5'000'000u) << "the server takes requests without end";
    }
    EXPECT_EQ(ask(polite, 1, 0), 1);
    ASSERT_TRUE(turn_until(loop_,
                           [&] {
                             if (begun != 0) send_on();
                             Bytes answer;
                             receive_available(greedy.get(), answer);
                             received += answer.size();
                             return begun == 0 && received == requests * 259;
                           }))
        << received << " of " << requests * 259;
  }
}

TEST_F(Server, OneClientTooManyIsTurnedAway) {
  const FileDescriptor a = connect();
  const FileDescriptor b = connect();
  FileDescriptor c = connect();
  const FileDescriptor d = connect_tcp(server_.address());
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(d.get()); }));
  EXPECT_EQ(ask(a, 1, 0), 1);
  c.close();
  for (int turn = 0; turn < 5; ++turn) loop_.wait(std::chrono::milliseconds(2));
  const FileDescriptor e = connect();
  EXPECT_EQ(ask(e, 1, 0), 1);
}

// A master that reconnects without hanging up, and half-open connections, fill all places.
TEST_F(Server, AFullHouseMakesRoomForANewClient) {
  KeptLog log;
  server_.allow({everybody}, log);
  server_.advance(start);
  const FileDescriptor a = connect();
  const FileDescriptor b = connect();
  const FileDescriptor c = connect();
  server_.advance(start + 1s);
  EXPECT_EQ(ask(a, 1, 0), 1);
  server_.advance(start + 2s);
  EXPECT_EQ(ask(c, 1, 0), 1);
  server_.advance(start + 3s);
  send_bytes(b.get(), {0, 1, 0});  // no request
  server_.advance(start + 1s + TcpListener::idle_max + 1ns);
  const FileDescriptor d = connect();
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(b.get()); })) << "idle for longest";
  EXPECT_EQ(ask(a, 1, 0), 1);
  EXPECT_EQ(ask(c, 1, 0), 1);
  ASSERT_EQ(log.lines.size(), 1u);
  EXPECT_NE(log.lines[0].find("127.0.0.1 is hung up on"), std::string::npos) << log.lines[0];
}

TEST_F(Server, AFullHouseOfActiveClientsIsKept) {
  server_.advance(start);
  const FileDescriptor a = connect();
  const FileDescriptor b = connect();
  const FileDescriptor c = connect();
  for (const FileDescriptor* client : {&a, &b, &c}) {
    server_.advance(start + TcpListener::idle_max);
    EXPECT_EQ(ask(*client, 1, 0), 1);
  }
  // The last has asked, and no time has passed since.
  server_.advance(start + 2 * TcpListener::idle_max);
  const FileDescriptor d = connect_tcp(server_.address());
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(d.get()); }));
  for (const FileDescriptor* client : {&a, &b, &c}) EXPECT_EQ(ask(*client, 1, 0), 1);
}

TEST_F(Server, AStrangerTakesNobodysPlace) {
  KeptLog log;
  server_.advance(start);
  const FileDescriptor a = connect();
  const FileDescriptor b = connect();
  const FileDescriptor c = connect();
  server_.allow({{.host = 0x7f000001, .prefix = 32}}, log);
  server_.advance(start + 1h);
  const FileDescriptor stranger = connect_from(2, server_.address());
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(stranger.get()); }));
  EXPECT_EQ(ask(a, 1, 0), 1);
}

// Of eight places.
class RoomyServer : public Server {
 protected:
  RegisterServer roomy_{
      loop_, {.host = 0x7f000001, .port = 0}, 8, {{"Maker", "mesh server", "1.2"}}, image_of(1)};
  KeptLog log_;
};

TEST_F(RoomyServer, OneAddressDoesNotKeepAllOthersOut) {
  roomy_.allow({everybody}, log_);
  roomy_.advance(start);
  std::vector<FileDescriptor> many;
  for (int i = 0; i < 50; ++i) many.push_back(connect_from(1, roomy_.address()));
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(many.back().get()); }));
  EXPECT_EQ(roomy_.counters().clients, 6u);
  EXPECT_EQ(roomy_.counters().rejected, 44u);
  ASSERT_EQ(log_.lines.size(), 44u);
  EXPECT_EQ(log_.lines[0],
            "a client at 127.0.0.1 is rejected: it has 6 connections, as many as one address may "
            "have of clients_max in [server]; have it close those that it does not use, or raise "
            "that");
  for (const std::uint8_t host : {std::uint8_t{2}, std::uint8_t{3}}) {
    const FileDescriptor visitor = connect_from(host, roomy_.address());
    EXPECT_EQ(ask(visitor, 1, 0), 1) << "at once";
  }
}

TEST_F(RoomyServer, OneAddressMakesRoomAmongItsOwn) {
  roomy_.allow({everybody}, log_);
  roomy_.advance(start);
  const FileDescriptor visitor = connect_from(2, roomy_.address());
  EXPECT_EQ(ask(visitor, 1, 0), 1);
  std::vector<FileDescriptor> many;
  for (int i = 0; i < 6; ++i) {
    roomy_.advance(start + i * 1s);
    many.push_back(connect_from(1, roomy_.address()));
    EXPECT_EQ(ask(many.back(), 1, 0), 1);
  }
  // All have been idle for long, the visitor for longest, and there is a free place.
  roomy_.advance(start + 10s);
  roomy_.advance(start + 2 * TcpListener::idle_max);
  const FileDescriptor another = connect_from(1, roomy_.address());
  EXPECT_EQ(ask(another, 1, 0), 1);
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(many.front().get()); }));
  EXPECT_EQ(ask(visitor, 1, 0), 1);
}

TEST_F(Server, WithoutDescriptorsItNeitherSpinsNorStays) {
  KeptLog log;
  // A sanitizer that meets a type for the first time needs a pipe, for which nothing will be left.
  static_cast<Log&>(log).write(Level::info, "");
  log.lines.clear();
  server_.allow({everybody}, log);
  server_.advance(start);
  FileDescriptor early = connect();
  const FileDescriptor late = connect_tcp(server_.address());
  const FileDescriptor later = connect_tcp(server_.address());
  {
    const NoDescriptors none;
    ASSERT_TRUE(turn_until(loop_, [&] { return !log.lines.empty(); }));
    EXPECT_NE(log.lines[0].find("raise LimitNOFILE"), std::string::npos) << log.lines[0];
    Instant now = start;
    EXPECT_LE(turns_in(10s, loop_, server_, now), 50) << "once a second it looks";
    EXPECT_EQ(ask(early, 1, 0), 1) << "who is connected is served";
    EXPECT_EQ(log.lines.size(), 1u) << "said once";
    // A client that goes leaves a descriptor at either end.
    early.close();
    EXPECT_EQ(ask(late, 1, 0), 1);
  }
  server_.advance(start + 1h);
  EXPECT_EQ(ask(later, 1, 0), 1);
}

// One socket for both kinds of addresses, and lists of networks hold for either.
TEST_F(Server, AtEveryAddressClientsOfIpv4AndOfIpv6AreServedAsTheyAreAllowed) {
  KeptLog log;
  RegisterServer both(loop_, {.host = any_ipv6, .port = 0}, 4, {{"a", "b", "c"}}, image_of(1));
  both.allow({this_machine}, log);
  const std::uint16_t port = both.address().port;
  const FileDescriptor ipv4 = connect_tcp({.host = loopback_ipv4, .port = port});
  EXPECT_EQ(ask(ipv4, 1, 0), 1);
  const FileDescriptor ipv6 = connect_tcp({.host = loopback_ipv6, .port = port});
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(ipv6.get()); }));
  ASSERT_EQ(log.lines.size(), 1u);
  EXPECT_TRUE(log.lines[0].starts_with("a client at ::1 is rejected")) << log.lines[0];
  both.allow({{.host = loopback_ipv6, .prefix = 128}}, log);
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(ipv4.get()); }));
  const FileDescriptor again = connect_tcp({.host = loopback_ipv6, .port = port});
  EXPECT_EQ(ask(again, 1, 0), 1);
}

TEST_F(Server, OnlyWhoIsAllowedIsServed) {
  KeptLog log;
  const FileDescriptor early = connect();
  server_.allow({{.host = 0x0a000000, .prefix = 8}, this_machine}, log);
  EXPECT_EQ(ask(early, 1, 0), 1);
  server_.allow({{.host = 0x0a000000, .prefix = 8}, {.host = 0x7f000002, .prefix = 32}}, log);
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(early.get()); })) << "no longer allowed";
  const FileDescriptor stranger = connect_tcp(server_.address());
  EXPECT_TRUE(turn_until(loop_, [&] { return is_closed(stranger.get()); }));
  ASSERT_EQ(log.lines.size(), 1u);
  EXPECT_EQ(log.lines[0],
            "a client at 127.0.0.1 is rejected: its network is not in allow of [server]; add it "
            "there if it may read the mesh");
  EXPECT_EQ(server_.counters().rejected, 1u);
  EXPECT_EQ(server_.counters().clients, 0u);
  server_.allow({everybody}, log);
  EXPECT_EQ(ask(connect(), 1, 0), 1);
}

TEST(Networks, AreReadAndCompared) {
  const auto network = parse_network("10.1.0.0/16");
  ASSERT_TRUE(network);
  EXPECT_TRUE(network->contains(0x0a01ffff));
  EXPECT_FALSE(network->contains(0x0a020000));
  EXPECT_EQ(to_string(*network), "10.1.0.0/16");
  EXPECT_TRUE(parse_network("192.168.1.7")->contains(0xc0a80107));
  EXPECT_FALSE(parse_network("192.168.1.7")->contains(0xc0a80106));
  EXPECT_TRUE(parse_network("0.0.0.0/0")->contains(0xffffffff));
  for (const char* text : {"", "/8", "10.0.0.0/", "10.0.0.0/33", "10.0.0.0/-1", "10.0.0/8",
                           "10.0.0.0/8 ", "10.0.0.0/256", "localhost", "::1/129"}) {
    EXPECT_FALSE(parse_network(text)) << text;
  }
}

TEST_F(Server, LibmodbusReadsIt) {
  std::atomic<bool> done = false;
  std::thread client([&] {
    modbus_t* master = modbus_new_tcp("127.0.0.1", server_.address().port);
    EXPECT_EQ(modbus_connect(master), 0) << modbus_strerror(errno);
    modbus_set_slave(master, 2);
    std::uint16_t registers[125] = {};
    EXPECT_EQ(modbus_read_input_registers(master, 100, 125, registers), 125);
    EXPECT_EQ(registers[124], 1);
    EXPECT_EQ(modbus_read_registers(master, 0, 1, registers), 1);
    std::uint8_t name[64] = {};
    EXPECT_EQ(modbus_report_slave_id(master, sizeof name, name), 2 + 15);
    EXPECT_EQ(std::string(name + 2, name + 17), "mesh server 1.2");
    EXPECT_EQ(modbus_write_register(master, 0, 1), -1);
    EXPECT_EQ(errno, EMBXILFUN);
    modbus_close(master);
    modbus_free(master);
    done = true;
  });
  EXPECT_TRUE(turn_until(loop_, [&] { return done.load(); }));
  client.join();
}

// libmodbus as a program that reads the header at its start, and polls what it needs.
TEST_F(Server, LibmodbusPollsTheNewest) {
  std::atomic<int> seen = 0;
  std::thread client([&] {
    modbus_t* master = modbus_new_tcp("127.0.0.1", server_.address().port);
    EXPECT_EQ(modbus_connect(master), 0) << modbus_strerror(errno);
    modbus_set_slave(master, 1);
    std::uint16_t registers[4] = {};
    EXPECT_EQ(modbus_read_input_registers(master, 0, 4, registers), 4);
    seen = registers[0];
    for (int i = 0; i < 100'000 && seen < 9; ++i) {
      if (modbus_read_input_registers(master, 10, 2, registers) != 2) break;
      EXPECT_EQ(registers[0], registers[1]);
      seen = registers[0];
    }
    modbus_close(master);
    modbus_free(master);
  });
  Instant now = start;
  EXPECT_TRUE(turn_until(loop_, [&] {
    server_.advance(now += 10ms);
    if (seen > 0) server_.publish(image_of(9));
    return seen == 9;
  }));
  client.join();
}

}  // namespace
}  // namespace etcm::port
