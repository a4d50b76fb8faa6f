// How a serial line is set, and what that means in time.
#pragma once

#include <cstdint>
#include <string>

#include "etcm/port/clock.h"

namespace etcm::port {

enum class Parity : std::uint8_t { none, even, odd };

// What switches an RS-485 transceiver from listening to sending.
enum class Direction : std::uint8_t {
  adapter,  // itself, or there is none
  kernel,   // the driver of the serial port, with RTS
};

struct SerialLine {
  std::string path;  // better /dev/serial/by-path/... than /dev/ttyUSB0, which is renumbered
  std::uint32_t baud = 19200;
  Parity parity = Parity::even;
  std::uint8_t stop_bits = 1;
  Direction direction = Direction::adapter;
};

// Whether a serial port can be set to it: 1200 to 921600, the usual ones.
bool is_baud(std::uint32_t baud);

// Eight data bits, with start, parity and stop bits.
Duration character_time(const SerialLine& line);

// The silence that ends a Modbus RTU frame: 3.5 characters, and 1.75 ms above 19200 baud.
Duration frame_silence(const SerialLine& line);

}  // namespace etcm::port
