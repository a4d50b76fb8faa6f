// How wide ids are, and the namespace that says so.
//
// What the library declares is in etcm::ids_32 or etcm::ids_16. The namespace is inline, so nobody
// writes it; but the linker sees it. A program that is compiled for another width than the library
// does not link ("undefined reference to etcm::ids_16::Mesh::open(...)"), where otherwise the two
// would take the same memory for different things.
#pragma once

// 2020, as compilers that had not all of it yet count it.
#if defined(__cplusplus) && __cplusplus < 201709L
#error "the C++ headers of etcm need C++20 (-std=c++20); etcm/etcm.h does with C11 and with C++11"
#endif

// The build says it (CMake: ETCM_ID_BITS), for the library and, through its target, for programs.
#ifndef ETCM_ID_BITS
#define ETCM_ID_BITS 32
#endif

#if ETCM_ID_BITS == 16
#define ETCM_IDS ids_16
#elif ETCM_ID_BITS == 32
#define ETCM_IDS ids_32
#else
#error "ETCM_ID_BITS must be 32 or 16"
#endif
