#include "semihosting.h"

#include <cstdint>

#include "../console.h"

namespace etcm::test {
namespace {

// Numbers from "Semihosting for AArch32 and AArch64", Arm.
constexpr std::uintptr_t write_text = 0x04;
constexpr std::uintptr_t exit_extended = 0x20;
constexpr std::uintptr_t application_exit = 0x20026;

void ask_debugger(std::uintptr_t operation, const void* argument) {
  register std::uintptr_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

}  // namespace

void put(const char* text) { ask_debugger(write_text, text); }

void leave(int exit_code) {
  const std::uintptr_t reason[2] = {application_exit, static_cast<std::uintptr_t>(exit_code)};
  ask_debugger(exit_extended, reason);
  for (;;) {
  }
}

}  // namespace etcm::test
