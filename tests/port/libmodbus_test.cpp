// Where libmodbus is not what a gateway needs, so that code of our own stands in its place;
// port/README.md has the table. A test that fails with a newer libmodbus says which of it may go.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <modbus/modbus.h>
#include <sys/file.h>
#include <termios.h>

#include <cerrno>
#include <memory>

#include "peer.h"
#include "posix/file_descriptor.h"
#include "pseudo_terminal.h"

namespace etcm::port {
namespace {

struct CloseContext {
  void operator()(modbus_t* context) const {
    modbus_close(context);
    modbus_free(context);
  }
};
using Libmodbus = std::unique_ptr<modbus_t, CloseContext>;

class LibmodbusPort : public testing::Test {
 protected:
  Libmodbus line(int baud, char parity = 'N') const {
    return Libmodbus(modbus_new_rtu(cable_.path().c_str(), baud, parity, 8, 1));
  }
  speed_t speed() const {
    termios settings{};
    EXPECT_EQ(::tcgetattr(cable_.descriptor(), &settings), 0);
    return ::cfgetospeed(&settings);
  }

  const nodes::PseudoTerminal cable_;
};

TEST_F(LibmodbusPort, SetsWhatAnotherProgramHas) {
  const FileDescriptor owner(::open(cable_.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  ASSERT_EQ(::flock(owner.get(), LOCK_EX | LOCK_NB), 0);
  const Libmodbus first = line(9600);
  ASSERT_EQ(modbus_connect(first.get()), 0);
  const Libmodbus second = line(1200);
  EXPECT_EQ(modbus_connect(second.get()), 0);
  EXPECT_EQ(speed(), speed_t{B1200});
}

TEST_F(LibmodbusPort, PutsBackOldSettingsAtItsClose) {
  const speed_t before = speed();
  Libmodbus context = line(1200);
  ASSERT_EQ(modbus_connect(context.get()), 0);
  EXPECT_EQ(speed(), speed_t{B1200});
  context.reset();
  EXPECT_EQ(speed(), before);
}

TEST_F(LibmodbusPort, TakesASpeedItDoesNotKnowFor9600) {
  const Libmodbus context = line(12345);
  EXPECT_EQ(modbus_connect(context.get()), 0);
  EXPECT_EQ(speed(), speed_t{B9600});
}

TEST_F(LibmodbusPort, ReadsNothingAsAnEnd) {
  const Libmodbus context = line(9600);
  ASSERT_EQ(modbus_connect(context.get()), 0);
  std::uint8_t byte = 0;
  EXPECT_EQ(::read(modbus_get_socket(context.get()), &byte, 1), 0);
}

}  // namespace
}  // namespace etcm::port
