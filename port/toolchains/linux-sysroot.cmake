# Cross compiling for Linux against a folder made by make_sysroot; included by the toolchain files,
# which say for what: etcm_triplet, etcm_architecture (Debian's name), etcm_emulator.
set(CMAKE_SYSTEM_NAME Linux)

set(ETCM_SYSROOT "${CMAKE_CURRENT_LIST_DIR}/../../build/sysroot/${etcm_architecture}"
  CACHE PATH "Headers and libraries of the target; port/toolchains/make_sysroot makes it")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ETCM_SYSROOT)
get_filename_component(CMAKE_SYSROOT "${ETCM_SYSROOT}" ABSOLUTE)
if(NOT EXISTS "${CMAKE_SYSROOT}/usr/include")
  message(FATAL_ERROR "There is no sysroot in ${CMAKE_SYSROOT}; `tools/test --arm` makes it, or "
                      "port/toolchains/make_sysroot ${etcm_architecture} FOLDER PACKAGE...")
endif()

set(CMAKE_C_COMPILER ${etcm_triplet}-gcc)
set(CMAKE_CXX_COMPILER ${etcm_triplet}-g++)
set(CMAKE_LIBRARY_ARCHITECTURE ${etcm_triplet})

set(CMAKE_FIND_ROOT_PATH "${CMAKE_SYSROOT}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} "${CMAKE_SYSROOT}")
set(ENV{PKG_CONFIG_LIBDIR}
  "${CMAKE_SYSROOT}/usr/lib/${etcm_triplet}/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig")
set(ENV{PKG_CONFIG_PATH} "")

set(CMAKE_CROSSCOMPILING_EMULATOR ${etcm_emulator} -L ${CMAKE_SYSROOT})
