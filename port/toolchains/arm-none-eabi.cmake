# The library alone on a Cortex-M without an operating system; tests run in QEMU with semihosting.
# ETCM_CPU: cortex-m4 (and every other -mcpu of GCC's that runs Thumb), cortex-m0plus.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)

set(ETCM_CPU cortex-m4 CACHE STRING "The processor, as GCC's -mcpu names it")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ETCM_CPU)

set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
# There is no C library to link a whole program against before the board's own files are there.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)

string(CONCAT CMAKE_C_FLAGS_INIT "-mcpu=${ETCM_CPU} -mthumb -ffunction-sections -fdata-sections")
string(CONCAT CMAKE_CXX_FLAGS_INIT
  "-mcpu=${ETCM_CPU} -mthumb -ffunction-sections -fdata-sections "
  "-fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--gc-sections")

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

# Arm's MPS2 board. QEMU has no Cortex-M0+ on it, but the Cortex-M3 of an385 runs all of its
# instructions.
if(ETCM_CPU STREQUAL "cortex-m0plus")
  set(etcm_machine mps2-an385)
else()
  set(etcm_machine mps2-an386)
endif()
set(CMAKE_CROSSCOMPILING_EMULATOR
  qemu-system-arm -M ${etcm_machine} -display none -monitor none -serial none
  -chardev stdio,id=host,signal=off -semihosting-config enable=on,target=native,chardev=host
  -kernel)
