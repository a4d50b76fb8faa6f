// Where libmodbus is not what a gateway needs, so that code of our own stands in its place;
// port/README.md has the table. A test that fails with a newer libmodbus says which of it may go.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <modbus/modbus.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/time.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <memory>
#include <span>

#include "modbus/rtu_frame.h"
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

constexpr std::uint32_t timeout_us = 20000;

Bytes rtu_bytes(std::uint8_t unit, const Bytes& pdu) {
  Bytes bytes(rtu_frame_bytes_max);
  std::copy(pdu.begin(), pdu.end(), bytes.begin() + rtu_unit_bytes);
  bytes.resize(wrap_rtu(bytes, unit, pdu.size()));
  return bytes;
}

// A master on a line where the test says what units say, before it is waited for.
class LibmodbusRtuMaster : public LibmodbusPort {
 protected:
  LibmodbusRtuMaster() : master_(line(115200)) {
    EXPECT_EQ(modbus_connect(master_.get()), 0);
    modbus_set_response_timeout(master_.get(), 0, timeout_us);
    modbus_set_byte_timeout(master_.get(), 0, timeout_us);
  }

  void say(const Bytes& bytes) {
    ASSERT_EQ(::write(cable_.descriptor(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  // The register of a unit, or the negative error.
  int ask(int unit) {
    modbus_set_slave(master_.get(), unit);
    std::uint16_t value = 0;
    return modbus_read_input_registers(master_.get(), 0, 1, &value) == 1 ? value : -errno;
  }

  const Libmodbus master_;
};

TEST_F(LibmodbusRtuMaster, ALateAnswerBecomesTheDataOfEveryLaterRequest) {
  EXPECT_EQ(ask(7), -ETIMEDOUT);
  say(rtu_bytes(7, {4, 2, 0, 1}));  // too late
  for (std::uint8_t value = 2; value < 6; ++value) {
    say(rtu_bytes(7, {4, 2, 0, value}));
    EXPECT_EQ(ask(7), value - 1);
  }
}

TEST_F(LibmodbusRtuMaster, ALateAnswerFailsAnotherUnit) {
  EXPECT_EQ(ask(7), -ETIMEDOUT);
  say(rtu_bytes(7, {4, 2, 0, 1}));
  say(rtu_bytes(8, {4, 2, 0, 2}));
  EXPECT_EQ(ask(8), -EMBBADSLAVE);
}

TEST_F(LibmodbusRtuMaster, NoiseBeforeAnAnswerFailsIt) {
  say({0x00, 0xff, 0x55});
  say(rtu_bytes(7, {4, 2, 0, 1}));
  EXPECT_LT(ask(7), 0);
}

TEST_F(LibmodbusRtuMaster, DoesNotKnowHowLongAnIdentificationIs) {
  modbus_set_slave(master_.get(), 7);
  const std::uint8_t request[] = {7, 0x2b, 0x0e, 1, 0};
  ASSERT_GT(modbus_send_raw_request(master_.get(), request, sizeof request), 0);
  say(rtu_bytes(7, {0x2b, 0x0e, 1, 0x81, 0, 0, 1, 0, 4, 'E', 'T', 'C', 'M'}));
  std::array<std::uint8_t, MODBUS_RTU_MAX_ADU_LENGTH> answer;
  EXPECT_EQ(modbus_receive_confirmation(master_.get(), answer.data()), -1);
  EXPECT_EQ(errno, EMBBADCRC);
}

volatile sig_atomic_t alarm_count = 0;

// Ctrl-C has to end a wait, which may last ten seconds.
TEST_F(LibmodbusRtuMaster, ASignalDoesNotEndItsWait) {
  struct sigaction count {};
  count.sa_handler = [](int) { alarm_count = alarm_count + 1; };
  struct sigaction before {};
  ASSERT_EQ(::sigaction(SIGALRM, &count, &before), 0);
  const itimerval soon{.it_interval = {}, .it_value = {.tv_sec = 0, .tv_usec = timeout_us / 4}};
  ASSERT_EQ(::setitimer(ITIMER_REAL, &soon, nullptr), 0);
  modbus_set_response_timeout(master_.get(), 0, 10 * timeout_us);
  EXPECT_EQ(ask(7), -ETIMEDOUT) << "not EINTR";
  EXPECT_EQ(alarm_count, 1);
  ASSERT_EQ(::sigaction(SIGALRM, &before, nullptr), 0);
}

// Either end of a connection, without a network; ours is `peer_`.
class LibmodbusTcp : public testing::Test {
 protected:
  LibmodbusTcp() : end_(modbus_new_tcp("127.0.0.1", MODBUS_TCP_DEFAULT_PORT)) {
    std::array<int, 2> pair{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()), 0);
    modbus_set_socket(end_.get(), pair[0]);
    peer_ = FileDescriptor(pair[1]);
    modbus_set_response_timeout(end_.get(), 0, timeout_us);
    modbus_set_byte_timeout(end_.get(), 0, timeout_us);
  }

  // What libmodbus replies to one request about ten registers of value 1.
  Bytes reply(std::span<const std::uint8_t> request) {
    modbus_mapping_t table{};
    table.nb_registers = table.nb_input_registers = static_cast<int>(registers_.size());
    table.tab_registers = table.tab_input_registers = registers_.data();
    Bytes answer;
    if (modbus_reply(end_.get(), request.data(), static_cast<int>(request.size()), &table) > 0) {
      receive_available(peer_.get(), answer);
    }
    return answer;
  }

  std::array<std::uint16_t, 10> registers_{1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
  const Libmodbus end_;
  FileDescriptor peer_;
};

TEST_F(LibmodbusTcp, ALateAnswerFailsEveryLaterRequest) {
  std::uint16_t value = 0;
  EXPECT_EQ(modbus_read_input_registers(end_.get(), 0, 1, &value), -1);
  EXPECT_EQ(errno, ETIMEDOUT);
  send_bytes(peer_.get(), frame_of(1, 255, {4, 2, 0, 1}));  // too late
  for (std::uint16_t number = 2; number < 6; ++number) {
    send_bytes(peer_.get(), frame_of(number, 255, {4, 2, 0, 2}));
    EXPECT_EQ(modbus_read_input_registers(end_.get(), 0, 1, &value), -1);
    EXPECT_EQ(errno, EMBBADDATA);
  }
}

// Meanwhile a server in one thread serves nobody else.
TEST_F(LibmodbusTcp, WaitsForTheRestOfARequest) {
  send_bytes(peer_.get(), {0, 1, 0});
  std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> request;
  EXPECT_EQ(modbus_receive(end_.get(), request.data()), -1);
  EXPECT_EQ(errno, ETIMEDOUT);
}

// Before it replies to a function or a count that is unknown to it, it sleeps for the response
// timeout (half a second where nobody sets it), and throws away what has come.
TEST_F(LibmodbusTcp, AnUnknownFunctionLosesTheNextRequest) {
  for (const Bytes& wrong : {Bytes{99, 0, 0, 0, 1}, Bytes{4, 0, 0, 0, 126}}) {
    send_bytes(peer_.get(), read_request(2, 1, 0, 1));
    EXPECT_EQ(reply(frame_of(1, 1, wrong)).size(), 9u);
    std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> next;
    EXPECT_EQ(::recv(modbus_get_socket(end_.get()), next.data(), next.size(), MSG_DONTWAIT), -1);
  }
}

TEST_F(LibmodbusTcp, AShortRequestIsReadBeyondItsEnd) {
  Bytes received = read_request(1, 1, 0, 1);
  received[5] = 2;  // the unit and the function alone; behind them lies what came before
  EXPECT_EQ(reply(std::span(received).first(8)), frame_of(1, 1, {4, 2, 0, 1}));
}

TEST_F(LibmodbusTcp, AnyTableCanBeWritten) {
  EXPECT_EQ(reply(frame_of(1, 1, {6, 0, 3, 0, 7})).size(), 12u);
  EXPECT_EQ(registers_[3], 7);
}

TEST_F(LibmodbusTcp, NamesItselfAsTheServer) {
  const Bytes answer = reply(frame_of(1, 1, {17}));
  EXPECT_NE(std::string(answer.begin(), answer.end()).find("LMB"), std::string::npos);
}

TEST_F(LibmodbusTcp, AReplyThatDoesNotFitTheSocketIsLost) {
  const int socket = modbus_get_socket(end_.get());
  ASSERT_EQ(::fcntl(socket, F_SETFL, O_NONBLOCK), 0) << "else it would wait for the client";
  const Bytes filling(1000, 0);
  std::size_t before = 0;
  for (ssize_t sent = 0; sent >= 0; sent = ::send(socket, filling.data(), filling.size(), 0)) {
    before += static_cast<std::size_t>(sent);
  }
  EXPECT_EQ(reply(read_request(1, 1, 0, 1)), Bytes{});
  Bytes received;
  receive_available(peer_.get(), received);
  EXPECT_EQ(received.size(), before);
}

}  // namespace
}  // namespace etcm::port
