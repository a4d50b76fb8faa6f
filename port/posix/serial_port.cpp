#include "posix/serial_port.h"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <cerrno>
#include <cstring>

namespace etcm::port {

namespace {

speed_t speed_of(std::uint32_t baud) {
  switch (baud) {
    case 1200:
      return B1200;
    case 2400:
      return B2400;
    case 4800:
      return B4800;
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    case 230400:
      return B230400;
    case 460800:
      return B460800;
    default:
      return B921600;
  }
}

bool set_raw(int descriptor, const SerialLine& line) {
  termios settings{};
  if (::tcgetattr(descriptor, &settings) != 0) return false;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB | PARENB | PARODD);
  if (line.stop_bits == 2) settings.c_cflag |= CSTOPB;
  if (line.parity != Parity::none) settings.c_cflag |= PARENB;
  if (line.parity == Parity::odd) settings.c_cflag |= PARODD;
  // A byte of wrong parity is passed as 0: the checksum of its frame tells.
  if (line.parity != Parity::none) settings.c_iflag |= INPCK;
  ::cfsetispeed(&settings, speed_of(line.baud));
  ::cfsetospeed(&settings, speed_of(line.baud));
  if (::tcsetattr(descriptor, TCSANOW, &settings) == 0) return true;
  // A pseudo terminal has no parity. The C library calls that an error when all the rest stands as
  // it should from the last time.
  termios found{};
  constexpr tcflag_t parity = PARENB | PARODD;
  return errno == EINVAL && ::tcgetattr(descriptor, &found) == 0 &&
         (found.c_cflag | parity) == (settings.c_cflag | parity) &&
         found.c_iflag == settings.c_iflag && found.c_lflag == settings.c_lflag;
}

bool switch_by_kernel(int descriptor) {
  serial_rs485 settings{};
  settings.flags = SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND;
  return ::ioctl(descriptor, TIOCSRS485, &settings) == 0;
}

}  // namespace

FileDescriptor open_serial(const SerialLine& line, std::string& why) {
  FileDescriptor port(::open(line.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port.is_open()) {
    const int error = errno;
    why = std::strerror(error);
    if (error == EACCES) why += "; whoever runs this must be in the group dialout";
    if (error == EPERM) why += "; a service needs DeviceAllow for its driver (systemctl edit)";
    if (error == ENOENT) why += "; ls /dev/serial/by-path lists the ports there are";
    return {};
  }
  // Two programs on one line would take each other's answers.
  if (::flock(port.get(), LOCK_EX | LOCK_NB) != 0) {
    why = "another program has it; end that one (fuser -v names it)";
    return {};
  }
  if (!set_raw(port.get(), line)) {
    why = std::string("is no serial port that can be set (") + std::strerror(errno) + ")";
    return {};
  }
  if (line.direction == Direction::kernel && !switch_by_kernel(port.get())) {
    why = std::string("its driver refuses to switch RS-485 (TIOCSRS485: ") + std::strerror(errno) +
          "); take `rs485` out where the adapter switches by itself, or give `rs485_line`";
    return {};
  }
  discard_waiting(port.get());
  return port;
}

void discard_waiting(int descriptor) { ::tcflush(descriptor, TCIOFLUSH); }

bool is_sent(int descriptor) {
  int waiting = 0;
  if (::ioctl(descriptor, TIOCOUTQ, &waiting) == 0 && waiting > 0) return false;
  unsigned int line_status = 0;
  if (::ioctl(descriptor, TIOCSERGETLSR, &line_status) != 0) return true;
  return (line_status & TIOCSER_TEMT) != 0;
}

}  // namespace etcm::port
