// A way out of a bare machine through its debugger, here QEMU.
#pragma once

namespace etcm::test {

[[noreturn]] void leave(int exit_code);

}  // namespace etcm::test
