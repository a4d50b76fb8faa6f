# Linux on 32-bit ARM (ARMv7, hardware floating point): Debian's armhf.
set(CMAKE_SYSTEM_PROCESSOR armv7l)
set(etcm_triplet arm-linux-gnueabihf)
set(etcm_architecture armhf)
set(etcm_emulator qemu-arm)
# A note on how GCC 6 passed 64-bit members; all here is built by one compiler.
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)
include("${CMAKE_CURRENT_LIST_DIR}/linux-sysroot.cmake")
