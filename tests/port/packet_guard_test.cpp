// What of a broker's stream is let through to libmosquitto.
#include "mqtt/packet_guard.h"

#include <gtest/gtest.h>

#include "fake_broker.h"

namespace etcm::port {
namespace {

constexpr std::uint32_t most = 1000;

Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

TEST(PacketGuard, ASoundConversationPassesInAnyPieces) {
  const Bytes all = joined({mqtt::connack(), mqtt::suback(1), mqtt::puback(2),
                            mqtt::puback(3, 0x87), mqtt::publish(4, "a/b", std::string(900, 'x')),
                            Bytes{0xd0, 0}, mqtt::publish(5, "a", ""), mqtt::disconnect(0x8e)});
  for (std::size_t piece = 1; piece <= all.size(); piece = piece * 2 + 1) {
    PacketGuard guard(most);
    for (std::size_t at = 0; at < all.size(); at += piece) {
      const auto part = std::span(all).subspan(at, std::min(piece, all.size() - at));
      EXPECT_TRUE(guard.pass(part)) << guard.why();
    }
    EXPECT_EQ(guard.packets_begun(), 8u) << piece;
  }
}

// Every kind of value, in a message and in a greeting.
TEST(PacketGuard, PropertiesPassInAnyPieces) {
  const Bytes properties{0x01, 1,    0x23, 0, 1,   0x02, 0,   0,    0,    9,    0x0b,
                         0x80, 1,    0x03, 0, 2,   'a',  'b', 9,    0x00, 0x02, 1,
                         2,    0x26, 0,    1, 'k', 0,    0,   0x08, 0,    0};
  Bytes body;
  mqtt::append_text(body, "a/b");
  mqtt::append_length(body, properties.size());
  body.insert(body.end(), properties.begin(), properties.end());
  body.push_back('p');
  const Bytes all =
      joined({mqtt::connack(0, properties), mqtt::packet(0x30, body), mqtt::publish(1, "c", "d")});
  for (std::size_t piece = 1; piece <= all.size(); ++piece) {
    PacketGuard guard(most);
    for (std::size_t at = 0; at < all.size(); at += piece) {
      const auto part = std::span(all).subspan(at, std::min(piece, all.size() - at));
      EXPECT_TRUE(guard.pass(part)) << guard.why();
    }
    EXPECT_EQ(guard.packets_begun(), 3u) << piece;
  }
}

struct Bad {
  const char* name;
  Bytes bytes;
};
std::ostream& operator<<(std::ostream& out, const Bad& bad) { return out << bad.name; }

class PacketGuardRefuses : public testing::TestWithParam<Bad> {};

TEST_P(PacketGuardRefuses, WhatNoBrokerMaySend) {
  PacketGuard guard(most);
  EXPECT_FALSE(guard.pass(GetParam().bytes));
  EXPECT_STRNE(guard.why(), "");
}

INSTANTIATE_TEST_SUITE_P(
    All, PacketGuardRefuses,
    testing::Values(
        Bad{"message_first", mqtt::publish(1, "a", "b")}, Bad{"http", {'H', 'T', 'T', 'P'}},
        Bad{"connack_twice", joined({mqtt::connack(), mqtt::connack()})},
        Bad{"connack_too_long", {0x20, 0x81, 0x40}},
        Bad{"message_too_long", joined({mqtt::connack(), {0x30, 0xff, 0x07}})},
        Bad{"message_of_256_megabytes", joined({mqtt::connack(), {0x30, 0xff, 0xff, 0xff, 0x7f}})},
        Bad{"length_without_end", joined({mqtt::connack(), {0x30, 0xff, 0xff, 0xff, 0xff}})},
        Bad{"unknown_property", joined({mqtt::connack(), {0x30, 6, 0, 1, 'a', 2, 0x7e, 0}})},
        Bad{"property_with_a_long_number",
            joined({mqtt::connack(), {0x30, 7, 0, 1, 'a', 3, 0x81, 1, 0}})},
        Bad{"property_beyond_its_properties",
            joined({mqtt::connack(), {0x30, 9, 0, 1, 'a', 2, 0x02, 0, 0, 0, 1}})},
        Bad{"text_beyond_its_properties",
            joined({mqtt::connack(), {0x30, 9, 0, 1, 'a', 4, 0x03, 0, 9, 'x', 'y'}})},
        Bad{"properties_beyond_the_packet", joined({mqtt::connack(), {0x30, 5, 0, 1, 'a', 9, 1}})},
        Bad{"topic_beyond_the_packet", joined({mqtt::connack(), {0x30, 3, 0, 2, 'a'}})},
        Bad{"message_without_properties", joined({mqtt::connack(), {0x30, 3, 0, 1, 'a'}})},
        Bad{"greeting_with_unknown_property", mqtt::connack(0, {0x7e, 0})},
        Bad{"farewell_with_unknown_property",
            joined({mqtt::connack(), {0xe0, 4, 0x8b, 2, 0x7e, 0}})},
        Bad{"suback_with_properties", joined({mqtt::connack(), {0x90, 4, 0, 1, 1, 0x7e}})},
        Bad{"empty_message", joined({mqtt::connack(), {0x30, 0}})},
        Bad{"puback_of_nothing", joined({mqtt::connack(), {0x40, 0}})},
        Bad{"greeting_of_nothing", {0x20, 0}}, Bad{"qos_2", joined({mqtt::connack(), {0x34, 5}})},
        Bad{"qos_3", joined({mqtt::connack(), {0x36, 5}})},
        Bad{"puback_with_properties", joined({mqtt::connack(), {0x40, 5}})},
        Bad{"suback_of_many", joined({mqtt::connack(), {0x90, 5}})},
        Bad{"pubrec", joined({mqtt::connack(), {0x50, 2}})},
        Bad{"pubrel", joined({mqtt::connack(), {0x62, 2}})},
        Bad{"pubcomp", joined({mqtt::connack(), {0x70, 2}})},
        Bad{"unsuback", joined({mqtt::connack(), {0xb0, 2}})},
        Bad{"pingreq", joined({mqtt::connack(), {0xc0, 0}})},
        Bad{"pingresp_with_body", joined({mqtt::connack(), {0xd0, 1}})},
        Bad{"auth", joined({mqtt::connack(), {0xf0, 0}})},
        Bad{"a_clients_greeting", joined({mqtt::connack(), {0x10, 0}})}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace etcm::port
