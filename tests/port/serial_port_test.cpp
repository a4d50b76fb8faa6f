// A port is set as its line says, and other programs' ports are left alone; on pseudo terminals,
// which take every setting but parity.
#include "modbus/serial_port.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <modbus/modbus.h>
#include <sys/ioctl.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <filesystem>

#include "modbus/line_speed.h"
#include "peer.h"
#include "pseudo_terminal.h"
#include "support/emulated.h"
#include "support/scratch_folder.h"

namespace etcm::port {
namespace {

termios settings_of(const FileDescriptor& port) {
  termios settings{};
  EXPECT_EQ(::tcgetattr(port.get(), &settings), 0);
  return settings;
}

std::uint32_t speed_of(int descriptor) {
  // Of the kernel's own settings of a terminal; its header cannot stand beside <termios.h>.
  struct {
    std::uint32_t flags[4];
    std::uint8_t line, characters[19];
    std::uint32_t in, out;
  } settings{};
  EXPECT_EQ(::ioctl(descriptor, _IOR('T', 0x2A, settings), &settings), 0);
  EXPECT_EQ(settings.in, settings.out);
  return settings.out;
}

TEST(SerialPort, IsSetAsTheLineSays) {
  const nodes::PseudoTerminal cable;
  const std::pair<std::uint32_t, speed_t> speeds[] = {
      {1200, B1200},     {2400, B2400},     {4800, B4800},    {9600, B9600},
      {19200, B19200},   {38400, B38400},   {57600, B57600},  {115200, B115200},
      {230400, B230400}, {460800, B460800}, {921600, B921600}};
  for (const auto& [baud, speed] : speeds) {
    // QEMU's table of speeds ends before this one.
    if (test::is_emulated && speed == B921600) continue;
    for (const Parity parity : {Parity::none, Parity::even, Parity::odd}) {
      for (const std::uint8_t stop_bits : {std::uint8_t{1}, std::uint8_t{2}}) {
        ASSERT_TRUE(is_baud(baud));
        std::string why;
        const FileDescriptor port = open_serial(
            {.path = cable.path(), .baud = baud, .parity = parity, .stop_bits = stop_bits}, why);
        ASSERT_TRUE(port.is_open()) << baud << ": " << why;
        const termios settings = settings_of(port);
        EXPECT_EQ(::cfgetispeed(&settings), speed);
        EXPECT_EQ(::cfgetospeed(&settings), speed);
        EXPECT_EQ((settings.c_cflag & CSTOPB) != 0, stop_bits == 2);
        EXPECT_EQ(settings.c_cflag & (CSIZE | CREAD | CLOCAL | CRTSCTS), CS8 | CREAD | CLOCAL);
        EXPECT_EQ(settings.c_lflag & (ICANON | ECHO | ISIG), 0u);
        EXPECT_EQ(settings.c_oflag & OPOST, 0u);
        EXPECT_EQ(settings.c_iflag & ~tcflag_t{INPCK}, 0u);
      }
    }
  }
}

TEST(SerialPort, WhoseDriverLeavesOutTheParityWillNotDo) {
  const dev_t adapter = makedev(188, 0), uart = makedev(4, 64), terminal = makedev(136, 7);
  termios settings{};
  EXPECT_TRUE(can_carry(settings, Parity::none, adapter));
  EXPECT_FALSE(can_carry(settings, Parity::even, adapter));
  EXPECT_FALSE(can_carry(settings, Parity::odd, uart));
  EXPECT_TRUE(can_carry(settings, Parity::odd, terminal));
  settings.c_cflag = PARENB;
  EXPECT_FALSE(can_carry(settings, Parity::none, uart));
  EXPECT_TRUE(can_carry(settings, Parity::even, uart));
  EXPECT_FALSE(can_carry(settings, Parity::odd, adapter));
  settings.c_cflag |= PARODD;
  EXPECT_TRUE(can_carry(settings, Parity::odd, adapter));
  EXPECT_FALSE(can_carry(settings, Parity::even, adapter));
}

// libmodbus takes such a speed for 9600.
TEST(SerialPort, HasASpeedThatIsNotUsual) {
  const nodes::PseudoTerminal cable;
  for (const std::uint32_t baud : {baud_least, 250'000u, 1'500'000u, baud_most, 9600u}) {
    for (int time = 0; time < 2; ++time) {
      std::string why;
      const FileDescriptor port = open_serial({.path = cable.path(), .baud = baud}, why);
      if (why.find("TCGETS2: Function not implemented") != std::string::npos) {
        GTEST_SKIP() << "this emulator knows usual speeds only";
      }
      ASSERT_TRUE(port.is_open()) << baud << ": " << why;
      EXPECT_EQ(speed_of(port.get()), baud);
    }
  }
}

TEST(SerialPort, IsKeptFromSpeedsTooFarOff) {
  EXPECT_TRUE(is_near(250'000, 250'000));
  EXPECT_TRUE(is_near(255'000, 250'000));
  EXPECT_TRUE(is_near(245'000, 250'000));
  EXPECT_FALSE(is_near(255'001, 250'000));
  EXPECT_FALSE(is_near(244'999, 250'000));
  EXPECT_FALSE(is_near(0, 50));
  EXPECT_FALSE(is_near(4'294'967'295, 50));
  const FileDescriptor null(::open("/dev/null", O_RDWR | O_CLOEXEC));
  std::string why;
  EXPECT_FALSE(set_speed(null.get(), 1234, why));
  EXPECT_NE(why.find("takes no speed of 1234 baud"), std::string::npos) << why;
  EXPECT_NE(why.find("give `baud`"), std::string::npos) << why;
}

// A pseudo terminal knows no RS-485: its driver refuses, and what is not asked for is no trouble.
TEST(SerialPort, WithoutRs485InItsDriverIsOnlyRefusedWhatNeedsIt) {
  const nodes::PseudoTerminal cable;
  for (const Rs485Mode mode : {Rs485Mode::keep, Rs485Mode::off}) {
    std::string why;
    EXPECT_TRUE(open_serial({.path = cable.path(), .rs485 = {.mode = mode}}, why).is_open()) << why;
  }
  std::string why;
  EXPECT_FALSE(
      open_serial({.path = cable.path(), .rs485 = {.mode = Rs485Mode::on}}, why).is_open());
  EXPECT_NE(why.find("TIOCGRS485"), std::string::npos) << why;
  EXPECT_NE(why.find("give `rs485_line`"), std::string::npos) << why;
}

// A pseudo terminal has no parity, and the C library complains of that where nothing else changes.
TEST(SerialPort, OpensAgainAsItWas) {
  const nodes::PseudoTerminal cable;
  for (int time = 0; time < 3; ++time) {
    std::string why;
    EXPECT_TRUE(open_serial({.path = cable.path()}, why).is_open()) << why;
  }
  modbus_t* const other = modbus_new_rtu(cable.path().c_str(), 19200, 'E', 8, 1);
  EXPECT_EQ(modbus_connect(other), 0);
  // As from a program that was killed: nothing is put back.
  const FileDescriptor left(modbus_get_socket(other));
  modbus_free(other);
  std::string why;
  EXPECT_TRUE(open_serial({.path = cable.path()}, why).is_open()) << why;
}

TEST(SerialPort, ThatAnotherProgramHasIsLeftAsItIsSet) {
  const nodes::PseudoTerminal cable;
  std::string why;
  FileDescriptor port = open_serial({.path = cable.path(), .baud = 9600}, why);
  ASSERT_TRUE(port.is_open()) << why;
  const pid_t other = ::fork();
  if (other == 0) {
    for (;;) ::pause();
  }
  port.close();  // now the other process alone has it
  EXPECT_FALSE(open_serial({.path = cable.path(), .baud = 1200}, why).is_open());
  EXPECT_NE(why.find("another program has it"), std::string::npos) << why;
  port = FileDescriptor(::open(cable.path().c_str(), O_RDWR | O_NOCTTY));
  const termios settings = settings_of(port);
  ::kill(other, SIGKILL);
  ::waitpid(other, nullptr, 0);
  EXPECT_EQ(::cfgetispeed(&settings), speed_t{B9600});
}

TEST(SerialPort, NothingThatCameIsNoEnd) {
  const nodes::PseudoTerminal cable;
  std::string why;
  const FileDescriptor port = open_serial({.path = cable.path()}, why);
  ASSERT_TRUE(port.is_open()) << why;
  std::uint8_t byte = 0;
  EXPECT_EQ(::read(port.get(), &byte, 1), -1);
  EXPECT_EQ(errno, EAGAIN);
}

// Another name of it makes it no other port.
TEST(SerialPort, ThatThisProgramHasIsNotSaidToBeAnotherPrograms) {
  const nodes::PseudoTerminal cable;
  const test::ScratchFolder folder;
  const std::string link = folder.path("by-id");
  std::filesystem::create_symlink(cable.path(), link);
  std::string why;
  const FileDescriptor port = open_serial({.path = cable.path()}, why);
  ASSERT_TRUE(port.is_open()) << why;
  EXPECT_FALSE(open_serial({.path = link}, why).is_open());
  EXPECT_EQ(why, "it is the same port as " + cable.path() +
                     ", which another [[bus]] has; put the units of both into one");
}

}  // namespace
}  // namespace etcm::port
