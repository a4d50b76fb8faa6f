#include "modbus/rs485.h"

#include <linux/serial.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <cstring>

namespace etcm::port {

namespace {

constexpr std::uint32_t both_levels = SER_RS485_RTS_ON_SEND | SER_RS485_RTS_AFTER_SEND;

std::uint32_t flags_of(RtsLevel level) {
  return level == RtsLevel::high ? SER_RS485_RTS_ON_SEND : SER_RS485_RTS_AFTER_SEND;
}

std::uint32_t milliseconds(Duration delay) {
  return static_cast<std::uint32_t>(delay / std::chrono::milliseconds(1));
}

// Of delays and levels a driver may take any or none.
bool differs(const serial_rs485& actual, const Rs485& wanted, std::string& key) {
  if (wanted.rts_while_sending &&
      (actual.flags & both_levels) != flags_of(*wanted.rts_while_sending)) {
    key = "rs485_rts";
  } else if (wanted.delay_before &&
             actual.delay_rts_before_send != milliseconds(*wanted.delay_before)) {
    key = "rs485_delay_before";
  } else if (wanted.delay_after &&
             actual.delay_rts_after_send != milliseconds(*wanted.delay_after)) {
    key = "rs485_delay_after";
  } else {
    return false;
  }
  return true;
}

std::string refusal(const char* call) {
  return std::string("its driver refuses to switch RS-485 (") + call + ": " + std::strerror(errno) +
         "); take `rs485` out where the adapter switches by itself, or give `rs485_line`";
}

}  // namespace

serial_rs485 combine(const serial_rs485& current, const Rs485& wanted) {
  serial_rs485 next = current;
  if (wanted.mode == Rs485Mode::off) next.flags &= ~std::uint32_t{SER_RS485_ENABLED};
  if (wanted.mode != Rs485Mode::on) return next;
  next.flags |= SER_RS485_ENABLED;
  const std::uint32_t levels = current.flags & both_levels;
  const bool is_said = levels != 0 && levels != both_levels;
  if (wanted.rts_while_sending || !is_said) {
    next.flags &= ~both_levels;
    next.flags |= flags_of(wanted.rts_while_sending.value_or(RtsLevel::high));
  }
  if (wanted.delay_before) next.delay_rts_before_send = milliseconds(*wanted.delay_before);
  if (wanted.delay_after) next.delay_rts_after_send = milliseconds(*wanted.delay_after);
  return next;
}

bool is_done(const serial_rs485& actual, const Rs485& wanted, std::string& why) {
  const bool is_on = (actual.flags & SER_RS485_ENABLED) != 0;
  if (wanted.mode == Rs485Mode::off && is_on) {
    why = "its driver switches RS-485 whatever it is told; take `rs485` out";
    return false;
  }
  if (wanted.mode != Rs485Mode::on) return true;
  if (!is_on) {
    why =
        "its driver does not switch RS-485 though it is told to; take `rs485` out where the "
        "adapter "
        "switches by itself, or give `rs485_line`";
    return false;
  }
  std::string key;
  if (!differs(actual, wanted, key)) return true;
  why = "its driver does not take `" + key +
        "` as it is set; take that out or change it (it has RTS " +
        ((actual.flags & SER_RS485_RTS_ON_SEND) != 0 ? "high" : "low") + " while it sends, " +
        std::to_string(actual.delay_rts_before_send) + " ms before and " +
        std::to_string(actual.delay_rts_after_send) + " ms after)";
  return false;
}

bool set_rs485(int descriptor, const Rs485& wanted, std::string& why) {
  if (wanted.mode == Rs485Mode::keep) return true;
  serial_rs485 driver{};
  const bool is_told = ::ioctl(descriptor, TIOCGRS485, &driver) == 0;
  // A driver that knows nothing of RS-485 does not switch it either.
  if (wanted.mode == Rs485Mode::off && (driver.flags & SER_RS485_ENABLED) == 0) return true;
  if (!is_told) {
    why = refusal("TIOCGRS485");
    return false;
  }
  serial_rs485 next = combine(driver, wanted);
  if (::ioctl(descriptor, TIOCSRS485, &next) != 0 ||
      ::ioctl(descriptor, TIOCGRS485, &driver) != 0) {
    why = refusal("TIOCSRS485");
    return false;
  }
  return is_done(driver, wanted, why);
}

}  // namespace etcm::port
