// A client of MQTT over real sockets, with a broker in the test's hand. How it gets on with a real
// one, and with TLS, is in tests/system.
#include "mqtt/mqtt_broker.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <map>
#include <set>

#include "fake_broker.h"
#include "mutation.h"
#include "no_descriptors.h"
#include "support/allocation_watch.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

class MqttBrokerTest : public testing::Test, public BrokerListener {
 protected:
  explicit MqttBrokerTest(const char* spare_id = "") : spare_id_(spare_id) {
    broker_.set_listener(this);
  }

  MqttBrokerOptions options() const {
    return {.end = {.host = "127.0.0.1", .port = fake_.port()},
            .client_id = "north",
            .spare_client_id = spare_id_,
            .user = "someone",
            .password = "secret",
            .keep_alive = 60s,
            .tls = {}};
  }

  void on_connected(Instant) override { ++connected_; }
  void on_disconnected(std::string_view reason, Instant) override { lost_.emplace_back(reason); }
  void on_message(const BrokerMessage& message, Instant) override {
    messages_.push_back((message.retained ? "!" : "") + std::string(message.topic) + "=" +
                        std::string(message.payload));
  }
  void on_delivered(std::uint32_t token, Instant) override { delivered_.push_back(token); }
  void on_refused(std::uint32_t token, std::string_view reason, Instant) override {
    refused_[token] = reason;
  }

  testing::AssertionResult step_until(const std::function<bool()>& condition) {
    return turn_until(loop_, [&] {
      broker_.step(now_);
      return condition();
    });
  }
  // The next packet of this kind; others are passed over.
  ClientPacket next(std::uint8_t kind) {
    ClientPacket packet;
    EXPECT_TRUE(step_until([&] { return fake_.take(packet) && packet.kind() == kind; }))
        << "kind " << int{kind};
    return packet;
  }
  void connect(const Bytes& connack = mqtt::connack()) {
    next(0x10);
    fake_.send(connack);
    const int before = connected_;
    EXPECT_TRUE(step_until([&] { return connected_ > before; }));
  }
  // Ends the session by these bytes, and returns why it ended.
  std::string end_by(const Bytes& bytes) {
    const std::size_t before = lost_.size();
    fake_.send(bytes);
    EXPECT_TRUE(step_until([&] { return lost_.size() > before; }));
    fake_.hang_up();
    return lost_.back();
  }
  void pass_pause() { now_ += 2 * ReconnectPause::longest; }

  const char* const spare_id_;
  EventLoop loop_;
  KeptLog log_;
  FakeBroker fake_;
  Instant now_{1h};
  MqttBroker broker_{loop_, log_, options()};
  int connected_ = 0;
  std::vector<std::string> lost_;
  std::vector<std::string> messages_;
  std::vector<std::uint32_t> delivered_;
  std::map<std::uint32_t, std::string> refused_;
};

TEST_F(MqttBrokerTest, GreetsWithNameUserAndLastWill) {
  broker_.set_last_will({.topic = "a/will", .payload = "gone", .retained = true});
  const ClientPacket greeting = next(0x10);
  EXPECT_EQ(greeting.text(0), "MQTT");
  EXPECT_EQ(greeting.body.at(6), 5) << "version";
  // User, password, retained will with QoS 1, clean start.
  EXPECT_EQ(greeting.body.at(7), 0xc0 | 0x20 | 0x08 | 0x04 | 0x02);
  EXPECT_EQ(greeting.u16(8), 60) << "keep alive";
  std::size_t at = 11u + greeting.body.at(10);
  for (const char* text : {"north", "", "a/will", "gone", "someone", "secret"}) {
    if (*text == '\0') {
      EXPECT_EQ(greeting.body.at(at++), 0) << "properties of the will";
      continue;
    }
    EXPECT_EQ(greeting.text(at), text);
    at += 2 + std::string_view(text).size();
  }
  EXPECT_EQ(at, greeting.body.size());
  EXPECT_FALSE(broker_.is_connected());
  fake_.send(mqtt::connack());
  EXPECT_TRUE(step_until([&] { return broker_.is_connected(); }));
  EXPECT_EQ(connected_, 1);
  EXPECT_EQ(broker_.why_down(), "");
  EXPECT_NE(log_.lines.at(0).find(": connected as north"), std::string::npos) << log_.lines[0];
}

TEST_F(MqttBrokerTest, WhatIsPublishedIsDeliveredOrRefused) {
  EXPECT_FALSE(broker_.publish({.topic = "a", .payload = "b"}, 1)) << "not connected";
  connect();
  EXPECT_TRUE(broker_.publish({.topic = "a/b", .payload = "one", .retained = true}, 7));
  EXPECT_TRUE(broker_.publish({.topic = "a/c", .payload = {}}, 8));
  const ClientPacket first = next(0x30);
  EXPECT_EQ(first.head, 0x33) << "QoS 1, retained";
  EXPECT_EQ(first.topic(), "a/b");
  EXPECT_EQ(first.payload(), "one");
  const ClientPacket second = next(0x30);
  EXPECT_EQ(second.head, 0x32);
  EXPECT_EQ(second.payload(), "");
  fake_.send(mqtt::puback(second.number(), 0x87));
  fake_.send(mqtt::puback(first.number(), 0x10));  // nobody has subscribed: that is no failure
  EXPECT_TRUE(step_until([&] { return !delivered_.empty() && !refused_.empty(); }));
  EXPECT_EQ(delivered_, std::vector<std::uint32_t>{7});
  EXPECT_NE(refused_[8].find("message for a/c is refused: its access list does not allow that to "
                             "user 'someone'; allow it there"),
            std::string::npos)
      << refused_[8];
  EXPECT_EQ(log_.lines.back(), refused_[8]);
  EXPECT_EQ(broker_.counters().delivered, 1u);
  EXPECT_EQ(broker_.counters().refused, 1u);
}

TEST_F(MqttBrokerTest, WhatIsSentAtMostOnceIsDeliveredAsItLeaves) {
  connect();
  EXPECT_TRUE(broker_.publish({.topic = "a", .payload = "b", .at_most_once = true}, 5));
  EXPECT_TRUE(delivered_.empty()) << "not before a step";
  EXPECT_EQ(broker_.next_deadline(), Instant{});
  const ClientPacket packet = next(0x30);
  EXPECT_EQ(packet.head, 0x30) << "QoS 0";
  EXPECT_EQ(delivered_, std::vector<std::uint32_t>{5});
  // Where nobody reads there is an end to them.
  const std::string longest(broker_message_bytes_max - 1, 'x');
  std::size_t sent = 0;
  for (int turn = 0; turn < 1000; ++turn) {
    while (broker_.publish({.topic = "a", .payload = longest, .at_most_once = true}, 6)) ++sent;
    broker_.step(now_);
  }
  EXPECT_LT(sent, 100u);
}

TEST_F(MqttBrokerTest, NoMoreIsUnderWayThanFits) {
  connect();
  for (std::uint32_t i = 0; i < MqttBroker::messages_max; ++i) {
    EXPECT_TRUE(broker_.publish({.topic = "a", .payload = "b"}, i));
  }
  EXPECT_FALSE(broker_.publish({.topic = "a", .payload = "b"}, 99));
  const ClientPacket first = next(0x30);
  fake_.send(mqtt::puback(first.number()));
  EXPECT_TRUE(step_until([&] { return delivered_.size() == 1; }));
  EXPECT_TRUE(broker_.publish({.topic = "a", .payload = "b"}, 99));
  end_by(mqtt::disconnect(0x8b));
  EXPECT_EQ(delivered_.size(), 1u);

  // Long ones: fewer of them.
  pass_pause();
  connect();
  const std::string longest(broker_message_bytes_max - 1, 'x');
  EXPECT_TRUE(broker_.publish({.topic = "a", .payload = longest}, 1));
  EXPECT_TRUE(broker_.publish({.topic = "b", .payload = longest}, 2));
  EXPECT_FALSE(broker_.publish({.topic = "c", .payload = "d"}, 3));
  EXPECT_EQ(broker_.counters().held_bytes_most, broker_held_bytes_max);
  EXPECT_EQ(next(0x30).payload(), longest);
  EXPECT_EQ(next(0x30).topic(), "b");
}

TEST_F(MqttBrokerTest, AMessageThatIsTooLongForTheBrokerIsRefused) {
  connect(mqtt::connack(0, {0x27, 0, 0, 0, 100}));  // maximum packet size
  EXPECT_TRUE(broker_.publish({.topic = "a", .payload = std::string(200, 'x')}, 1));
  EXPECT_EQ(broker_.next_deadline(), Instant{});
  broker_.step(now_);
  ASSERT_EQ(refused_.size(), 1u);
  EXPECT_NE(refused_[1].find("raise its maximum packet size"), std::string::npos) << refused_[1];
  EXPECT_TRUE(broker_.publish({.topic = "a", .payload = "x"}, 3));
  EXPECT_EQ(next(0x30).payload(), "x");
}

TEST_F(MqttBrokerTest, ABrokerThatCannotKeepOrDeliverIsNone) {
  struct Row {
    Bytes properties;
    const char* words;
  };
  for (const Row& row : {Row{{0x25, 0}, "it keeps no messages; allow retained messages there"},
                         Row{{0x24, 0}, "it delivers no message for certain; allow QoS 1 there"}}) {
    next(0x10);
    fake_.send(mqtt::connack(0, row.properties));
    EXPECT_TRUE(step_until([&] {
      return broker_.why_down().find(row.words) != std::string_view::npos;
    })) << broker_.why_down();
    fake_.hang_up();
    pass_pause();
  }
  EXPECT_EQ(connected_, 0);
}

TEST_F(MqttBrokerTest, SubscribesAnewInEachSession) {
  const std::vector<std::string> filters{"a/+/b", "c/#"};
  broker_.subscribe(filters);
  connect();
  for (const std::string& filter : filters) {
    const ClientPacket request = next(0x80);
    EXPECT_EQ(request.filter(), filter);
    fake_.send(mqtt::suback(request.number()));
  }
  fake_.send(mqtt::publish(1, "a/x/b", "kept", true));
  fake_.send(mqtt::publish(2, "c", ""));
  EXPECT_TRUE(step_until([&] { return messages_.size() == 2; }));
  EXPECT_EQ(messages_, (std::vector<std::string>{"!a/x/b=kept", "c="}));
  EXPECT_EQ(next(0x40).number(), 1) << "confirmed";

  broker_.subscribe(std::vector<std::string>{"d", "c/#"});
  const ClientPacket later = next(0x80);
  EXPECT_EQ(later.filter(), "d");
  fake_.send(mqtt::suback(later.number(), 0x87));
  EXPECT_TRUE(step_until([&] { return log_.lines.size() == 2; }));
  EXPECT_NE(log_.lines[1].find("it gives no messages of d: its access list"), std::string::npos)
      << log_.lines[1];

  end_by(mqtt::disconnect(0x8b));
  pass_pause();
  connect();
  std::set<std::string> again;
  for (int i = 0; i < 3; ++i) again.insert(next(0x80).filter());
  EXPECT_EQ(again, (std::set<std::string>{"a/+/b", "c/#", "d"}));
}

TEST_F(MqttBrokerTest, TheLongestMessageArrivesInPieces) {
  connect();
  const std::string payload(broker_message_bytes_max - 1, 'y');
  const Bytes packet = mqtt::publish(9, "a", payload);
  std::size_t sent = 0;
  EXPECT_TRUE(step_until([&] {
    sent += fake_.send_some(std::span(packet).subspan(sent));
    return !messages_.empty();
  }));
  EXPECT_EQ(messages_.at(0), "a=" + payload);
}

TEST_F(MqttBrokerTest, ABrokerThatReadsNothingHoldsUpNobody) {
  connect();
  const std::string longest(broker_message_bytes_max - 1, 'x');
  while (broker_.publish({.topic = "a", .payload = longest}, 1)) broker_.step(now_);
  // The loop has nothing to do but what is asked for each second.
  int turns = 0;
  while (loop_.wait(Duration{0}) && turns < 1000) {
    broker_.step(now_);
    ++turns;
  }
  EXPECT_LT(turns, 1000) << "it spins";
  broker_.step(now_);
  EXPECT_GT(broker_.next_deadline(), now_);
}

std::size_t bytes_in_use() {
  const struct mallinfo2 info = ::mallinfo2();
  return info.uordblks + info.hblkhd;
}

class NobodyListens final : public MosquittoClient::Listener {
 public:
  void on_greeted(int) override {}
  void on_packet(const BrokerMessage&) override { ++packets; }
  void on_published(int, int) override {}
  void on_subscribed(int, int) override {}
  void on_farewell(int) override {}
  std::size_t packets = 0;
};

// Each message wants an answer, and the answers are never taken. Over a pair of sockets, for they
// hold little.
TEST(MqttConnectionTest, WhoFloodsAndReadsNothingIsNotReadFrom) {
  int pair[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, pair), 0);
  const int little = 4096;
  for (const int end : pair) {
    ASSERT_EQ(::setsockopt(end, SOL_SOCKET, SO_SNDBUF, &little, sizeof little), 0);
  }
  const FileDescriptor peer(pair[1]);
  EventLoop loop;
  NobodyListens listener;
  MqttGreeting greeting;
  greeting.client_id = "north";
  MqttConnection connection(loop, FileDescriptor(pair[0]), nullptr, "", greeting, listener);
  Bytes flood;
  for (std::uint16_t i = 1; i <= 2000; ++i) {
    const Bytes message = mqtt::publish(i, "a", "b");
    flood.insert(flood.end(), message.begin(), message.end());
  }
  send_bytes(peer.get(), mqtt::connack());
  const Instant now{1h};
  std::size_t sent = 0;
  const auto send_more = [&] {
    const auto rest = std::span(flood).subspan(sent % flood.size());
    const ssize_t count = ::send(peer.get(), rest.data(), rest.size(), MSG_DONTWAIT);
    if (count > 0) sent += static_cast<std::size_t>(count);
    connection.step(now);
  };
  for (int turn = 0; turn < 100; ++turn) send_more();
  EXPECT_LT(listener.packets, 10'000u);
  EXPECT_GT(listener.packets, 500u);
  ASSERT_FALSE(connection.is_over()) << connection.why_over();
  // Once they are taken, it goes on.
  const std::size_t before = listener.packets;
  Bytes answers;
  for (int turn = 0; turn < 1000 && listener.packets < 2 * before; ++turn) {
    receive_available(peer.get(), answers);
    send_more();
  }
  EXPECT_GE(listener.packets, 2 * before);
}

// As much under way as may be, nothing of it taken, as many answers as may wait behind it, and the
// longest message that may come.
TEST(MqttConnectionTest, HoldsNoMoreOfTheHeapThanIsPromised) {
  int pair[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, pair), 0);
  const FileDescriptor peer(pair[1]);
  EventLoop loop;
  NobodyListens listener;
  MqttGreeting greeting;
  greeting.client_id = "north";
  const std::string longest(broker_message_bytes_max - 1, 'x');
  constexpr std::uint16_t answers = 999;
  Bytes stream = mqtt::connack();
  for (std::uint16_t i = 1; i <= answers; ++i) {
    const Bytes message = mqtt::publish(i, "a", "b");
    stream.insert(stream.end(), message.begin(), message.end());
  }
  const Bytes last = mqtt::publish(answers + 1, "a", longest);
  stream.insert(stream.end(), last.begin(), last.end());
  const std::size_t before = bytes_in_use();
  MqttConnection connection(loop, FileDescriptor(pair[0]), nullptr, "", greeting, listener);
  const Instant now{1h};
  std::size_t sent = 0;
  std::size_t most = 0;
  std::uint32_t under_way = 0;
  for (int turn = 0; turn < 10'000 && listener.packets <= answers; ++turn) {
    if (turn > 10 && under_way < broker_held_bytes_max / broker_message_bytes_max) {
      int packet = 0;
      ASSERT_EQ(connection.client().publish({.topic = "a", .payload = longest}, packet),
                MosquittoClient::Sent::yes);
      ++under_way;
    }
    const auto rest = std::span(stream).subspan(sent);
    const std::size_t now_sent = turn < 20 ? std::min<std::size_t>(rest.size(), 1) : rest.size();
    const ssize_t count = ::send(peer.get(), rest.data(), now_sent, MSG_DONTWAIT);
    if (count > 0) sent += static_cast<std::size_t>(count);
    connection.step(now);
    most = std::max(most, bytes_in_use() - before);
  }
  ASSERT_FALSE(connection.is_over()) << connection.why_over();
  EXPECT_EQ(listener.packets, std::size_t{answers} + 1);
  EXPECT_EQ(under_way, 2u);
  EXPECT_LE(most, MqttBroker::heap_bytes_max);
}

TEST_F(MqttBrokerTest, WithoutDescriptorsItTriesAgain) {
  if (needs_descriptors_itself) GTEST_SKIP() << "the sanitizer needs descriptors";
  {
    const NoDescriptors none;
    broker_.step(now_);
    broker_.step(now_);
    EXPECT_NE(broker_.why_down().find("Too many open files"), std::string_view::npos)
        << broker_.why_down();
  }
  pass_pause();
  connect();
}

TEST_F(MqttBrokerTest, ABrokerThatSaysNothingIsGivenUp) {
  next(0x10);
  EXPECT_LE(broker_.next_deadline(), now_ + MqttBroker::greeting_time_max);
  now_ += MqttBroker::greeting_time_max;
  broker_.step(now_);
  EXPECT_NE(broker_.why_down().find("connected, but it does not answer; give the port"),
            std::string_view::npos)
      << broker_.why_down();
  EXPECT_TRUE(lost_.empty()) << "it was never connected";
}

// Most brokers take the name in a certificate, or of a key, for the user.
TEST(MqttReason, WhoShowsACertificateIsNotWithoutAUser) {
  constexpr int not_authorized = 0x87;
  const MqttNames shown{.client_id = "yard:north", .user = {}, .tls_name = "north"};
  EXPECT_EQ(explain_denial(not_authorized, shown),
            "its access list does not allow that to the certificate or key of 'north'; allow it "
            "there, or correct site, name or user");
  EXPECT_EQ(explain_refusal(not_authorized, shown),
            "it does not let in the certificate or key of 'north'; let that name be the user there "
            "(Mosquitto: use_identity_as_username true), or give user and password_file");
  const MqttNames both{.client_id = "yard:north", .user = "pump", .tls_name = "north"};
  EXPECT_EQ(explain_farewell(not_authorized, both),
            "it has thrown out user 'pump' with the certificate or key of 'north'; look at its "
            "access list");
  EXPECT_EQ(explain_refusal(not_authorized, {.client_id = "yard:north", .user = {}}),
            "it does not let in a client without a user; give user and password_file");
}

TEST_F(MqttBrokerTest, WhoIsRefusedIsToldWhy) {
  struct Row {
    std::uint8_t reason;
    const char* words;
  };
  for (const Row& row : {Row{0x86, "it does not let in user 'someone'; correct user or"},
                         Row{0x87, "it does not let in user 'someone'; correct user or"},
                         Row{0x85, "it refuses the client id 'north'"},
                         Row{0x84, "it does not know MQTT 5"}, Row{0x88, "its log may say why"}}) {
    next(0x10);
    fake_.send(mqtt::connack(row.reason));
    EXPECT_TRUE(step_until([&] {
      return broker_.why_down().find(row.words) != std::string_view::npos;
    })) << broker_.why_down();
    EXPECT_EQ(log_.lines.back(), std::string(broker_.why_down()) + "; trying again");
    fake_.hang_up();
    pass_pause();
  }
  EXPECT_EQ(connected_, 0);
}

TEST_F(MqttBrokerTest, ABrokerOfMqtt3IsToldOfSo) {
  next(0x10);
  fake_.send({0x20, 2, 0, 1});
  EXPECT_TRUE(step_until([&] {
    return broker_.why_down().find("it does not know MQTT 5") != std::string_view::npos;
  })) << broker_.why_down();
}

TEST_F(MqttBrokerTest, ALineIsWrittenOncePerReason) {
  for (int i = 0; i < 3; ++i) {
    next(0x10);
    fake_.hang_up();
    const auto before = broker_.counters().failures;
    EXPECT_TRUE(step_until([&] { return broker_.counters().failures > before; }));
    pass_pause();
  }
  ASSERT_EQ(log_.lines.size(), 1u);
  EXPECT_NE(log_.lines[0].find("before it answered; give the port of a broker for MQTT"),
            std::string::npos)
      << log_.lines[0];
}

TEST_F(MqttBrokerTest, WhoseNameIsTakenComesBackMuchLater) {
  connect();
  EXPECT_NE(end_by(mqtt::disconnect(0x8e))
                .find("another client has come as 'north', and took its place; give each gateway "
                      "a name of its own"),
            std::string::npos);
  EXPECT_GE(broker_.next_deadline(), now_ + ReconnectPause::longest);
}

// Mosquitto 2.0.11 tells nobody that its name is taken.
TEST_F(MqttBrokerTest, WhoIsCutOffAgainAndAgainIsToldWhatMayBe) {
  for (const bool is_told : {false, true, true}) {
    connect();
    const std::size_t before = lost_.size();
    fake_.hang_up();
    EXPECT_TRUE(step_until([&] { return lost_.size() > before; }));
    EXPECT_EQ(lost_.back().find("; another client may have come as 'north': give each gateway a "
                                "name of its own") != std::string::npos,
              is_told)
        << lost_.back();
    pass_pause();
  }
  connect();
  now_ += MqttBroker::good_session;
  fake_.hang_up();
  EXPECT_TRUE(step_until([&] { return lost_.size() == 4; }));
  pass_pause();
  connect();
  fake_.hang_up();
  EXPECT_TRUE(step_until([&] { return lost_.size() == 5; }));
  EXPECT_EQ(lost_.back().find("another client"), std::string::npos) << lost_.back();
}

// Where more has come by then, Mosquitto 2.0.11 hangs up after a refusal before that has left.
TEST_F(MqttBrokerTest, AfterACutOneMessageGoesAtATimeSoThatARefusalIsHeard) {
  connect();
  EXPECT_TRUE(broker_.publish({.topic = "a", .payload = "b"}, 1));
  EXPECT_TRUE(broker_.publish({.topic = "c", .payload = "d"}, 2));
  next(0x30);
  fake_.hang_up();
  EXPECT_TRUE(step_until([&] { return lost_.size() == 1; }));
  pass_pause();
  connect();
  EXPECT_TRUE(broker_.publish({.topic = "a", .payload = "b"}, 3));
  EXPECT_FALSE(broker_.publish({.topic = "c", .payload = "d"}, 4));
  fake_.send(mqtt::puback(next(0x30).number(), 0x87));
  EXPECT_TRUE(step_until([&] { return refused_.contains(3); }));
  EXPECT_TRUE(broker_.publish({.topic = "c", .payload = "d"}, 5));
  next(0x30);
  fake_.hang_up();
  EXPECT_TRUE(step_until([&] { return lost_.size() == 2; }));
  EXPECT_NE(lost_.back().find("after it has refused a message"), std::string::npos) << lost_.back();
}

class SpareId : public MqttBrokerTest {
 protected:
  SpareId() : MqttBrokerTest("north:spare") {}

  // Connects, and returns the id that the broker was told.
  std::string connect_as(const Bytes& connack = mqtt::connack()) {
    const ClientPacket greeting = next(0x10);
    fake_.send(connack);
    return greeting.text(11u + greeting.body.at(10));
  }
  std::string connect_well() {
    const int before = connected_;
    std::string id = connect_as();
    EXPECT_TRUE(step_until([&] { return connected_ > before; }));
    return id;
  }
  void hang_up() {
    const std::size_t before = lost_.size();
    fake_.hang_up();
    EXPECT_TRUE(step_until([&] { return lost_.size() > before; }));
  }
};

TEST_F(SpareId, WhoseNameIsTakenGoesOnByItAtOnce) {
  EXPECT_EQ(connect_well(), "north");
  EXPECT_NE(end_by(mqtt::disconnect(0x8e)).find("another client has come as 'north'"),
            std::string::npos);
  EXPECT_LE(broker_.next_deadline(), now_ + 2 * ReconnectPause::first);
  pass_pause();
  EXPECT_EQ(connect_well(), "north:spare");
  // Whatever ends a session from now on.
  end_by(mqtt::disconnect(0x8b));
  pass_pause();
  EXPECT_EQ(connect_well(), "north:spare");
  // Where the broker gives both clients one name, whatever they say, it gives way.
  end_by(mqtt::disconnect(0x8e));
  EXPECT_GE(broker_.next_deadline(), now_ + ReconnectPause::longest);
}

TEST_F(SpareId, WhoIsCutOffAgainAndAgainGoesOnByIt) {
  EXPECT_EQ(connect_well(), "north");
  hang_up();
  pass_pause();
  EXPECT_EQ(connect_well(), "north") << "once is nothing";
  now_ += MqttBroker::good_session;
  hang_up();
  EXPECT_EQ(lost_.back().find("another client"), std::string::npos) << lost_.back();
  for (int i = 0; i < 2; ++i) {
    pass_pause();
    EXPECT_EQ(connect_well(), "north");
    hang_up();
  }
  EXPECT_NE(lost_.back().find("another client may have come as 'north'"), std::string::npos);
  pass_pause();
  EXPECT_EQ(connect_well(), "north:spare");
}

TEST_F(SpareId, WhereItIsNotLetInTheFirstOneIsTakenAgain) {
  EXPECT_EQ(connect_well(), "north");
  end_by(mqtt::disconnect(0x8e));
  pass_pause();
  EXPECT_EQ(connect_as(mqtt::connack(0x85)), "north:spare");
  EXPECT_TRUE(step_until([&] {
    return broker_.why_down().find("it refuses the client id 'north:spare'") !=
           std::string_view::npos;
  })) << broker_.why_down();
  EXPECT_GE(broker_.next_deadline(), now_ + ReconnectPause::longest);
  fake_.hang_up();
  pass_pause();
  EXPECT_EQ(connect_well(), "north");
}

// Who sets up a broker sees the cure within seconds.
TEST_F(MqttBrokerTest, BeforeAConnectionHasLastedPausesStayShort) {
  constexpr Duration bound = ReconnectPause::longest_at_first * 3 / 2;
  for (int i = 0; i < 6; ++i) {
    next(0x10);
    const std::uint64_t failures = broker_.counters().failures;
    fake_.send(mqtt::connack(0x86));
    EXPECT_TRUE(step_until([&] { return broker_.counters().failures > failures; }));
    fake_.hang_up();
    EXPECT_LE(broker_.next_deadline(), now_ + bound) << i;
    pass_pause();
  }
  connect();
  // Nor does one that is cut off at once show that all is well.
  end_by(mqtt::disconnect(0x8b));
  EXPECT_LE(broker_.next_deadline(), now_ + bound);
}

TEST_F(MqttBrokerTest, PausesGrowToABoundAndDifferByName) {
  ReconnectPause north("north");
  ReconnectPause south("south");
  Duration last_at_first{};
  for (int i = 0; i < 10; ++i) {
    last_at_first = north.take();
    EXPECT_LE(last_at_first, ReconnectPause::longest_at_first * 3 / 2);
    EXPECT_NE(last_at_first, south.take());
  }
  EXPECT_GE(last_at_first, ReconnectPause::longest_at_first);
  north.lengthen();
  EXPECT_GE(north.take(), ReconnectPause::longest);
  EXPECT_GE(north.take(), ReconnectPause::longest) << "until a session stands";
  for (ReconnectPause* const pause : {&north, &south}) pause->note_lasting();
  Duration last{};
  for (int i = 0; i < 10; ++i) {
    const Duration pause = north.take();
    EXPECT_GE(pause, last);
    EXPECT_LE(pause, ReconnectPause::longest * 3 / 2);
    EXPECT_NE(pause, south.take());
    last = pause;
  }
  EXPECT_GE(last, ReconnectPause::longest);
  ReconnectPause again("north");
  north.shorten();
  EXPECT_EQ(north.take(), again.take()) << "the same name has the same pauses";

  // A session that lasted begins anew; one that did not is as good as none.
  connect();
  now_ += MqttBroker::good_session;
  end_by(mqtt::disconnect(0x8b));
  pass_pause();
  for (int i = 0; i < 8; ++i) {
    connect();
    end_by(mqtt::disconnect(0x8b));
    pass_pause();
  }
  connect();
  end_by(mqtt::disconnect(0x8b));
  EXPECT_GE(broker_.next_deadline() - now_, ReconnectPause::longest);
  pass_pause();
  connect();
  now_ += MqttBroker::good_session;
  end_by(mqtt::disconnect(0x8b));
  EXPECT_LE(broker_.next_deadline() - now_, ReconnectPause::first * 3 / 2);
}

TEST_F(MqttBrokerTest, ItsLastWordHasTheWillTold) {
  ClientPacket packet;
  {
    MqttBroker other(loop_, log_, options());
    other.step(now_);
    EXPECT_TRUE(turn_until(loop_, [&] {
      other.step(now_);
      return fake_.take(packet) && packet.kind() == 0x10;
    }));
    fake_.send(mqtt::connack());
    EXPECT_TRUE(turn_until(loop_, [&] {
      other.step(now_);
      return other.is_connected();
    }));
  }
  EXPECT_TRUE(turn_until(loop_, [&] { return fake_.take(packet); }));
  EXPECT_EQ(packet.head, 0xe0);
  EXPECT_EQ(packet.body, Bytes{0x04});
}

struct Rubbish {
  const char* name;
  Bytes bytes;
};
std::ostream& operator<<(std::ostream& out, const Rubbish& rubbish) { return out << rubbish.name; }

class HostileBroker : public MqttBrokerTest, public testing::WithParamInterface<Rubbish> {};

TEST_P(HostileBroker, CostsTheConnectionAndNothingElse) {
  connect();
  EXPECT_FALSE(end_by(GetParam().bytes).empty());
  pass_pause();
  connect();
  EXPECT_TRUE(broker_.publish({.topic = "a", .payload = "b"}, 1));
  fake_.send(mqtt::puback(next(0x30).number()));
  EXPECT_TRUE(step_until([&] { return delivered_.size() == 1; }));
}

INSTANTIATE_TEST_SUITE_P(
    MqttBroker, HostileBroker,
    testing::Values(
        Rubbish{"text", {'H', 'T', 'T', 'P', '/', '1', '.', '1', ' ', '4', '0', '0', '\r', '\n'}},
        Rubbish{"greets_twice", mqtt::connack()},
        Rubbish{"claims_256_megabytes", {0x32, 0xff, 0xff, 0xff, 0x7f, 0, 1, 'a'}},
        Rubbish{"length_without_end", {0x32, 0xff, 0xff, 0xff, 0xff, 0xff}},
        Rubbish{"topic_beyond_the_packet", {0x32, 4, 0xff, 0xff, 'a', 'b'}},
        Rubbish{"no_topic", {0x32, 5, 0, 0, 0, 1, 0}}, Rubbish{"empty_message", {0x32, 0}},
        Rubbish{"properties_beyond_the_packet", {0x32, 6, 0, 1, 'a', 0, 1, 0x7f}},
        Rubbish{"property_that_is_none", {0x32, 8, 0, 1, 'a', 0, 1, 2, 0x7e, 1}},
        Rubbish{"suback_with_a_property_that_is_none", {0x90, 4, 0, 1, 1, 0x7e}},
        Rubbish{"property_of_another_packet", {0x32, 8, 0, 1, 'a', 0, 1, 2, 0x24, 1}},
        Rubbish{"topic_with_a_zero_byte", {0x32, 7, 0, 2, 'a', 0, 0, 1, 0}},
        Rubbish{"topic_that_is_no_utf8", {0x32, 7, 0, 2, 0xc3, 0x28, 0, 1, 0}},
        Rubbish{"packet_number_zero", {0x32, 6, 0, 1, 'a', 0, 0, 0}},
        Rubbish{"puback_without_a_number", {0x40, 1, 0}}, Rubbish{"puback_of_nothing", {0x40, 0}},
        Rubbish{"suback_of_nothing", {0x90, 0}},
        Rubbish{"quality_2", {0x34, 6, 0, 1, 'a', 0, 1, 0}},
        Rubbish{"farewell_of_nothing", {0xe0, 0}},
        Rubbish{"farewell_with_bad_properties", {0xe0, 4, 0x8b, 2, 0xff, 0xff}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST_F(MqttBrokerTest, PacketsThatWereChangedDoNoHarm) {
  std::mt19937 chance(1);
  int ended = 0;
  for (int round = 0; round < 300; ++round) {
    connect();
    EXPECT_TRUE(broker_.publish({.topic = "a", .payload = "b"}, 1));
    const auto number = next(0x30).number();
    Bytes stream;
    for (const Bytes& part : {mqtt::puback(number), mqtt::publish(3, "a/b", "some payload"),
                              mqtt::suback(7), mqtt::publish(4, "c", "", true)}) {
      stream.insert(stream.end(), part.begin(), part.end());
    }
    mutate(stream, 1 + chance() % 4, chance);
    fake_.send(stream);
    // Whatever they were, a farewell behind them ends it, if it is understood; else the hang-up.
    fake_.send(mqtt::disconnect(0x8b));
    const std::size_t before = lost_.size();
    for (int i = 0; i < 3 && lost_.size() == before; ++i) {
      loop_.wait(Duration{0});
      broker_.step(now_);
    }
    ended += lost_.size() > before ? 1 : 0;
    fake_.hang_up();
    EXPECT_TRUE(step_until([&] { return lost_.size() > before; }));
    pass_pause();
  }
  EXPECT_GT(ended, 100);
}

// libmosquitto takes memory for each message and gives it back: what is in use does not grow, with
// messages or with sessions.
TEST_F(MqttBrokerTest, MemoryDoesNotGrow) {
  const std::vector<std::string> filters{"a/#"};
  broker_.subscribe(filters);
  const auto exchange = [&](std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      EXPECT_TRUE(broker_.publish({.topic = "a/b", .payload = "some payload"}, i));
      const auto number = next(0x30).number();
      fake_.send(mqtt::puback(number));
      fake_.send(mqtt::publish(static_cast<std::uint16_t>(1 + i % 1000), "a/c", "other payload"));
      const std::size_t before = delivered_.size();
      EXPECT_TRUE(step_until([&] { return delivered_.size() > before && !messages_.empty(); }));
      next(0x40);
      messages_.clear();
      delivered_.clear();
    }
  };
  const auto session = [&](std::uint32_t count) {
    connect();
    exchange(count);
    const std::size_t in_use = bytes_in_use();
    end_by(mqtt::disconnect(0x8b));
    pass_pause();
    lost_.clear();
    log_.lines.clear();
    return in_use;
  };
  for (int i = 0; i < 10; ++i) session(50);
  const std::size_t first = session(50);
  std::size_t last = 0;
  for (int i = 0; i < 20; ++i) last = session(50);
  constexpr std::size_t slack = 4096;  // of the test's own log and packets
  EXPECT_LE(last, first + slack);
  EXPECT_LE(session(2000), first + slack);
}

TEST_F(MqttBrokerTest, WithNothingToDoItTakesNoMemory) {
  connect();
  for (int i = 0; i < 5; ++i) broker_.step(now_ += 1s);
  const test::AllocationWatch watch;
  for (int i = 0; i < 100; ++i) broker_.step(now_ += 100ms);
  EXPECT_EQ(watch.allocations(), 0u);
}

}  // namespace
}  // namespace etcm::port
