#include "modbus/line_speed.h"

// The kernel's own settings of a terminal: the C library's have no place for the number. Its header
// cannot stand beside <termios.h>.
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "etcm/port/serial_line.h"

namespace etcm::port {

bool is_near(std::uint32_t actual, std::uint32_t wanted) {
  const std::int64_t off = std::int64_t{actual} - wanted;
  return std::abs(off) * 100 <= std::int64_t{wanted} * speed_error_percent_max;
}

bool set_speed(int descriptor, std::uint32_t baud, std::string& why) {
  const std::string wanted = "its driver takes no speed of " + std::to_string(baud) + " baud";
  const std::string cure = "; give `baud` one that it takes, such as 9600, 19200 or 115200";
  termios2 settings{};
  if (::ioctl(descriptor, TCGETS2, &settings) != 0) {
    // Emulators of other machines have no such call; libmodbus has set what is usual without it.
    if (errno == ENOSYS && usual_baud_near(baud) == baud) return true;
    why = wanted + " (TCGETS2: " + std::strerror(errno) + ")" + cure;
    return false;
  }
  if (settings.c_ospeed == baud && settings.c_ispeed == baud) return true;
  settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD | CBAUD << IBSHIFT);
  settings.c_cflag |= BOTHER | BOTHER << IBSHIFT;
  settings.c_ispeed = settings.c_ospeed = baud;
  if (::ioctl(descriptor, TCSETS2, &settings) != 0 ||
      ::ioctl(descriptor, TCGETS2, &settings) != 0) {
    why = wanted + " (TCSETS2: " + std::strerror(errno) + ")" + cure;
    return false;
  }
  if (is_near(settings.c_ospeed, baud)) return true;
  why = wanted + " (it would be " + std::to_string(settings.c_ospeed) + ")" + cure;
  return false;
}

}  // namespace etcm::port
