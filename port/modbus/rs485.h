// RS-485 as the driver of a serial port switches it (TIOCSRS485).
#pragma once

#include <string>

#include "etcm/port/serial_line.h"

struct serial_rs485;

namespace etcm::port {

// What the driver is to be set to, from what it has: whatever the line does not say stays as the
// device tree set it. RTS is high while it sends where neither says.
serial_rs485 combine(const serial_rs485& current, const Rs485& wanted);

// Whether a driver that is set to `actual` does all that the line says. Else `why` names the key.
bool is_done(const serial_rs485& actual, const Rs485& wanted, std::string& why);

// Sets a port, and looks what its driver made of it. False where that is not what was wanted, with
// the reason and the cure. With Rs485Mode::keep nothing is asked of the driver.
bool set_rs485(int descriptor, const Rs485& wanted, std::string& why);

}  // namespace etcm::port
