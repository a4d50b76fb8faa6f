# Linux on 64-bit ARM: Debian's arm64.
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(etcm_triplet aarch64-linux-gnu)
set(etcm_architecture arm64)
set(etcm_emulator qemu-aarch64)
include("${CMAKE_CURRENT_LIST_DIR}/linux-sysroot.cmake")
