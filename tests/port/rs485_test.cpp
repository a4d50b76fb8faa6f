// What is made of the driver's own settings of RS-485, and what is said of those that it did not
// take; with the structure of the system.
#include "modbus/rs485.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/serial.h>

#include <string>

#include "posix/file_descriptor.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t enabled = SER_RS485_ENABLED;
constexpr std::uint32_t high = SER_RS485_RTS_ON_SEND;
constexpr std::uint32_t low = SER_RS485_RTS_AFTER_SEND;
constexpr std::uint32_t echo = SER_RS485_RX_DURING_TX;

serial_rs485 driver(std::uint32_t flags, std::uint32_t before = 0, std::uint32_t after = 0) {
  serial_rs485 settings{};
  settings.flags = flags;
  settings.delay_rts_before_send = before;
  settings.delay_rts_after_send = after;
  return settings;
}

TEST(Rs485Settings, WhatTheLineDoesNotSayStays) {
  const serial_rs485 tree = driver(low | echo | SER_RS485_TERMINATE_BUS, 3, 4);
  const serial_rs485 on = combine(tree, {.mode = Rs485Mode::on});
  EXPECT_EQ(on.flags, enabled | tree.flags);
  EXPECT_EQ(on.delay_rts_before_send, 3u);
  EXPECT_EQ(on.delay_rts_after_send, 4u);
  EXPECT_EQ(combine(on, {.mode = Rs485Mode::off}).flags, tree.flags);
  EXPECT_EQ(combine(on, {.mode = Rs485Mode::keep}).flags, on.flags);
}

TEST(Rs485Settings, WhatTheLineSaysTakesItsPlace) {
  const serial_rs485 set = combine(driver(low | echo, 3, 4), {.mode = Rs485Mode::on,
                                                              .rts_while_sending = RtsLevel::high,
                                                              .delay_before = 0ms,
                                                              .delay_after = 100ms});
  EXPECT_EQ(set.flags, enabled | high | echo);
  EXPECT_EQ(set.delay_rts_before_send, 0u);
  EXPECT_EQ(set.delay_rts_after_send, 100u);
  EXPECT_EQ(
      combine(driver(high), {.mode = Rs485Mode::on, .rts_while_sending = RtsLevel::low}).flags,
      enabled | low);
}

TEST(Rs485Settings, WithoutALevelOrWithBothItIsHigh) {
  for (const std::uint32_t levels : {0u, high | low}) {
    EXPECT_EQ(combine(driver(levels), {.mode = Rs485Mode::on}).flags, enabled | high);
  }
}

TEST(Rs485Settings, WhatTheDriverDidNotTakeIsNamed) {
  struct Row {
    serial_rs485 actual;
    Rs485 wanted;
    std::string part;  // empty: all is done
  };
  const Rs485 all{.mode = Rs485Mode::on,
                  .rts_while_sending = RtsLevel::low,
                  .delay_before = 1ms,
                  .delay_after = 2ms};
  const Row rows[] = {
      {driver(enabled | low, 1, 2), all, ""},
      {driver(enabled | high, 1, 2), all, "`rs485_rts`"},
      {driver(enabled | low | high, 1, 2), all, "`rs485_rts`"},
      {driver(enabled | low, 0, 2), all, "`rs485_delay_before`"},
      {driver(enabled | low, 1, 3), all, "`rs485_delay_after`"},
      {driver(low, 1, 2), all, "does not switch RS-485"},
      {driver(enabled, 9, 9), {.mode = Rs485Mode::on}, ""},
      {driver(enabled), {.mode = Rs485Mode::off}, "whatever it is told"},
      {driver(0), {.mode = Rs485Mode::off}, ""},
      {driver(enabled), {.mode = Rs485Mode::keep}, ""},
  };
  for (const Row& row : rows) {
    std::string why;
    EXPECT_EQ(is_done(row.actual, row.wanted, why), row.part.empty()) << why;
    EXPECT_NE(why.find(row.part), std::string::npos) << why;
    EXPECT_EQ(why.find("take") == std::string::npos, row.part.empty()) << why;
  }
}

TEST(Rs485Settings, WhatIsNoSerialPortRefuses) {
  const FileDescriptor null(::open("/dev/null", O_RDWR | O_CLOEXEC));
  std::string why;
  EXPECT_TRUE(set_rs485(null.get(), {.mode = Rs485Mode::keep}, why));
  EXPECT_TRUE(set_rs485(null.get(), {.mode = Rs485Mode::off}, why));
  EXPECT_EQ(why, "");
  EXPECT_FALSE(set_rs485(null.get(), {.mode = Rs485Mode::on}, why));
  EXPECT_NE(why.find("TIOCGRS485: "), std::string::npos) << why;
}

}  // namespace
}  // namespace etcm::port
