// Addresses, networks and names as a person writes them.
#include "etcm/port/endpoint.h"

#include <gtest/gtest.h>

#include <string>

namespace etcm::port {
namespace {

TEST(EndpointText, OneThatIsGoodIsReadAndPrintedInOneSpelling) {
  const std::pair<std::string, std::string> rows[] = {
      {"127.0.0.1:502", "127.0.0.1:502"},
      {"plc:502", "plc:502"},
      {"PLC-7.Example.:65535", "plc-7.example.:65535"},
      {"7up.example:0", "7up.example:0"},
      {"_modbus.plc:1", "_modbus.plc:1"},
      {"[::1]:502", "[::1]:502"},
      {"[2001:0DB8:0:0::1]:502", "[2001:db8::1]:502"},
      {"[fe80::1%eth0]:502", "[fe80::1%eth0]:502"},
      {"[::ffff:10.0.0.1]:502", "10.0.0.1:502"},
      {std::string(63, 'a') + ".b:1", std::string(63, 'a') + ".b:1"},
  };
  for (const auto& [text, printed] : rows) {
    const auto end = parse_endpoint(text);
    ASSERT_TRUE(end) << text;
    EXPECT_EQ(to_string(*end), printed);
    EXPECT_EQ(parse_endpoint(to_string(*end)), end) << text;
  }
}

TEST(EndpointText, WhatIsNoneIsRefused) {
  const std::string zero("plc\0.example:502", 16);
  for (const std::string& text : {std::string(),
                                  std::string(":"),
                                  std::string(":502"),
                                  std::string("plc"),
                                  std::string("plc:"),
                                  std::string("plc:65536"),
                                  std::string("plc:-1"),
                                  std::string("plc:502x"),
                                  std::string("plc: 502"),
                                  std::string(" plc:502"),
                                  std::string("a b:502"),
                                  std::string("a..b:502"),
                                  std::string(".:502"),
                                  std::string("-a:502"),
                                  std::string("a-:502"),
                                  std::string("a/b:502"),
                                  std::string("pl\xc3\xa4tz:502"),
                                  std::string("10.0.5:502"),
                                  std::string("10.0.0.256:502"),
                                  std::string("1:502"),
                                  std::string("0x7f000001:502"),
                                  std::string("a.0x1f:502"),
                                  std::string("127.0.0.1.:502"),
                                  std::string("2001:db8::1:502"),
                                  std::string("::1"),
                                  std::string("[::1]"),
                                  std::string("[::1]502"),
                                  std::string("[::1:502"),
                                  std::string("[plc]:502"),
                                  std::string("[127.0.0.1]:502"),
                                  std::string("[]:502"),
                                  std::string("[::1%]:502"),
                                  std::string("[fe80::1%eth0"),
                                  std::string("[fe80::1%a%b]:502"),
                                  std::string("[fe80::1%0123456789abcdef]:502"),
                                  std::string("[::ffff:1.2.3.4%eth0]:502"),
                                  std::string("[:::1]:502"),
                                  zero,
                                  std::string(64, 'a') + ":502",
                                  std::string(127, 'a') + ":502",
                                  std::string(100'000, '[')}) {
    EXPECT_FALSE(parse_endpoint(text)) << text;
  }
  std::string longest;
  for (int i = 0; i < 127; ++i) longest += "a.";
  EXPECT_FALSE(parse_endpoint(longest + "b:1"));
  EXPECT_TRUE(parse_endpoint(longest.substr(0, 252) + "b:1"));
}

TEST(EndpointText, WithAStandardPortItMayBeLeftOut) {
  const std::pair<std::string, std::string> rows[] = {
      {"plc", "plc:502"},    {"plc:503", "plc:503"},     {"10.0.0.1", "10.0.0.1:502"},
      {"::1", "[::1]:502"},  {"[::1]:503", "[::1]:503"}, {"fe80::1%eth0", "[fe80::1%eth0]:502"},
      {"[::1]", "[::1]:502"}};
  for (const auto& [text, printed] : rows) {
    const auto end = parse_endpoint(text, 502);
    ASSERT_TRUE(end) << text;
    EXPECT_EQ(to_string(*end), printed);
  }
  for (const char* text : {"", "plc:", "plc:x", "[::1]:", "[::1]x", "10.0.5", "1", "a:b:c"}) {
    EXPECT_FALSE(parse_endpoint(text, 502)) << text;
  }
}

TEST(EndpointText, NamesAndAddressesAreToldApart) {
  for (const char* text : {"plc:1", "localhost:1", "no-such-host.invalid:1"}) {
    EXPECT_TRUE(has_name(*parse_endpoint(text))) << text;
  }
  for (const char* text : {"127.0.0.1:1", "[::1]:1", "[fe80::1%eth0]:1"}) {
    EXPECT_FALSE(has_name(*parse_endpoint(text))) << text;
  }
  EXPECT_EQ(address_of(*parse_endpoint("[::1]:1")), loopback_ipv6);
  EXPECT_FALSE(address_of(*parse_endpoint("[fe80::1%eth0]:1"))) << "the zone has no number yet";
}

TEST(SocketAddressText, IsReadAndPrintedForBothKinds) {
  for (const char* text : {"0.0.0.0:0", "127.0.0.1:502", "[::]:502", "[2001:db8::1]:65535"}) {
    const auto address = parse_socket_address(text);
    ASSERT_TRUE(address) << text;
    EXPECT_EQ(to_string(*address), text);
  }
  for (const char* text : {"", "::", "[::]", "::1:502", "[127.0.0.1]:502", "localhost:502",
                           "[fe80::1%eth0]:502", "1.2.3:4", "[::1]:65536", "[]:1", "]:1"}) {
    EXPECT_FALSE(parse_socket_address(text)) << text;
  }
}

TEST(NetworkText, ContainsWhatAgreesInItsFirstBits) {
  struct Row {
    const char* network;
    const char* host;
    bool is_inside;
  };
  const Row rows[] = {{"10.0.0.0/8", "10.255.0.1", true},
                      {"10.0.0.0/8", "11.0.0.1", false},
                      {"10.0.0.0/8", "::1", false},
                      {"0.0.0.0/0", "192.0.2.1", true},
                      {"0.0.0.0/0", "2001:db8::1", false},
                      {"::/0", "2001:db8::1", true},
                      {"::/0", "192.0.2.1", true},
                      {"2001:db8::/32", "2001:db8:ffff::1", true},
                      {"2001:db8::/32", "2001:db9::1", false},
                      {"2001:db8::/33", "2001:db8:8000::1", false},
                      {"::1", "::1", true},
                      {"::1", "::2", false},
                      {"127.0.0.1", "127.0.0.1", true},
                      {"127.0.0.1/31", "127.0.0.2", false}};
  for (const Row& row : rows) {
    const auto network = parse_network(row.network);
    ASSERT_TRUE(network) << row.network;
    EXPECT_EQ(network->contains(*parse_host_address(row.host)), row.is_inside)
        << row.network << " " << row.host;
  }
  for (const char* text : {"", "/8", "10.0.0.0/33", "::/129", "::/", "::/x", "::/-1", "plc/8",
                           "10.0.0.0/", "[::1]/128", "fe80::1%eth0"}) {
    EXPECT_FALSE(parse_network(text)) << text;
  }
  EXPECT_EQ(to_string(*parse_network("2001:DB8::/32")), "2001:db8::/32");
}

}  // namespace
}  // namespace etcm::port
