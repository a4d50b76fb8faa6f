// libmodbus knows how a port is set for RTU: speed, parity, raw bytes. It does so on a descriptor
// of its own, for it takes a port from whoever has it, puts back the old settings when it closes
// one, and tells by reading nothing that nothing has come.
#include "modbus/serial_port.h"

#include <fcntl.h>
#include <linux/serial.h>
#include <modbus/modbus.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>
#include <system_error>

#include "modbus/line_speed.h"
#include "modbus/rs485.h"
#include "posix/exhaustion.h"

namespace etcm::port {

namespace {

constexpr int data_bits = 8;

struct FreeContext {
  void operator()(modbus_t* context) const { modbus_free(context); }
};
using Context = std::unique_ptr<modbus_t, FreeContext>;

char letter_of(Parity parity) {
  switch (parity) {
    case Parity::none:
      return 'N';
    case Parity::even:
      return 'E';
    case Parity::odd:
      return 'O';
  }
  return 'N';
}

// Opens the port once more, and sets it. Null where that fails, with errno.
Context set(const SerialLine& line, Parity parity) {
  Context context(modbus_new_rtu(line.path.c_str(), static_cast<int>(line.baud), letter_of(parity),
                                 data_bits, line.stop_bits));
  if (context == nullptr || modbus_connect(context.get()) == 0) return context;
  // The C library calls a driver without parity an error when all the rest stands as it should from
  // the last time. Whether that will do is asked once the port is set.
  const bool may_lack_parity = errno == EINVAL && parity != Parity::none;
  return may_lack_parity ? set(line, Parity::none) : nullptr;
}

// What libmodbus sets otherwise than a loop needs it: a read that finds nothing says EAGAIN, so
// that an end is a port that is gone; and the modem lines fall when the port is closed.
bool correct(int descriptor) {
  termios settings{};
  if (::tcgetattr(descriptor, &settings) != 0) return false;
  settings.c_cc[VMIN] = 1;
  settings.c_cflag |= HUPCL;
  return ::tcsetattr(descriptor, TCSANOW, &settings) == 0;
}

bool has_parity(int descriptor, Parity wanted, std::string& why) {
  termios settings{};
  struct stat device {};
  if (::tcgetattr(descriptor, &settings) != 0 || ::fstat(descriptor, &device) != 0) {
    why = std::strerror(errno);
    return false;
  }
  if (can_carry(settings, wanted, device.st_rdev)) return true;
  why =
      "its driver does not take the parity; take another adapter, or set all devices to none, and "
      "`parity` with them";
  return false;
}

constexpr const char* where_ports_are = "; ls /dev/serial/by-path lists the ports there are";

bool set_up(const SerialLine& line, std::string& why) {
  const Context context = set(line, line.parity);
  if (context == nullptr) {
    why = errno == ENOTTY
              ? std::string("is a device, and no serial port") + where_ports_are
              : std::string("is no serial port that can be set (") + std::strerror(errno) + ")";
    return false;
  }
  // Closed as it is set.
  const FileDescriptor second(modbus_get_socket(context.get()));
  return true;
}

// Drivers that gather bytes before they hand them over (16 ms in adapters on USB) are asked not to.
// One that cannot is as good.
void lower_latency(int descriptor) {
  serial_struct driver{};
  if (::ioctl(descriptor, TIOCGSERIAL, &driver) != 0) return;
  if ((static_cast<unsigned>(driver.flags) & ASYNC_LOW_LATENCY) != 0) return;
  driver.flags = static_cast<int>(static_cast<unsigned>(driver.flags) | ASYNC_LOW_LATENCY);
  ::ioctl(descriptor, TIOCSSERIAL, &driver);
}

// Whether this process has locked what it has open as this.
bool is_locked(const std::string& number) {
  std::ifstream facts("/proc/self/fdinfo/" + number);
  for (std::string line; std::getline(facts, line);) {
    if (line.starts_with("lock:") && line.find("FLOCK") != std::string::npos) return true;
  }
  return false;
}

// The name under which this process itself has locked the device, or none.
std::string own_name_of(int descriptor) {
  namespace fs = std::filesystem;
  struct stat wanted {};
  if (::fstat(descriptor, &wanted) != 0) return {};
  std::error_code error;
  for (fs::directory_iterator at("/proc/self/fd", error), end; !error && at != end;
       at.increment(error)) {
    struct stat found {};
    if (::stat(at->path().c_str(), &found) != 0 || !S_ISCHR(found.st_mode)) continue;
    if (found.st_rdev != wanted.st_rdev || !is_locked(at->path().filename())) continue;
    return fs::read_symlink(at->path(), error);
  }
  return {};
}

// Two programs on one line would take each other's answers, and so would two buses.
bool lock(int descriptor, std::string& why) {
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return true;
  const std::string own = own_name_of(descriptor);
  why = own.empty() ? "another program has it; end that one (fuser -v names it)"
                    : "it is the same port as " + own +
                          ", which another [[bus]] has; put the units of both into one";
  return false;
}

std::string_view what_is_no_port(const std::string& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0 || S_ISCHR(found.st_mode)) return {};
  if (S_ISDIR(found.st_mode)) return "is a folder, and no serial port";
  return S_ISREG(found.st_mode) ? "is a file, and no serial port" : "is no serial port";
}

}  // namespace

bool can_carry(const termios& actual, Parity wanted, dev_t device) {
  constexpr unsigned pseudo_terminals_first = 136, pseudo_terminals_last = 143;
  const unsigned driver = major(device);
  if (driver >= pseudo_terminals_first && driver <= pseudo_terminals_last) return true;
  const bool is_on = (actual.c_cflag & PARENB) != 0, is_odd = (actual.c_cflag & PARODD) != 0;
  return is_on == (wanted != Parity::none) && (!is_on || is_odd == (wanted == Parity::odd));
}

FileDescriptor open_serial(const SerialLine& line, std::string& why) {
  if (const std::string_view what = what_is_no_port(line.path); !what.empty()) {
    why = std::string(what) + where_ports_are;
    return {};
  }
  FileDescriptor port(::open(line.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port.is_open()) {
    const int error = errno;
    why = std::strerror(error);
    if (error == EACCES) why += "; whoever runs this must be in the group dialout";
    if (error == EPERM) why += "; a service needs DeviceAllow for its driver (systemctl edit)";
    if (error == ENOENT) why += where_ports_are;
    if (is_out_of_descriptors(error)) why += std::string("; ") + descriptors_cure;
    return {};
  }
  if (!lock(port.get(), why) || !set_up(line, why)) return {};
  if (!correct(port.get())) {
    why = std::strerror(errno);
    return {};
  }
  if (!has_parity(port.get(), line.parity, why)) return {};
  if (!set_speed(port.get(), line.baud, why) || !set_rs485(port.get(), line.rs485, why)) return {};
  lower_latency(port.get());
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
