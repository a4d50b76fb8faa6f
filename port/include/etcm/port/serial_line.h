// How a serial line is set, and what that means in time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "etcm/port/clock.h"

namespace etcm::port {

enum class Parity : std::uint8_t { none, even, odd };

// Whether the driver of the serial port switches an RS-485 transceiver between listening and
// sending, with RTS.
enum class Rs485Mode : std::uint8_t {
  keep,  // as the device tree has it, or another program left it
  off,   // the adapter switches itself, or there is none
  on,
};
enum class RtsLevel : std::uint8_t { low, high };

// The driver keeps what is not said here as it has it.
struct Rs485 {
  Rs485Mode mode = Rs485Mode::keep;
  std::optional<RtsLevel> rts_while_sending{};
  // From the switch to the first bit, and from the last bit to the switch back; whole milliseconds,
  // up to rs485_delay_max.
  std::optional<Duration> delay_before{};
  std::optional<Duration> delay_after{};
};
// Linux takes no more.
inline constexpr Duration rs485_delay_max = std::chrono::milliseconds(100);

struct SerialLine {
  std::string path;  // better /dev/serial/by-path/... than /dev/ttyUSB0, which is renumbered
  std::uint32_t baud = 19200;
  Parity parity = Parity::even;
  std::uint8_t stop_bits = 1;
  Rs485 rs485{};
};

inline constexpr std::uint32_t baud_least = 50;
inline constexpr std::uint32_t baud_most = 4'000'000;
// Whether one may ask a serial port for it: not every driver takes every speed.
constexpr bool is_baud(std::uint32_t baud) { return baud_least <= baud && baud <= baud_most; }
// The one nearest to it of those that devices usually have, 1200 to 921600.
std::uint32_t usual_baud_near(std::uint32_t baud);

// Eight data bits, with start, parity and stop bits.
Duration character_time(const SerialLine& line);

// The silence that ends a Modbus RTU frame: 3.5 characters, and 1.75 ms above 19200 baud.
Duration frame_silence(const SerialLine& line);

}  // namespace etcm::port
