// A serial port of the system, set by libmodbus (speeds that it does not know and RS-485 by us),
// and never waited for.
#pragma once

#include <sys/types.h>
#include <termios.h>

#include <string>

#include "etcm/port/serial_line.h"
#include "posix/file_descriptor.h"

namespace etcm::port {

// Not open where that failed, with the reason (and the cure where there is one) in `why`. A port
// that another program has is left as it is set.
FileDescriptor open_serial(const SerialLine& line, std::string& why);

// Whether a port that is set to `actual` will do for the parity that is wanted. A pseudo terminal
// has none and carries all, as no bit of it is on a line.
bool can_carry(const termios& actual, Parity wanted, dev_t device);

// Throws away what has arrived and was not read, and what was written and is not on the line yet.
// Closing a port whose bytes do not go out would wait for them.
void discard_waiting(int descriptor);

// Whether the last bit of everything written is on the line. True where the driver cannot tell.
bool is_sent(int descriptor);

}  // namespace etcm::port
