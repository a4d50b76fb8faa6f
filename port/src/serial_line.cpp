#include "etcm/port/serial_line.h"

#include <algorithm>
#include <array>

namespace etcm::port {

namespace {

constexpr std::array<std::uint32_t, 11> usual_bauds{1200,  2400,   4800,   9600,   19200, 38400,
                                                    57600, 115200, 230400, 460800, 921600};
constexpr std::uint32_t fixed_silence_above_baud = 19200;
constexpr Duration fixed_silence = std::chrono::microseconds(1750);

}  // namespace

std::uint32_t usual_baud_near(std::uint32_t baud) {
  const auto apart = [baud](std::uint32_t usual) {
    return usual < baud ? baud - usual : usual - baud;
  };
  return *std::min_element(usual_bauds.begin(), usual_bauds.end(),
                           [&](auto a, auto b) { return apart(a) < apart(b); });
}

Duration character_time(const SerialLine& line) {
  const int bits = 1 + 8 + (line.parity == Parity::none ? 0 : 1) + line.stop_bits;
  return Duration(std::chrono::seconds(1)) * bits / line.baud;
}

Duration frame_silence(const SerialLine& line) {
  return line.baud > fixed_silence_above_baud ? fixed_silence : character_time(line) * 7 / 2;
}

}  // namespace etcm::port
