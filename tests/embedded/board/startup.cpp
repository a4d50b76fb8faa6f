// From reset to main() on a Cortex-M, and the stack's high-water mark when main() is over.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "../console.h"
#include "semihosting.h"

int main();

// Supplied by the linker script.
extern "C" {
extern std::uint32_t etcm_data_source[], etcm_data_begin[], etcm_data_end[];
extern std::uint32_t etcm_bss_begin[], etcm_bss_end[];
extern std::uint32_t etcm_stack_bottom[], etcm_stack_top[];
using Initializer = void (*)();
extern const Initializer etcm_init_begin[], etcm_init_end[];
void etcm_reset();
void etcm_tick();
void etcm_check_failed(const char* what, const char* file, int line);
}

namespace {

constexpr std::uint32_t paint = 0xa5a5a5a5u;

std::size_t bytes(const std::uint32_t* begin, const std::uint32_t* end) {
  return static_cast<std::size_t>(end - begin) * sizeof *begin;
}

void report_stack() {
  const std::uint32_t* deepest = etcm_stack_bottom;
  while (deepest != etcm_stack_top && *deepest == paint) ++deepest;
  etcm::test::put("# stack used: ");
  etcm::test::put_number(bytes(deepest, etcm_stack_top));
  etcm::test::put(" of ");
  etcm::test::put_number(bytes(etcm_stack_bottom, etcm_stack_top));
  etcm::test::put("\n");
}

void fault() {
  etcm::test::put("processor fault\n");
  etcm::test::leave(2);
}

using Handler = void (*)();
struct Vectors {
  std::uint32_t* stack;
  Handler handlers[15];
};
[[gnu::section(".vectors"), gnu::used]] const Vectors vectors = {
    etcm_stack_top,
    {etcm_reset, fault, fault, fault, fault, fault, nullptr, nullptr, nullptr, nullptr, fault,
     fault, nullptr, fault, etcm_tick},
};

}  // namespace

// The system timer's interrupt, for a program that has one.
extern "C" [[gnu::weak]] void etcm_tick() { fault(); }

extern "C" void etcm_reset() {
  std::memcpy(etcm_data_begin, etcm_data_source, bytes(etcm_data_begin, etcm_data_end));
  std::memset(etcm_bss_begin, 0, bytes(etcm_bss_begin, etcm_bss_end));
  // Not a call of memset: it would paint over its own frame.
  auto* const here = static_cast<std::uint32_t*>(__builtin_frame_address(0)) - 16;
  for (volatile std::uint32_t* word = etcm_stack_bottom; word < here; ++word) *word = paint;
  for (const Initializer* call = etcm_init_begin; call != etcm_init_end; ++call) (*call)();
  const int answer = main();
  report_stack();
  etcm::test::leave(answer);
}

extern "C" void etcm_check_failed(const char* what, const char* file, int line) {
  etcm::test::put("check failed: ");
  etcm::test::put(what);
  etcm::test::put(" in ");
  etcm::test::put(file);
  etcm::test::put(":");
  etcm::test::put_number(static_cast<std::uint32_t>(line));
  etcm::test::put("\n");
  etcm::test::leave(3);
}
