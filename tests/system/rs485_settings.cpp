// Prints what the driver of a serial port has as its settings of RS-485: on the board of
// board_test.py, where no other program can.
#include <fcntl.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const int port = ::open(argv[1], O_RDWR | O_NOCTTY | O_NONBLOCK);
  serial_rs485 settings{};
  if (port < 0 || ::ioctl(port, TIOCGRS485, &settings) != 0) {
    std::printf("rs485 of %s: %s\n", argv[1], std::strerror(errno));
    return 1;
  }
  const auto is_set = [&](unsigned flag) { return (settings.flags & flag) != 0 ? 1 : 0; };
  std::printf("rs485 of %s: enabled %d, RTS on send %d, after send %d, before %u ms, after %u ms\n",
              argv[1], is_set(SER_RS485_ENABLED), is_set(SER_RS485_RTS_ON_SEND),
              is_set(SER_RS485_RTS_AFTER_SEND), settings.delay_rts_before_send,
              settings.delay_rts_after_send);
  ::close(port);
  return 0;
}
